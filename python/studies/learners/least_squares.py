# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Least squares on random features: a learner without a schedule, and so nearly without
noise of its own.

A hidden layer of random weights and ReLU, and an output that is solved for.
Source: W. Schmidt, M. Kraaijveld, R. Duin, Feedforward Neural Networks with Random
Weights, ICPR 1992."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float32]
SPREAD = 2.0  # sd of a feature's sum over standardised inputs
OFFSETS = 1.5  # most of a feature's offset
ROWS = 1 << 15  # at a time
LEAST = 1e-6  # sd that an input is divided by, at least


@dataclass(frozen=True)
class Features:
    """The hidden layer: constant, inputs, and count ReLUs of random sums of them."""

    mean: Array  # (d,)
    scale: float
    weights: Array  # (d, count)
    offsets: Array  # (count,)

    def __call__(self, values: Array) -> Array:
        """Return (m, 1 + d + count) of inputs (m, d)."""
        inputs = (values - self.mean) / np.float32(self.scale)
        hidden = np.maximum(inputs @ self.weights + self.offsets, 0.0)
        ones = np.ones((len(values), 1), np.float32)
        return np.concatenate([ones, inputs, hidden], axis=1)


@dataclass(frozen=True)
class Learnt:
    """A map from inputs to outputs, and the ridge that was best for it."""

    features: Features
    solution: NDArray[np.float64]
    ridge: float

    def __call__(self, values: Array) -> Array:
        """Return outputs (m, k) of inputs (m, d)."""
        parts = [
            self.features(values[first : first + ROWS]) @ self.solution
            for first in range(0, len(values), ROWS)
        ]
        return np.concatenate(parts).astype(np.float32)


def features(values: Array, count: int, seed: int) -> Features:
    """Return count random Features, scaled to inputs (m, d)."""
    rng = np.random.default_rng([seed, 88])
    depth = values.shape[1]
    weights = rng.normal(0.0, SPREAD / np.sqrt(depth), (depth, count))
    offsets = rng.uniform(-OFFSETS, OFFSETS, count)
    scale = max(float(values.std(axis=0).mean()), LEAST)
    mean = values.mean(axis=0).astype(np.float32)
    return Features(mean, scale, weights.astype(np.float32), offsets.astype(np.float32))


def learn(
    training: tuple[Array, Array],
    validation: tuple[Array, Array],
    count: int,
    ridges: Sequence[float],
    seed: int,
) -> Learnt:
    """Return what is learnt of training inputs (m, d) and outputs (m, k).

    ridges : tried one after the other; the one with the least squared error on the
        validation pair is kept, so that no source's is chosen by hand."""
    values, outputs = training
    layer = features(values, count, seed)
    normal, right = sums(layer, values, outputs)
    found = []
    for ridge in ridges:
        loaded = normal + ridge * len(values) * np.eye(len(normal))
        solution = np.asarray(np.linalg.solve(loaded, right), np.float64)
        learnt = Learnt(layer, solution, ridge)
        error = float(((learnt(validation[0]) - validation[1]) ** 2).mean())
        found.append((error, learnt))
    return min(found, key=lambda pair: pair[0])[1]


def sums(
    layer: Features, values: Array, outputs: Array
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the normal equations' matrix and right side, in float64."""
    width = 1 + values.shape[1] + len(layer.offsets)
    normal, right = np.zeros((width, width)), np.zeros((width, outputs.shape[1]))
    for first in range(0, len(values), ROWS):
        part = layer(values[first : first + ROWS]).astype(np.float64)
        normal += part.T @ part
        right += part.T @ outputs[first : first + ROWS]
    return normal, right
