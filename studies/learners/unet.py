# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A U-net from images to images, trained on crops. It needs PyTorch.

A step's crops, flips and noise are drawn by seed and step alone, so that a training
that was stopped goes on as if it had not been."""

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studies.learners.checkpoint import Checkpoint
from studies.learners.device import device
from studies.learners.unet_network import applied, layers
from studies.protocol import UnetRules

Array = NDArray[np.float32]
CROPS, VALIDATION = 99, 98  # keys of generators
FRAMES = 8  # at a time
START = 25.0  # the greatest rate over that of the first step


@dataclass(frozen=True)
class Examples:
    """Images (n, c, h, w) that a network is shown, and goals (n, k, h, w) for them."""

    inputs: Array
    goals: Array
    validation: int  # the last so many choose the weights
    # Of a step's inputs, what the network is shown: such as those with noise.
    shown: Callable[[Array, np.random.Generator], Array] = lambda inputs, rng: inputs
    # Of each channel, its row and column in the mosaic: a flip leaves them as they are.
    sites: Sequence[tuple[int, int]] = ()
    residual: bool = False  # the change of the inputs is learnt

    def digest(self) -> str:
        """Return the hash of what is learnt of."""
        found = hashlib.sha256()
        for array in (self.inputs, self.goals):
            found.update(repr(array.shape).encode())
            found.update(np.ascontiguousarray(array).tobytes())
        found.update(repr((self.validation, self.sites, self.residual)).encode())
        return found.hexdigest()


@dataclass(frozen=True)
class Trained:
    """A network, and what its training looked like."""

    network: Any  # layers of unet_network
    residual: bool
    step: int  # after which the weights were best on the validation images
    validation: list[float]  # squared error on them, every so many steps

    def __call__(self, images: Array) -> Array:
        """Return (n, k, h, w) of images (n, c, h, w) of any size."""
        import torch

        height, width = images.shape[2:]
        unit = 1 << len(self.network["up"])
        edges = ((0, 0), (0, 0), (0, -height % unit), (0, -width % unit))
        whole = np.pad(images, edges, mode="edge")
        device = next(self.network.parameters()).device
        with torch.no_grad():
            parts = [
                applied(
                    self.network,
                    torch.from_numpy(whole[first : first + FRAMES]).to(device),
                    self.residual,
                ).cpu()
                for first in range(0, len(whole), FRAMES)
            ]
        return np.asarray(torch.cat(parts).numpy()[..., :height, :width], np.float32)


def train(
    examples: Examples,
    rules: UnetRules,
    steps: int,
    seed: int,
    path: Path | None = None,
) -> Trained:
    """Return the network after so many steps of L1 loss and one cycle of Adam.

    The weights are those that were best on the validation images, which are looked at
    every so many steps and at the end. A GPU is used where there is one; on one machine
    a seed decides every bit.
    path : of a checkpoint, from which a training of the same examples and settings goes
        on, and which holds the best weights once it is done."""
    training = Training(examples, rules, steps, seed)
    key = f"{asdict(rules)} {steps} {seed} {examples.digest()}"
    file = None if path is None else Checkpoint(path, hashed(key))
    state = None if file is None else file.read()
    if state is not None:
        training.resume(state)
    while training.step < steps:
        training.go_on(min(rules.every, steps - training.step))
        if file is not None:
            file.write(training.state())
    return training.best()


def hashed(text: str) -> str:
    """Return the hash of a text."""
    return hashlib.sha256(text.encode()).hexdigest()


class Training:
    """A training that can be left and gone on with at any point between two steps."""

    def __init__(
        self, examples: Examples, rules: UnetRules, steps: int, seed: int
    ) -> None:
        import torch

        self.examples, self.rules, self.steps, self.seed = examples, rules, steps, seed
        self.device = device()
        self.network = layers(
            examples.inputs.shape[1],
            examples.goals.shape[1],
            rules.width,
            rules.levels,
            seed,
        ).to(self.device)
        rate = rules.rate
        self.optimiser = torch.optim.Adam(self.network.parameters(), rate / START)
        self.schedule = torch.optim.lr_scheduler.OneCycleLR(self.optimiser, rate, steps)
        self.step, self.kept_step = 0, 0
        self.kept: dict[str, Any] = {}
        self.curve: list[float] = []

    def go_on(self, steps: int) -> None:
        """Take steps, and look at the validation images."""
        for _ in range(steps):
            shown, goals = self.batch()
            found = applied(self.network, shown, self.examples.residual)
            loss = (found - goals).abs().mean()
            self.optimiser.zero_grad()
            loss.backward()
            self.optimiser.step()
            self.schedule.step()
            self.step += 1
        self.curve.append(self.error())
        if self.curve[-1] == min(self.curve):
            weights = self.network.state_dict()
            self.kept = {name: w.detach().cpu().clone() for name, w in weights.items()}
            self.kept_step = self.step

    def batch(self) -> tuple[Any, Any]:
        """Return what the next step's network is shown, and its goals."""
        import torch

        examples, size = self.examples, self.rules.size
        rng = np.random.default_rng([self.seed, CROPS, self.step])
        most = len(examples.inputs) - examples.validation
        inputs, goals = [], []
        for number in rng.integers(0, most, self.rules.batch):
            crop = drawn_crop(examples, size, rng)
            inputs.append(crop(examples.inputs[number]))
            goals.append(crop(examples.goals[number]))
        shown = examples.shown(np.stack(inputs), rng)
        return tuple(
            torch.from_numpy(array).to(self.device)
            for array in (shown, np.stack(goals))
        )

    def error(self) -> float:
        """Return the mean squared error on the validation images."""
        examples, last = self.examples, slice(-self.examples.validation, None)
        rng = np.random.default_rng([self.seed, VALIDATION])
        shown = examples.shown(examples.inputs[last], rng)
        found = Trained(self.network, examples.residual, self.step, [])(shown)
        return float(((found - examples.goals[last]) ** 2).mean(dtype=np.float64))

    def state(self) -> dict[str, Any]:
        """Return all that a training goes on from; of one that is done, its result."""
        state = {
            "step": self.step,
            "kept": self.kept,
            "kept_step": self.kept_step,
            "curve": self.curve,
        }
        if self.step == self.steps:
            return state
        return state | {
            "network": self.network.state_dict(),
            "optimiser": self.optimiser.state_dict(),
            "schedule": self.schedule.state_dict(),
        }

    def resume(self, state: dict[str, Any]) -> None:
        """Go on from a state."""
        self.step, self.curve = state["step"], list(state["curve"])
        self.kept, self.kept_step = state["kept"], state["kept_step"]
        if self.step < self.steps:
            self.network.load_state_dict(state["network"])
            self.optimiser.load_state_dict(state["optimiser"])
            self.schedule.load_state_dict(state["schedule"])

    def best(self) -> Trained:
        """Return the network with the best weights."""
        self.network.load_state_dict(self.kept)
        return Trained(self.network, self.examples.residual, self.kept_step, self.curve)


def drawn_crop(
    examples: Examples, size: int, rng: np.random.Generator
) -> Callable[[Array], Array]:
    """Return what takes the same size x size sites of images (c, h, w), and flips them.

    Raises ValueError if images are too small for it."""
    height, width = examples.inputs.shape[2:]
    room = max((max(site) for site in examples.sites), default=0)
    if min(height, width) < size + room:
        raise ValueError(
            f"images of {width}x{height} are too small for crops of {size + room}"
        )
    top, left = (int(rng.integers(room, side - size + 1)) for side in (height, width))
    upside_down, mirrored = rng.random(2) < 0.5

    def crop(image: Array) -> Array:
        sites = examples.sites or [(0, 0)] * len(image)
        planes = [
            plane[
                np.ix_(
                    along(top, size, row, upside_down),
                    along(left, size, column, mirrored),
                )
            ]
            for plane, (row, column) in zip(image, sites, strict=True)
        ]
        return np.stack(planes)

    return crop


def along(first: int, size: int, site: int, flipped: bool) -> NDArray[np.int64]:
    """Return the places of a crop along one axis of a plane.

    site : 1 for a plane whose pixels follow those of 0 in the mosaic. Flipped, they
        would go before them, so the plane is taken from one place earlier."""
    places = np.arange(first, first + size)
    return (places - site)[::-1] if flipped else places
