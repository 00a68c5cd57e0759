# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A sensor for darks and flats, in electrons, that shares no code with the model."""

from typing import NamedTuple

import numpy as np

from cg2raw.statistics.constant import GroupInfo
from cg2raw.statistics.frame_statistics import frame_statistics

TIMES, LIGHTS = (0.0, 10.0), (0.12, 0.45)  # s of darks, shares of white of flats
FLAT_TIME = 0.5  # s
FRAMES = 6  # of each


class Planted(NamedTuple):
    """Groups, [(GroupInfo, frames), ...], and the truth in the units of the figures."""

    groups: list
    side: int
    white: int
    truth: dict[str, float]

    @property
    def statistics(self):
        readers = [(info, [lambda f=f: f for f in of]) for info, of in self.groups]
        return frame_statistics(readers, self.side, self.white)


def planted(seed, low=False, shape=(120, 160), side=1, black=None, noise=None):
    """Return a sensor whose effects are all there, each of a drawn strength.

    low : noise of 0.25 to 0.8 DN, and a black level of 0, 4 or 64 DN. side : px of the
    CFA's repeat; its sites have black levels and read noises of their own. black,
    noise : DN, in place of those drawn."""
    rng = np.random.default_rng((seed, low, side))
    h, w = shape
    white = 1023 if low else 4095
    drawn = float(rng.choice([0, 0, 4, 64] if low else [64, 256, 600]))
    black = drawn if black is None else black
    read = rng.uniform(1.5, 6)  # electrons
    drawn = np.exp(rng.uniform(*np.log((0.25, 0.8) if low else (1.2, 8))))
    gain = read / (drawn if noise is None else noise)  # electrons per DN

    def strength(least, most):  # electrons, in units of read noise
        return float(np.exp(rng.uniform(np.log(least), np.log(most)))) * read

    def centred(values):
        return values - values.mean()

    down, across = np.mgrid[-1 : 1 : h * 1j, -1 : 1 : w * 1j]
    rows, columns, drift = strength(0.1, 0.5), strength(0.1, 0.5), strength(0.05, 1)
    own, pattern = strength(0.15, 0.8), strength(0.1, 0.5)
    bias = strength(0.2, 2) * centred(rng.uniform(0.3, 1) * across + 0.4 * down**2)
    bias += 0.2 * read * down * across
    rate = strength(0.1, 1)  # electrons per second
    uneven = rate * rng.uniform(0.1, 0.25)
    prnu, fall = rng.uniform(0.003, 0.02), rng.uniform(0.02, 0.3)
    shade = fall * centred((across - 0.1) ** 2 + (down + 0.2) ** 2) / 2
    link = rng.uniform(-0.1, 0.1)  # of neighbours in a row
    lagged = (1 - np.sqrt(1 - 4 * link**2)) / (2 * link)
    offset = bias + own * centred(rng.standard_normal(shape))
    offset += pattern * centred(rng.standard_normal(w))
    dark = rate + uneven * centred(rng.standard_normal(shape))
    response = 1 + shade + prnu * centred(rng.standard_normal(shape))
    # Sites of a CFA differ in level and noise.
    site = np.add.outer(side * (np.arange(h) % side), np.arange(w) % side)
    blacks = black + 3.0 * np.arange(side**2)
    reads = read * (1 + 0.1 * np.arange(side**2))

    def frame(seconds, light):
        charge = rng.poisson(np.maximum(dark * seconds + light * response, 0))
        noise = rng.standard_normal((h, w + 1))
        noise = (noise[:, 1:] + lagged * noise[:, :-1]) / np.sqrt(1 + lagged**2)
        charge = charge + reads[site] * noise + offset + drift * rng.standard_normal()
        charge += rows * rng.standard_normal((h, 1))
        charge += columns * rng.standard_normal(w)
        codes = np.rint(blacks[site] + charge / gain)
        return np.clip(codes, 0, white).astype(np.uint16)

    full = (white - black) * gain
    kinds = [("dark", seconds, 0.0) for seconds in TIMES]
    kinds += [("flat", FLAT_TIME, share * full) for share in LIGHTS]
    names = tuple(str(n) for n in range(FRAMES))
    groups = [
        (
            GroupInfo(kind, names, seconds),
            [frame(seconds, light) for _ in range(FRAMES)],
        )
        for kind, seconds, light in kinds
    ]
    truth = {
        "black level drift": drift / gain,
        "dark current": rate / gain,
        "row noise": rows / gain,
        "column noise": columns / gain,
        "DSNU": own / gain,
        "fixed column pattern": pattern / gain,
        "bias structure": float(bias.std()) / gain,
        "dark current nonuniformity": uneven / gain,
        "PRNU": prnu,
        "shading": float(shade.std()),
    }
    if side == 1 and black > 8 * read / gain:
        truth["correlation, next in row"] = link
    for n in range(side**2):
        truth[f"black level {n}"] = blacks[n]
        truth[f"read noise {n}"] = reads[n] / gain
        truth[f"gain {n}"] = gain
    return Planted(groups, side, white, truth)
