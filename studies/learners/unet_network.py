# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A U-net's layers, and what they make of images. It needs PyTorch.

Source: O. Ronneberger, P. Fischer, T. Brox, U-Net: Convolutional Networks for
Biomedical Image Segmentation, MICCAI 2015; padded, with leaky ReLUs, as C. Chen et al.,
Learning to See in the Dark, CVPR 2018, have it."""

from typing import Any

SLOPE = 0.2  # of leaky ReLUs below 0


def layers(inputs: int, outputs: int, width: int, levels: int, seed: int) -> Any:
    """Return the layers, width channels at full size and twice as many at each of the
    other levels. Weights are drawn by the seed; the last are 0."""
    import torch
    from torch import nn

    def convolution(first: int, second: int) -> Any:
        layer = nn.Conv2d(first, second, 3, padding=1)
        nn.init.kaiming_normal_(layer.weight, SLOPE)
        nn.init.zeros_(layer.bias)
        return layer

    def block(first: int, second: int) -> Any:
        parts = (convolution(first, second), convolution(second, second))
        return nn.Sequential(
            *(p for part in parts for p in (part, nn.LeakyReLU(SLOPE)))
        )

    torch.manual_seed(seed)
    widths = [width << level for level in range(levels)]
    pairs = list(zip(widths, widths[1:], strict=False))
    last = nn.Conv2d(width, outputs, 1)
    nn.init.zeros_(last.weight)
    nn.init.zeros_(last.bias)
    return nn.ModuleDict(
        {
            "down": nn.ModuleList(
                [block(inputs, width), *(block(fine, coarse) for fine, coarse in pairs)]
            ),
            "wider": nn.ModuleList(
                [nn.ConvTranspose2d(coarse, fine, 2, 2) for fine, coarse in pairs]
            ),
            "up": nn.ModuleList([block(2 * fine, fine) for fine, _ in pairs]),
            "last": last,
        }
    )


def applied(parts: Any, images: Any, residual: bool) -> Any:
    """Return (n, outputs, h, w) of images (n, inputs, h, w), whose sides the levels can
    halve. residual : the network's output is added to the images."""
    import torch
    from torch.nn.functional import max_pool2d

    kept, values = [], images
    for level, block in enumerate(parts["down"]):
        values = block(max_pool2d(values, 2) if level else values)
        kept.append(values)
    for level in reversed(range(len(parts["up"]))):
        wide = parts["wider"][level](values)
        values = parts["up"][level](torch.cat([wide, kept[level]], dim=1))
    found = parts["last"](values)
    return images + found if residual else found
