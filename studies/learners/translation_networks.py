# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The networks of learners.translation and what their losses are made of.

Parts as Y. Jiang et al. describe them (see learners.translation), smaller: two scales
where theirs has four, and no batch normalisation."""

from typing import Any

SLOPE = 0.2  # of leaky ReLUs below 0
GRADIENTS = 2.0  # weight of gradients beside luminance
LEAST = 1e-3  # sd that luminance is divided by, at least


def generator(width: int) -> Any:
    """Return the U-net's layers, width channels at full size; its last is zero, so that
    training starts at the identity."""
    from torch import nn

    def block(inputs: int, outputs: int) -> Any:
        return nn.Sequential(
            nn.Conv2d(inputs, outputs, 3, padding=1),
            nn.LeakyReLU(SLOPE),
            nn.Conv2d(outputs, outputs, 3, padding=1),
            nn.LeakyReLU(SLOPE),
        )

    last = nn.Conv2d(width, 3, 1)
    nn.init.zeros_(last.weight)
    nn.init.zeros_(last.bias)
    return nn.ModuleDict(
        {
            "at_full": block(4, width),
            "at_half": block(width, 2 * width),
            "at_quarter": block(2 * width, 4 * width),
            "to_half": block(6 * width, 2 * width),
            "to_full": block(3 * width, width),
            "last": last,
        }
    )


def discriminator(width: int) -> Any:
    """Return a PatchGAN: (n, 3, h, w) to a map of scores, an eighth of each side."""
    from torch import nn

    layers: list[Any] = []
    for inputs, outputs in ((3, width), (width, 2 * width), (2 * width, 4 * width)):
        layers += [nn.Conv2d(inputs, outputs, 4, 2, 1), nn.LeakyReLU(SLOPE)]
    return nn.Sequential(*layers, nn.Conv2d(4 * width, 1, 3, 1, 1))


def translated(layers: Any, images: Any) -> Any:
    """Return images (n, 3, h, w) plus the U-net's change of them.

    Darkness is an input, and weighs what the U-net carries over and its change."""
    import torch
    from torch.nn.functional import avg_pool2d, interpolate

    def wider(coarse: Any, fine: Any, attention: Any) -> Any:
        grown = interpolate(coarse, size=fine.shape[2:], mode="bilinear")
        return torch.cat([grown, fine * attention], 1)

    dark = darkness(images)
    dark_half = avg_pool2d(dark, 2)
    full = layers["at_full"](torch.cat([images, dark], 1))
    half = layers["at_half"](avg_pool2d(full, 2))
    quarter = layers["at_quarter"](avg_pool2d(half, 2)) * avg_pool2d(dark_half, 2)
    half = layers["to_half"](wider(quarter, half, dark_half))
    full = layers["to_full"](wider(half, full, dark))
    return images + dark * layers["last"](full)


def darkness(images: Any) -> Any:
    """Return the attention (n, 1, h, w): 1 - luminance, of images in 0..1."""
    return 1.0 - luminance(images)


def luminance(images: Any) -> Any:
    """Return (n, 1, h, w), the mean of the channels: camera RGB has no other."""
    return images.mean(1, keepdim=True)


def relativistic(better: Any, worse: Any) -> Any:
    """Return the relativistic average least-squares loss by which the first scores (n,
    1, h, w) are to be one above the mean of the second, and those below the first."""
    above = (better - worse.mean() - 1.0) ** 2
    below = (worse - better.mean()) ** 2
    return 0.5 * (above.mean() + below.mean())


def squares(scores: Any, goal: float) -> Any:
    """Return the least-squares loss of scores that are to be goal."""
    return 0.5 * ((scores - goal) ** 2).mean()


def slope(scores: Any, images: Any) -> Any:
    """Return the squared gradient of scores by the images, for each score."""
    import torch

    (found,) = torch.autograd.grad(scores.sum(), images, create_graph=True)
    return found.square().sum() / scores.numel()


def content_change(before: Any, after: Any) -> Any:
    """Return the squared change of instance-normalised luminance and its gradients."""

    def normalised(images: Any) -> Any:
        level = luminance(images)
        centred = level - level.mean((2, 3), keepdim=True)
        return centred / centred.std((2, 3), keepdim=True).clamp_min(LEAST)

    change = normalised(after) - normalised(before)
    rows, columns = (change.diff(dim=side).square().mean() for side in (2, 3))
    return change.square().mean() + GRADIENTS * (rows + columns)
