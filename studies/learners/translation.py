# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Unpaired translation of renders to balanced RAW by adversarial training.

This is NOT EnlightenGAN, but a small network of its parts: a U-net with darkness as
attention, which adds to its input; a relativistic average least-squares PatchGAN on
crops and a plain least-squares one on patches of them; the rate falls to 0 in the
second half. What the paper keeps by features of VGG-16, whose weights cannot be had
here, is kept by instance-normalised luminance and its gradients. Discriminators are
kept from being steep, and the generator is a moving average of the one that is trained,
or both go round in circles (L. Mescheder et al., Which Training Methods for GANs do
actually Converge?, ICML 2018).
Source: Y. Jiang et al., EnlightenGAN: Deep Light Enhancement without Paired
Supervision, IEEE Transactions on Image Processing 30, 2021.

Images are exposed and linear, 0..1; the networks see square roots. One seed gives one
result on one thread of a CPU; on CUDA, which is taken if there is, nearly so. It needs
PyTorch."""

from collections.abc import Sequence
from copy import deepcopy
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studies.learners.checkpoint import Checkpoint
from studies.learners.colour_distance import colour_distance
from studies.learners.device import device
from studies.learners.translation_networks import (
    content_change,
    discriminator,
    generator,
    relativistic,
    slope,
    squares,
    translated,
)
from studies.protocol import TranslationRules

BETAS = (0.5, 0.999)  # of Adam
MOST_PULL = 1.0  # norm of a loss's gradient; without a bound some trainings diverge
AT_ONCE = 8  # images that are translated together
STRIDE = 8  # of the pixels by which sets of images are compared
DIM = 0.05  # added to the mean of the channels that a chromaticity is divided by
LOSSES = ("discriminators", "generator", "content")
DISCRIMINATORS = ("global", "local")
Image = NDArray[np.float32]
Curve = list[dict[str, float]]


@dataclass(frozen=True)
class Sets:
    """Images (n, h, w, 3) as training sees them; the captures are balanced."""

    renders: Image
    captures: Image
    held_out: Image  # captures of other scenes: for the curve alone


@dataclass(frozen=True)
class Trained:
    """A generator, and how its training went.

    curve : at each record the step, the mean losses since the last, and distances of
        the translated renders from the captures held out.
    floor : the same distances of the training captures."""

    layers: Any  # torch.nn.ModuleDict
    curve: Curve
    floor: dict[str, float]

    def __call__(self, images: Sequence[Image]) -> list[Image]:
        """Return images (h, w, 3) like balanced RAW, linear, 0 or above."""
        import torch

        own = next(self.layers.parameters()).device
        found: list[Image] = []
        with torch.no_grad():
            for first in range(0, len(images), AT_ONCE):
                some = rooted(np.stack(images[first : first + AT_ONCE])).to(own)
                made = translated(self.layers, some).clamp_min(0.0) ** 2
                found += list(made.permute(0, 2, 3, 1).cpu().numpy())
        return found


class Training:
    """Networks and optimisers at a step, and the generator of what is drawn."""

    def __init__(self, sets: Sets, rules: TranslationRules, seed: int) -> None:
        import torch
        from torch import nn

        self.rules = rules
        self.rates = (rules.rate, rules.generator_rate)
        self.device = device()
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(seed)
            layers = generator(rules.generator_width)
            judges = {
                name: discriminator(rules.discriminator_width)
                for name in DISCRIMINATORS
            }
        # Channels last: a step takes half the time on a CPU.
        self.layers, self.averaged, self.judges = (
            part.to(self.device, memory_format=torch.channels_last)
            for part in (layers, deepcopy(layers), nn.ModuleDict(judges))
        )
        self.optimisers = [
            torch.optim.Adam(part.parameters(), rate, BETAS)
            for part, rate in zip((self.judges, self.layers), self.rates, strict=True)
        ]
        self.draws = torch.Generator().manual_seed(seed + 1)
        self.step = 0
        self.curve: Curve = []
        self.renders = rooted(sets.renders).to(self.device)
        self.captures = rooted(sets.captures).to(self.device)

    def advance(self, steps: int) -> list[float]:
        """Take one step of so many; return LOSSES."""
        share = min(1.0, 2.0 * (1.0 - self.step / steps))
        for optimiser, rate in zip(self.optimisers, self.rates, strict=True):
            optimiser.param_groups[0]["lr"] = rate * share
        before, real = self.crops(self.renders), self.crops(self.captures)
        after = translated(self.layers, before)
        judged = self.judge(real, after.detach())
        self.update(0, judged)
        real = real.detach()
        self.judges.requires_grad_(False)
        kept = content_change(before, after)
        fooled = self.fool(real, after)
        self.update(1, fooled + self.rules.content * kept)
        self.judges.requires_grad_(True)
        self.average()
        self.step += 1
        return [float(loss.detach()) for loss in (judged, fooled, kept)]

    def update(self, number: int, loss: Any) -> None:
        """Take a step of one of the optimisers, of a gradient of at most MOST_PULL."""
        from torch.nn.utils import clip_grad_norm_

        optimiser = self.optimisers[number]
        optimiser.zero_grad()
        loss.backward()
        clip_grad_norm_(optimiser.param_groups[0]["params"], MOST_PULL)
        optimiser.step()

    def average(self) -> None:
        """Draw the averaged generator towards the one that is trained."""
        import torch

        pairs = zip(self.averaged.parameters(), self.layers.parameters(), strict=True)
        with torch.no_grad():
            for mean, now in pairs:
                mean.lerp_(now, self.rules.average)

    def judge(self, real: Any, made: Any) -> Any:
        """Return the discriminators' loss."""
        whole, local = (self.judges[name] for name in DISCRIMINATORS)
        real = real.requires_grad_()
        scores, scores_of_patches = whole(real), local(self.patches(real))
        steep = slope(scores, real) + slope(scores_of_patches, real)
        return (
            relativistic(scores, whole(made))
            + squares(scores_of_patches, 1.0)
            + squares(local(self.patches(made)), 0.0)
            + self.rules.slope * steep
        )

    def fool(self, real: Any, made: Any) -> Any:
        """Return the generator's loss before the discriminators."""
        whole, local = (self.judges[name] for name in DISCRIMINATORS)
        found = relativistic(whole(made), whole(real))
        return found + squares(local(self.patches(made)), 1.0)

    def crops(self, images: Any) -> Any:
        """Return a batch of square crops (batch, 3, crop, crop), some flipped."""
        import torch

        size, found = self.rules.crop, []
        for _ in range(self.rules.batch):
            image = images[self.drawn(len(images))]
            part = self.part(image, size)
            found.append(part.flip(2) if self.drawn(2) else part)
        return torch.stack(found).contiguous(memory_format=torch.channels_last)

    def patches(self, images: Any) -> Any:
        """Return patches of crops, at places that are the same for all of them."""
        import torch

        count, size = self.rules.patches, self.rules.patch
        return torch.cat([self.part(images, size) for _ in range(count)])

    def part(self, images: Any, size: int) -> Any:
        """Return a square (..., size, size) of images at a drawn place."""
        top, left = (self.drawn(side - size + 1) for side in images.shape[-2:])
        return images[..., top : top + size, left : left + size]

    def drawn(self, below: int) -> int:
        """Return a random number below another."""
        import torch

        return int(torch.randint(below, (), generator=self.draws))

    def state(self) -> dict[str, Any]:
        """Return all that this training needs to go on."""
        return {
            "step": self.step,
            "curve": self.curve,
            "draws": self.draws.get_state(),
            "generator": self.layers.state_dict(),
            "averaged": self.averaged.state_dict(),
            "discriminators": self.judges.state_dict(),
            "optimisers": [optimiser.state_dict() for optimiser in self.optimisers],
        }

    def go_on(self, state: dict[str, Any]) -> None:
        """Take up an earlier state."""
        self.step, self.curve = state["step"], list(state["curve"])
        self.draws.set_state(state["draws"])
        self.layers.load_state_dict(state["generator"])
        self.averaged.load_state_dict(state["averaged"])
        self.judges.load_state_dict(state["discriminators"])
        for optimiser, found in zip(self.optimisers, state["optimisers"], strict=True):
            optimiser.load_state_dict(found)


def train(
    sets: Sets,
    rules: TranslationRules,
    steps: int,
    seed: int,
    checkpoint: Checkpoint | None = None,
) -> Trained:
    """Return the generator after so many steps.

    The seed draws weights and crops. At each record the checkpoint is written; training
    goes on from what it holds, to the same weights as without a stop. A GPU is used
    where there is one."""
    training = Training(sets, rules, seed)
    earlier = checkpoint.read() if checkpoint else None
    if earlier:
        training.go_on(earlier)
    floor = distances(sets.captures, sets.held_out)
    trained = Trained(training.averaged, training.curve, floor)
    losses: list[list[float]] = []
    while True:
        if training.step % rules.record == 0 or training.step == steps:
            if not training.curve or training.curve[-1]["step"] < training.step:
                record(trained, training.step, losses, sets)
                losses = []
                if checkpoint:
                    checkpoint.write(training.state())
        if training.step >= steps:
            trained.layers.cpu()
            return trained
        losses.append(training.advance(steps))


def record(trained: Trained, step: int, losses: list[list[float]], sets: Sets) -> None:
    """Add a record to a curve."""
    made = np.stack(trained(list(sets.renders)))
    means = np.mean(losses, axis=0).tolist() if losses else []
    found = {"step": step, **dict(zip(LOSSES, means, strict=False))}
    trained.curve.append({**found, **distances(made, sets.held_out)})


def distances(one: Image, other: Image) -> dict[str, float]:
    """Return how far two sets of images (n, h, w, 3) are apart in what they look like.

    colours : roots of the pixels.
    chromaticities : those over their mean, so that brightness hardly counts."""

    def colours(images: Image) -> Image:
        return np.sqrt(images[:, ::STRIDE, ::STRIDE])

    def chromaticities(images: Image) -> Image:
        found = colours(images)
        return np.asarray(found / (found.mean(axis=3, keepdims=True) + DIM), np.float32)

    return {
        "colours": colour_distance(colours(one), colours(other)),
        "chromaticities": colour_distance(chromaticities(one), chromaticities(other)),
    }


def rooted(images: Image) -> Any:
    """Return a torch tensor (n, 3, h, w) of the roots of images (n, h, w, 3)."""
    import torch

    return torch.from_numpy(np.sqrt(images)).permute(0, 3, 1, 2)
