# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Convolutional Mean: a network of 1137 weights that estimates the illuminant.

Source: H. Gong, Convolutional Mean: A Simple Convolutional Neural Network for
Illuminant Estimation, BMVC 2019. Two 3x3 convolutions of 7 and 14 channels, each with
max pooling and ReLU, one 1x1 of 3; the mean over the image is the neutral. It needs
PyTorch."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studies.protocol import IlluminantRules
from studies.tasks.angles import degrees

WIDTHS = (3, 7, 14, 3)
SHARPNESS = 5.0  # of the softplus that keeps a neutral above 0
Array = NDArray[np.float64]
Thumbnails = NDArray[np.float32]


@dataclass(frozen=True)
class Trained:
    """A network, and what its training looked like."""

    network: Any  # torch.nn.Module
    epoch: int  # whose weights were best on the validation frames
    validation: list[float]  # degrees on them, after each epoch

    def estimates(self, images: Thumbnails) -> Array:
        """Return neutrals (n, 3), of any scale, of images (n, h, w, 3)."""
        import torch

        with torch.no_grad():
            found = self.network(channels_first(images))
        return np.asarray(found.numpy(), np.float64)


def network(seed: int) -> Any:
    """Return the network, its weights drawn by the seed."""
    import torch
    from torch import nn

    first, second, third, last = WIDTHS
    torch.manual_seed(seed)
    return nn.Sequential(
        nn.Conv2d(first, second, 3, padding=1),
        nn.MaxPool2d(2),
        nn.ReLU(),
        nn.Conv2d(second, third, 3, padding=1),
        nn.MaxPool2d(2),
        nn.ReLU(),
        nn.Conv2d(third, last, 1),
        nn.Softplus(SHARPNESS),
        nn.AdaptiveAvgPool2d(1),
        nn.Flatten(),
    )


def train(
    images: Thumbnails,
    neutrals: Array,
    rules: IlluminantRules,
    epochs: int,
    seed: int,
) -> Trained:
    """Return the network of images (n, h, w, 3) and neutrals (n, 3).

    The last share of the frames is for validation: the weights are those of the epoch
    that is best on them. The seed draws weights, order and flips."""
    import torch

    torch.set_num_threads(1)
    model = network(seed)
    order = torch.Generator().manual_seed(seed + 1)
    own = len(images) - round(rules.validation * len(images))
    x, truth = channels_first(images[:own]), torch.from_numpy(neutrals[:own]).float()
    steps = epochs * -(-own // rules.batch)
    optimiser = torch.optim.Adam(model.parameters(), rules.rate / 25.0)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimiser, rules.rate, steps)
    kept: dict[str, Any] = {}
    curve: list[float] = []
    for _ in range(epochs):
        for chosen in torch.randperm(own, generator=order).split(rules.batch):
            batch = x[chosen]
            if torch.rand((), generator=order) < 0.5:
                batch = batch.flip(3)
            loss = angles(model(batch), truth[chosen]).mean()
            optimiser.zero_grad()
            loss.backward()
            optimiser.step()
            schedule.step()
        curve.append(error(model, images[own:], neutrals[own:]))
        if curve[-1] == min(curve):
            kept = {name: w.clone() for name, w in model.state_dict().items()}
    model.load_state_dict(kept)
    return Trained(model, int(np.argmin(curve)), curve)


def error(model: Any, images: Thumbnails, neutrals: Array) -> float:
    """Return the mean error in degrees of a network."""
    found = Trained(model, 0, []).estimates(images)
    return float(degrees(found, neutrals).mean())


def angles(estimates: Any, truth: Any) -> Any:
    """Return the angles (n,), radians, of torch tensors (n, 3)."""
    import torch

    sine = torch.linalg.cross(estimates, truth).norm(dim=1)
    return torch.atan2(sine, (estimates * truth).sum(dim=1))


def channels_first(images: Thumbnails) -> Any:
    """Return a torch tensor (n, 3, h, w) of images (n, h, w, 3)."""
    import torch

    return torch.from_numpy(images).permute(0, 3, 1, 2).contiguous()
