# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A PyTorch Dataset that makes RAW while it trains: no files but the renders.

Every item has a crop, a light, a digital gain, an ISO and noise of its own, which seed,
epoch and index decide. torch_training.py measures it and trains with it.
"""

from collections import OrderedDict
from pathlib import Path

import numpy as np
import torch

import cg2raw
from cg2raw.dataset.packed import packed
from cg2raw.dataset.worker import use_one_thread
from cg2raw.io.image_file import image_size, read_image


def renders_in(folder, size):
    """Return the paths of the EXRs in a folder and its folders, in order.

    size : side of a crop. Raises ValueError if there are none, or one is smaller."""
    paths = sorted(Path(folder).rglob("*.exr"))
    if not paths:
        raise ValueError(f"{folder}: no renders (.exr) in this folder")
    for path in paths:
        height, width = image_size(path)
        if min(height, width) < size:
            raise ValueError(f"{path}: {width}x{height} pixels, the crops have {size}")
    return paths


class SynthesisedPairs(torch.utils.data.Dataset):
    """Noisy and clean RAW of random crops, made by the bindings.

    paths : image files, as `cg2raw dataset` reads them. sensor : id of a Bayer sensor
    whose noise is known. size : side of a crop, pixels, even. isos : one is drawn.
    crops : of each image in an epoch. epochs : how many follow each other in the items;
    each is drawn anew. noise : None for what the sensor's profile says, or "gaussian"
    or "physical". run : more fields of cg2raw.Run for both, such as convention.
    cached : decoded images that a process keeps. Items that follow each other are of as
    many images, in random order, so that a process decodes a file once in an epoch, few
    of them twice; a sampler that shuffles again would undo that.

    Items are dicts of float32 tensors: "noisy" and "clean", (4, size / 2, size / 2)
    planes R, G1, G2, B, 0..1 above black; "neutral", (3,) camera RGB of the light,
    G = 1; "camera_from_xyz", (3, 3), the ColorMatrix at this light; "iso", ().
    Item and batch are the same for any number of a DataLoader's workers, which it hands
    whole batches. Raises ValueError for a sensor, a size or an ISO that cannot be."""

    def __init__(
        self,
        paths,
        sensor,
        *,
        size=256,
        isos=(100, 800, 3200),
        crops=64,
        epochs=1,
        seed=0,
        noise=None,
        cached=8,
        **run,
    ):
        self.paths, self.size, self.isos, self.seed = list(paths), size, isos, seed
        self.crops, self.epochs, self.cached = crops, epochs, cached
        self.sensor, self.noise, self.run = cg2raw.Sensor(sensor), noise, run
        if sorted(self.sensor.cfa) != list("BGGR"):
            raise ValueError(f"sensor {sensor}: its CFA is not Bayer, no four planes")
        if size < 2 or size % 2:
            raise ValueError(f"size {size} of a crop must be even, 2 or more")
        for iso in isos:
            self.sensor.noise_at(iso)
        self.images = OrderedDict()  # by path, the last one used last
        self.order = (-1, None)  # an epoch, and the image of each of its items

    def __len__(self):
        return self.epochs * len(self.paths) * self.crops

    def __getitem__(self, number):
        if not 0 <= number < len(self):
            raise IndexError(number)
        path, place, iso, run = self.recipe(number)
        scene = self.crop(path, place)
        light = self.sensor.illuminant(run["illuminant"])
        noisy = self.sensor.simulate(scene, iso=iso, noise=self.noise, threads=1, **run)
        matrix = self.sensor.camera_from_xyz(light.xy)
        return {
            "noisy": self.planes(noisy),
            "clean": self.planes(self.sensor.simulate(scene, threads=1, **run)),
            "neutral": torch.tensor(light.neutral, dtype=torch.float32),
            "camera_from_xyz": torch.tensor(matrix, dtype=torch.float32),
            "iso": torch.tensor(iso, dtype=torch.float32),
        }

    def recipe(self, number):
        """Return what is drawn for an item: (path, place, iso, fields of a Run).

        place : two numbers 0..1, from the first to the last place of a crop."""
        epoch, index = divmod(number, len(self.paths) * self.crops)
        # Index 0 is that of the epoch's order.
        draw = np.random.default_rng((self.seed, epoch, index + 1))
        run = {
            "illuminant": f"sample:{draw.integers(2**31)}",
            "digital_gain": draw.uniform(0.6, 1.0),
            "seed": self.seed,
            "frame": int(draw.integers(2**53)),
        }
        path = self.paths[self.order_of(epoch)[index]]
        return path, draw.random(2), float(draw.choice(self.isos)), run | self.run

    def order_of(self, epoch):
        """Return which image each item of an epoch is of.

        The crops of an image are spread over a span in which self.cached images are in
        use; images whose span ends behind the epoch go on at its start."""
        if self.order[0] != epoch:
            draw = np.random.default_rng((self.seed, epoch, 0))
            count = len(self.paths)
            turns = np.repeat(np.arange(count), self.crops)
            when = turns + self.cached * draw.random(len(turns))
            turns = turns[np.argsort(when % count, kind="stable")]
            self.order = (epoch, draw.permutation(count)[turns])
        return self.order[1]

    def crop(self, path, place):
        """Return a square of an image."""
        rgb = self.image(path)
        if min(rgb.shape[:2]) < self.size:
            raise ValueError(f"{path}: smaller than a crop of {self.size} pixels")
        rooms = [side - self.size + 1 for side in rgb.shape[:2]]
        y, x = (int(part * room) for part, room in zip(place, rooms, strict=True))
        return np.ascontiguousarray(rgb[y : y + self.size, x : x + self.size])

    def image(self, path):
        """Return the pixels of an image, decoded unless this process keeps them."""
        if path not in self.images:
            # One thread: processes share the cores, and a pool does not survive a fork.
            use_one_thread()
            while len(self.images) >= self.cached:
                self.images.popitem(last=False)
            self.images[path] = read_image(path, undo="stated").pixels
        self.images.move_to_end(path)
        return self.images[path]

    def planes(self, raw):
        """Return the (4, h, w) float32 planes of a frame."""
        s = self.sensor
        return torch.from_numpy(
            packed(np.asarray(raw), s.cfa, s.black_level, s.white_level, "float32")
        )
