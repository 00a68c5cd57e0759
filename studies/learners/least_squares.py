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
Solution = NDArray[np.float64]
Pair = tuple[Array, Array]  # inputs (m, d), outputs (m, k)
SPREAD = 2.0  # sd of a feature's sum over standardised inputs, if not told
OFFSETS = 1.5  # most of a feature's offset
ROWS = 1 << 11  # at a time: few enough that a processor's cache holds their features
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
        hidden = inputs @ self.weights
        hidden += self.offsets
        np.maximum(hidden, 0.0, out=hidden)
        ones = np.ones((len(values), 1), np.float32)
        return np.concatenate([ones, inputs, hidden], axis=1)


@dataclass(frozen=True)
class Learnt:
    """A map from inputs to outputs, and the ridge that was best for it."""

    features: Features
    solution: Solution
    ridge: float

    def __call__(self, values: Array) -> Array:
        """Return outputs (m, k) of inputs (m, d)."""
        parts = [
            self.features(values[first : first + ROWS]) @ self.solution
            for first in range(0, len(values), ROWS)
        ]
        return np.concatenate(parts).astype(np.float32)


def features(values: Array, count: int, seed: int, spread: float = SPREAD) -> Features:
    """Return count random Features, scaled to inputs (m, d)."""
    rng = np.random.default_rng([seed, 88])
    depth = values.shape[1]
    weights = rng.normal(0.0, spread / np.sqrt(depth), (depth, count))
    offsets = rng.uniform(-OFFSETS, OFFSETS, count)
    scale = max(float(values.std(axis=0).mean()), LEAST)
    mean = values.mean(axis=0).astype(np.float32)
    return Features(mean, scale, weights.astype(np.float32), offsets.astype(np.float32))


def learn(
    training: Pair, validation: Pair, count: int, ridges: Sequence[float], seed: int
) -> Learnt:
    """Return what is learnt of training inputs (m, d) and outputs (m, k) by so many
    random features.

    ridges, validation : see `fitted`."""
    layer = features(training[0], count, seed)
    return fitted(layer, training, validation, ridges)


def fitted(
    layer: Features, training: Pair, validation: Pair, ridges: Sequence[float]
) -> Learnt:
    """Return what is learnt of training inputs (m, d) and outputs (m, k) by features.

    ridges : tried one after the other; the one with the least squared error on the
        validation pair is kept, so that no source's is chosen by hand."""
    values, outputs = training
    normal, right = sums(layer, values, outputs)
    solutions = [
        solved(normal + ridge * len(values) * np.eye(len(normal)), right)
        for ridge in ridges
    ]
    together = Learnt(layer, np.hstack(solutions), 0.0)(validation[0])
    goals = np.tile(validation[1], len(ridges))
    squares = ((together - goals) ** 2).mean(axis=0, dtype=np.float64)
    best = int(squares.reshape(len(ridges), -1).mean(axis=1).argmin())
    return Learnt(layer, solutions[best], ridges[best])


def solved(normal: Solution, right: Solution) -> Solution:
    """Return the solution of normal equations."""
    return np.asarray(np.linalg.solve(normal, right), np.float64)


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
