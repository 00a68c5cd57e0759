# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Measure torch_synthesis.py on a folder of renders, or train a denoiser with it.

examples:
  python torch_training.py renders/ --sensor samsung-s20fe --iso 1600,3200 --workers 2
  python torch_training.py renders/ --sensor samsung-s20fe --iso 1600,3200 --train 500
"""

import argparse
import itertools
import math
import resource
import sys
import time
from pathlib import Path

try:
    import torch
except ModuleNotFoundError:
    sys.exit("torch_training.py: PyTorch is not installed: pip install torch")
from torch_synthesis import SynthesisedPairs, renders_in

SIZES = (64, 128)  # sides of the crops that are measured, pixels
BATCH = 16
STEPS = 40  # of training that are timed
WARM_UP = 6  # steps before them, in which workers start
PAIRS, FILES = 1024, 4  # that one process makes and decodes to be timed
HELD_OUT = 64  # crops of renders that training does not see
WIDTH = 16  # channels of the network's first level
SLOPE = 0.1  # below 0, of the leaky ReLUs
RATE = 2e-3  # of Adam


class UNet(torch.nn.Module):
    """A U-net of two levels that takes the noise out of (N, 4, h, w) planes."""

    def __init__(self):
        super().__init__()
        self.first = convolutions(4, WIDTH)
        self.below = convolutions(WIDTH, 2 * WIDTH)
        self.up = torch.nn.ConvTranspose2d(2 * WIDTH, WIDTH, 2, stride=2)
        self.last = convolutions(2 * WIDTH, WIDTH)
        self.out = torch.nn.Conv2d(WIDTH, 4, 1)
        torch.nn.init.zeros_(self.out.weight)  # at first, nothing is taken out
        torch.nn.init.zeros_(self.out.bias)

    def forward(self, noisy):
        fine = self.first(noisy)
        coarse = self.below(torch.nn.functional.max_pool2d(fine, 2))
        return noisy + self.out(self.last(torch.cat([fine, self.up(coarse)], 1)))


def convolutions(inner, outer):
    """Return two 3x3 convolutions, each with a leaky ReLU."""
    return torch.nn.Sequential(
        torch.nn.Conv2d(inner, outer, 3, padding=1),
        torch.nn.LeakyReLU(SLOPE),
        torch.nn.Conv2d(outer, outer, 3, padding=1),
        torch.nn.LeakyReLU(SLOPE),
    )


class Trainer:
    """A U-net and its optimiser; a call is one training step."""

    def __init__(self, seed=0):
        torch.manual_seed(seed)
        self.net = UNet()
        self.optimiser = torch.optim.Adam(self.net.parameters(), RATE)

    def __call__(self, batch):
        self.optimiser.zero_grad()
        denoised = self.net(batch["noisy"])
        loss = torch.nn.functional.mse_loss(denoised, batch["clean"])
        loss.backward()
        self.optimiser.step()
        return loss.item()


def pairs_of(paths, options, size, items, seed=0):
    """Return a dataset with at least @items items."""
    return SynthesisedPairs(
        paths,
        options.sensor,
        size=size,
        isos=options.iso,
        crops=options.crops,
        epochs=-(-items // (len(paths) * options.crops)),
        seed=seed,
    )


def loader_of(data, options, steps):
    """Return a loader of the first @steps batches."""
    return torch.utils.data.DataLoader(
        data,
        batch_size=BATCH,
        num_workers=options.workers,
        sampler=range(steps * BATCH),
    )


def decoding(paths, options):
    """Return CPU ms per file that this process decodes."""
    files = pairs_of(paths[:FILES], options, SIZES[0], 1)
    rounds = []
    for _ in range(2):  # the first one allocates
        files.images.clear()
        rounds.append(cpu_ms(files.image, files.paths))
    return min(rounds)


def making(paths, options, size):
    """Return CPU ms per pair that this process makes of a decoded image."""
    pairs = pairs_of(paths[:1], options, size, PAIRS + 1)
    pairs[PAIRS]  # not timed: decodes
    return cpu_ms(pairs.__getitem__, range(PAIRS))


def cpu_ms(work, inputs):
    """Return the CPU ms of this process, and of workers that ended, per input."""
    start = cpu_seconds()
    for value in inputs:
        work(value)
    return 1e3 * (cpu_seconds() - start) / len(inputs)


def cpu_seconds():
    """Return the CPU seconds of this process, and of workers that ended."""
    ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.process_time() + ended.ru_utime + ended.ru_stime


def exhaust(batches):
    """Take all batches, and do nothing with them."""
    for _ in batches:
        pass


def stepping(batches, step):
    """Return wall ms of a step, and of the wait for its batch: their means."""
    batches = iter(batches)
    for batch in itertools.islice(batches, WARM_UP):
        step(batch)
    begin, waited = time.perf_counter(), 0.0
    for count in itertools.count():
        asked = time.perf_counter()
        batch = next(batches, None)
        waited += time.perf_counter() - asked
        if batch is None:
            return 1e3 * (time.perf_counter() - begin) / count, 1e3 * waited / count
        step(batch)


def measured(paths, options, size, decode):
    """Return what is printed of one size of crops, by its name.

    decode : CPU ms of a file; each worker decodes each file."""
    pair, steps = making(paths, options, size), WARM_UP + STEPS
    spread = decode * max(1, options.workers) / options.crops
    data = pairs_of(paths, options, size, steps * BATCH)
    ready = [data[0]] * len(data)  # to measure what the loader itself takes
    loaders = {
        "made": loader_of(data, options, steps),
        "ready": loader_of(ready, options, steps),
    }
    null = {name: cpu_ms(exhaust, [way]) / steps for name, way in loaders.items()}
    trainer, same = Trainer(), next(iter(loaders["ready"]))
    alone = cpu_ms(trainer, [same] * steps)
    wall = {name: stepping(way, trainer) for name, way in loaders.items()}
    share = {name: f"{100 * wait / step:.1f} %" for name, (step, wait) in wall.items()}
    return {
        "frames per CPU second, of decoded renders": f"{2e3 / pair:.0f}",
        "megapixels per CPU second, likewise": f"{2 * size**2 / pair / 1e3:.1f}",
        "frames per CPU second, with decoding": f"{2e3 / (pair + spread):.0f}",
        "CPU ms per batch, null step": f"{null['made']:.1f}",
        "CPU ms per batch, items ready": f"{null['ready']:.1f}",
        "CPU ms per training step, same batch again": f"{alone:.1f}",
        "share of training that waits for data": share["made"],
        "share that waits, items ready": share["ready"],
    }


def measure(paths, options):
    """Print the throughput of each size of crops, one beside the other."""
    decode = decoding(paths, options)
    print(
        f"{options.sensor}: batches of {BATCH} pairs, {options.workers} workers, "
        f"{options.crops} crops a render, which takes {decode:.0f} CPU ms to decode"
    )
    columns = [measured(paths, options, size, decode) for size in SIZES]
    print(f"{'':44}" + "".join(f"{f'crops of {size}':>14}" for size in SIZES))
    for name in columns[0]:
        print(f"{name:44}" + "".join(f"{column[name]:>14}" for column in columns))


def train(paths, options):
    """Train on most renders, and print PSNR of crops of the others."""
    size = SIZES[-1]
    held = max(1, len(paths) // 4)
    if held == len(paths):
        raise ValueError("--train needs two renders or more: one is held out")
    data = pairs_of(paths[:-held], options, size, options.train * BATCH)
    trainer = Trainer()
    for count, batch in enumerate(loader_of(data, options, options.train), 1):
        loss = trainer(batch)
        if count % math.ceil(options.train / 5) == 0 or count == options.train:
            print(f"step {count}: mean squared error {loss:.2e}", flush=True)
    others = pairs_of(paths[-held:], options, size, HELD_OUT, seed=1)
    noisy, denoised = psnr(trainer.net, loader_of(others, options, HELD_OUT // BATCH))
    print(
        f"{HELD_OUT} crops of {held} held-out renders: PSNR {noisy:.2f} dB noisy, "
        f"{denoised:.2f} dB denoised"
    )


def psnr(net, batches):
    """Return PSNR in dB, white 1, of what is (noisy, denoised), over all batches."""
    errors = []
    with torch.no_grad():
        for batch in batches:
            noisy, clean = batch["noisy"], batch["clean"]
            errors.append([((x - clean) ** 2).mean() for x in (noisy, net(noisy))])
    return [-10 * math.log10(error) for error in torch.tensor(errors).mean(0)]


def isos(text):
    """Return the numbers of a list with commas."""
    return [float(word) for word in text.split(",")]


def positive(text):
    """Return a whole number above 0."""
    if int(text) < 1:
        raise ValueError
    return int(text)


def parsed():
    """Return the options of the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path, help="renders, .exr")
    parser.add_argument("--sensor", required=True, help="id or profile of a sensor")
    parser.add_argument(
        "--iso", type=isos, required=True, help="one is drawn: 800,1600"
    )
    parser.add_argument(
        "--workers", type=int, default=2, help="processes that make RAW"
    )
    parser.add_argument(
        "--crops", type=positive, default=64, help="of a render in an epoch"
    )
    parser.add_argument("--train", type=positive, metavar="N", help="train for N steps")
    return parser.parse_args()


def main():
    options = parsed()
    try:
        paths = renders_in(options.folder, max(SIZES))
        (train if options.train else measure)(paths, options)
    except (OSError, ValueError) as error:
        sys.exit(f"torch_training.py: {error}")


if __name__ == "__main__":
    main()
