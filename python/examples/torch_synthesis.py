# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A PyTorch Dataset that makes RAW while it trains: no files but the renders.

Every item of every epoch has a light, a digital gain and noise of its own, which seed,
epoch and index decide.
"""

import numpy as np
import torch

import cg2raw
from cg2raw.dataset.packed import packed
from cg2raw.io.image_file import read_image


class SynthesisedPairs(torch.utils.data.Dataset):
    """Noisy and clean RAW of random crops, made by the bindings.

    paths : image files, as `cg2raw dataset` reads them. sensor : id of a Bayer sensor
    whose noise is known. size : side of a crop, pixels, even. isos : one is drawn."""

    def __init__(self, paths, sensor, *, size=256, isos=(100, 800, 3200), seed=0):
        self.paths, self.size, self.isos, self.seed = list(paths), size, isos, seed
        self.sensor = cg2raw.Sensor(sensor)
        self.epoch = 0  # raise it before each epoch, with workers that are not kept

    def __len__(self):
        return len(self.paths)

    def __getitem__(self, index):
        draw = np.random.default_rng((self.seed, self.epoch, index))
        image = read_image(self.paths[index], undo="stated")
        scene = self.crop(image.pixels, draw)
        run = {
            "illuminant": f"sample:{draw.integers(2**31)}",
            "digital_gain": draw.uniform(0.6, 1.0),
            "seed": self.seed,
            "frame": int(draw.integers(2**53)),
        }
        iso = float(draw.choice(self.isos))
        light = self.sensor.illuminant(run["illuminant"])
        return {
            "noisy": self.planes(
                self.sensor.simulate(scene, iso=iso, threads=1, **run)
            ),
            "clean": self.planes(self.sensor.simulate(scene, threads=1, **run)),
            "neutral": torch.tensor(light.neutral, dtype=torch.float32),
            "iso": iso,
        }

    def crop(self, rgb, draw):
        """Return a random square of an image."""
        y, x = (draw.integers(side - self.size + 1) for side in rgb.shape[:2])
        return np.ascontiguousarray(rgb[y : y + self.size, x : x + self.size])

    def planes(self, raw):
        """Return the (4, h, w) float32 planes of a frame."""
        s = self.sensor
        return torch.from_numpy(
            packed(np.asarray(raw), s.cfa, s.black_level, s.white_level, "float32")
        )
