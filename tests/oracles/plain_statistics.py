# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The statistics of darks and flats in plain numpy: what they are, by example.

All frames are held at once; FrameStatistics, which streams, is checked against it."""

from itertools import product

import numpy as np
from scipy.ndimage import median_filter

from cg2raw.statistics.constant import (
    BINS_PER_SIGMA,
    BLOCKS,
    FIELD,
    LAGS,
    MOST_LINES,
    PLACES,
    SMOOTH,
    ConstantStatistics,
    GroupInfo,
    PlaneStatistics,
    of_profiles,
    polynomials,
)

POINT, LINE = 8.0, 10.0  # sigma, from which samples and whole lines are masked
LEAST_SIGMA = 0.25  # DN: steps of codes are no outliers
LOST = 0.9  # of a line's samples masked: the whole line is
FILLS = 200  # far beyond where one moves the next
WINDOW = 9  # lines of the running median
BINS = 512
NOISY = 4.0  # sigma of a pair


def plain_statistics(groups, side, white, excluded=None):
    """Return ConstantStatistics of [(GroupInfo, [(H, W) uint16 DN, ...]), ...].

    side : px of the CFA's square repeat, at most H and W. white : DN.
    excluded : (H, W) bool, samples that do not count."""
    if excluded is None:
        excluded = np.zeros(groups[0][1][0].shape, bool)
    planes, residuals = [], []
    for row, column in product(range(side), repeat=2):
        frames = [
            np.array([f[row::side, column::side] for f in given], float)
            for _, given in groups
        ]
        plane, rest = plane_statistics(frames, white, excluded[row::side, column::side])
        planes.append(plane)
        residuals.append(rest)
    shape = groups[0][1][0].shape
    lags = []
    for g, (_, given) in enumerate(groups):
        found = []
        for pair in range(len(given) // 2):
            mosaic = np.full(shape, np.nan)
            places = product(range(side), repeat=2)
            for (row, column), of_plane in zip(places, residuals, strict=True):
                mosaic[row::side, column::side] = of_plane[g][pair]
            found.append([correlation(mosaic, *lag) for lag in LAGS])
        lags.append(np.mean(found, axis=0) if found else np.zeros(len(LAGS)))
    counts = np.array([len(given) for _, given in groups])
    noisy = np.array([noisy_of(g, residuals) for g in range(len(groups))], int)
    return ConstantStatistics(
        groups=tuple(GroupInfo(**vars(info)) for info, _ in groups),
        planes=tuple(planes),
        frames=counts,
        pairs=counts // 2,
        lags=np.array(lags),
        white=white,
        overlaps=noisy @ noisy.T,
        mean_of=lambda n: np.mean(groups[n][1], axis=0, dtype=np.float32),
        transients=np.zeros((len(groups), 1, 2), int),
    )


def noisy_of(group, residuals):
    """Return (samples,) bool, which are beyond NOISY in a pair; of all planes."""
    found = []
    for of_plane in residuals:
        first = next(iter(sum(of_plane, [])), np.zeros(0))
        noisy = np.zeros(first.shape, bool)
        for pair in of_plane[group]:
            noisy |= np.abs(pair) > NOISY
        found.append(noisy.ravel())
    return np.concatenate(found)


def plane_statistics(groups, white, excluded):
    """Return (PlaneStatistics, residuals of pairs over their sd, nan where masked)."""
    h, w = groups[0].shape[1:]
    mask = outliers(groups, excluded)
    freedom = freedoms(h, w) * (1 - mask.mean())
    rows, columns = (np.count_nonzero(~mask.all(axis=axis)) for axis in (1, 0))
    lines = rows * columns / (h * w)
    field = (h - 1) * (w - 1) - freedoms(h, w)[-1]
    freedom[-1] = ((rows - 1) * (columns - 1) / lines - field) * (1 - mask.mean())
    top = int(max(frames.max() for frames in groups)) + 1
    counted = [frames[:, ~excluded].ravel().astype(int) for frames in groups]
    codes = np.array([np.bincount(one, minlength=top) for one in counted])
    clipped = [[np.mean(one <= 0), np.mean(one >= white)] for one in counted]
    raw, groups = groups, [without(frames, mask) for frames in groups]
    means = [frames.mean(axis=0) for frames in groups]
    level = np.array([mean.mean() for mean in means])
    centred = np.array(means) - level[:, None, None]
    moments, residuals, outlier_noise = [], [], []
    for frames, as_read in zip(groups, raw, strict=True):
        rests = differences(frames)
        smooths = [smooth_of(rest) for rest in rests]
        masked = zip(differences(as_read), smooths, strict=True)
        squares = [(rest - smooth)[mask] ** 2 for rest, smooth in masked]
        none = np.full(mask.sum(), np.nan)
        outlier_noise.append(np.mean(squares, axis=0) if squares else none)
        rests = [rest - smooth for rest, smooth in zip(rests, smooths, strict=True)]
        with np.errstate(divide="ignore", invalid="ignore"):  # nan: none is known
            powers = np.array(
                [(rest**2).sum() / (freedom[-1] or np.nan) for rest in rests]
            )
            scaled = [rest / np.sqrt(p) for rest, p in zip(rests, powers, strict=True)]
        residuals.append([np.where(mask, np.nan, one) for one in scaled])
        kept = [one[np.isfinite(one)] for one in residuals[-1]]
        kept = [one for one in kept if len(one)]
        inside = np.concatenate(kept) if kept else np.zeros(0)
        bins = np.minimum(np.abs(inside) * BINS_PER_SIGMA, BINS - 1).astype(int)
        moments.append(
            (
                powers.mean() if len(powers) else np.nan,
                np.mean([(z**4).mean() / (z**2).mean() ** 2 for z in kept])
                if kept
                else np.nan,
                np.bincount(bins, minlength=BINS),
                blocks_of(
                    sum(np.where(mask, 0, r) ** 2 for r in rests) + np.zeros((h, w))
                ),
            )
        )
    power, fourth, histograms, noise = (
        np.array(one) for one in zip(*moments, strict=True)
    )
    return PlaneStatistics(
        freedom=freedom,
        level=level,
        levels=tuple(frames.mean(axis=(1, 2)) for frames in groups),
        rows=centred.mean(axis=2),
        columns=centred.mean(axis=1),
        field=np.array([field_of(mean) for mean in centred]),
        whole=np.einsum("ahw,bhw->ab", centred, centred),
        scatter=np.array([scatter_of(frames) for frames in groups]),
        power=power,
        fourth=fourth,
        residuals=histograms,
        places=np.array([np.quantile(on_grid(smooth_of(m)), PLACES) for m in centred]),
        low=np.array(clipped)[:, 0],
        high=np.array(clipped)[:, 1],
        noise=noise,
        codes=np.array(codes),
        masked=mask,
        outliers=np.array([outliers_of(frames, mask) for frames in raw]),
        outlier_noise=np.array(outlier_noise),
    ), residuals


def differences(frames):
    """Return (pairs, h, w) (a - b) / sqrt(2) of disjoint pairs."""
    pairs = zip(frames[::2], frames[1::2], strict=False)
    return [(a - b) / np.sqrt(2) for a, b in pairs]


def outliers_of(frames, mask):
    """Return (masked,) what the mean image has there beyond those around, without what
    one frame has alone."""
    mean = frames.mean(axis=0)
    if len(frames) > 1:
        rest = frames - mean
        rest -= np.array([one[~mask].mean() for one in rest])[:, None, None]
        alone = np.take_along_axis(rest, np.abs(rest).argmax(axis=0)[None], 0)[0]
        mean = mean - are_far(alone) * alone / (len(frames) - 1)
    return (mean - filled(mean, mask))[mask]


def on_grid(image):
    """Return every n-th line, so that there are at most MOST_LINES along a side."""
    h, w = image.shape
    return image[:: -(-h // MOST_LINES), :: -(-w // MOST_LINES)]


def blocks_of(image):
    """Return (BLOCKS^2,) sums of BLOCKS x BLOCKS blocks, row by row."""
    found = np.zeros((BLOCKS, BLOCKS))
    if np.ndim(image) == 0:  # of no pairs
        return found.ravel()
    y, x = ((np.arange(n) * BLOCKS + BLOCKS - 1) // n for n in image.shape)
    np.add.at(found, (y[:, None], x[None]), image)
    return found.ravel()


def freedoms(h, w):
    """Return (8,) how many coefficients each part of a plane has."""
    down, across = len(polynomials(h)) - 1, len(polynomials(w)) - 1
    low = [min(down, SMOOTH), min(across, SMOOTH)]
    low += [down - low[0], across - low[1], h - 1 - down, w - 1 - across]
    low.append(min(down, FIELD) * min(across, FIELD))
    return np.array([*low, h * w - 1 - sum(low)], float)


def field_of(image):
    """Return (FIELD, FIELD) coefficients; 0 of degrees that a short side lacks."""
    down, across = (polynomials(n)[1 : FIELD + 1] for n in image.shape)
    found = np.zeros((FIELD, FIELD))
    found[: len(down), : len(across)] = down @ image @ across.T
    return found


def smooth_of(image):
    """Return what all parts but pixel say of an image, with its level."""
    down, across = (polynomials(n)[1 : FIELD + 1] for n in image.shape)
    lines = image.mean(axis=1, keepdims=True) + image.mean(axis=0) - image.mean()
    return lines + down.T @ (down @ image @ across.T) @ across


def scatter_of(frames):
    """Return (8,) sums of squares of the frames' coefficients about their mean's."""
    n, h, w = frames.shape
    rest = frames - frames.mean(axis=0)
    rest -= rest.mean(axis=(1, 2), keepdims=True)
    rows, columns = rest.mean(axis=2) * np.sqrt(w), rest.mean(axis=1) * np.sqrt(h)
    lines = zip(
        of_profiles(rows, polynomials(h)[1:]),
        of_profiles(columns, polynomials(w)[1:]),
        strict=True,
    )
    low = [np.trace(one) for both in lines for one in both]
    low.append(sum((field_of(one) ** 2).sum() for one in rest))
    return np.array([*low, (rest**2).sum() - sum(low)])


def correlation(image, down, across):
    """Return the mean product of samples of unit variance and their neighbours'."""
    h, w = image.shape
    products = image[down:, across:] * image[: h - down, : w - across]
    known = np.isfinite(products)
    return products[known].mean() if known.any() else 0.0


def outliers(groups, excluded):
    """Return (h, w) bool: samples that no group's statistics shall have."""
    mask = excluded.copy()
    for frames in groups:
        mean = frames.mean(axis=0)
        points = excluded
        for _ in range(2):
            points = excluded | are_far(mean - smooth_of(filled(mean, points)))
        mask |= points
        for axis in (0, 1):
            found = lost_lines(filled(mean, points).mean(axis=1 - axis), mean.shape)
            mask |= np.expand_dims(found, 1 - axis)
        for frame in frames if len(frames) > 1 else ():
            rest = frame - mean
            mask |= are_far(rest - rest[~points].mean() if not points.all() else rest)
    rows, columns = mask.mean(axis=1) > LOST, mask.mean(axis=0) > LOST
    return mask | rows[:, None] | columns


def are_far(rest):
    return np.abs(rest) > POINT * max(spread(rest), LEAST_SIGMA)


def lost_lines(profile, shape):
    """Return (N,) bool: lines that stand off those around, once polynomials are taken
    off, which a running median shows without them. profile : (N,) their means."""
    low = polynomials(len(profile))
    rest = profile - low.T @ (low @ median_filter(profile, WINDOW, mode="mirror"))
    jump = rest - median_filter(rest, WINDOW, mode="mirror")
    of_each = shape[0] * shape[1] // len(profile)
    steps = np.abs(np.diff(profile))
    steps = np.append(steps, steps[-1:] if len(steps) else 0.0)
    to_end = np.minimum(np.arange(len(profile)), np.arange(len(profile))[::-1])
    slack = median_filter(steps, WINDOW, mode="mirror")
    slack = slack * np.maximum(WINDOW // 2 - to_end, 0)
    most = LINE * max(spread(jump), LEAST_SIGMA / np.sqrt(of_each))
    return np.abs(jump) > most + slack


def spread(values):
    """Return the sd of what is within 5 of it about the mean."""
    kept = values.ravel()
    for _ in range(5):
        kept = kept[np.abs(kept - kept.mean()) <= 5 * kept.std()]
    return kept.std()


def filled(image, mask):
    """Return the image with masked samples as those around say: what all parts but
    pixel say, in rounds, of lost lines what they say of the nearest good line."""
    rows, columns = mask.mean(axis=1) > LOST, mask.mean(axis=0) > LOST
    points = mask & ~rows[:, None] & ~columns
    good = np.where(mask, 0.0, image).sum(axis=1) / np.maximum((~mask).sum(axis=1), 1)
    found = with_lines(np.where(points, good[:, None], image), rows, columns)
    masked = points | rows[:, None] | columns
    for _ in range(FILLS if masked.any() else 0):
        said = with_lines(smooth_of(found), rows, columns)
        found = np.where(masked, said, found)
    return found


def with_lines(image, rows, columns):
    return image[nearest(rows)][:, nearest(columns)]


def nearest(lost):
    """Return (N,) the nearest line that is not lost, of two the first; itself, where
    all are."""
    kept, all_lines = np.flatnonzero(~lost), np.arange(len(lost))
    if not len(kept):
        return all_lines
    return kept[np.abs(kept - all_lines[:, None]).argmin(axis=1)]


def without(frames, mask):
    """Return frames whose masked samples are the filled mean, as much above it as the
    frame's rows and columns are."""
    mean = filled(frames.mean(axis=0), mask)
    return np.array(
        [
            np.where(mask, mean + shifts_of(frame - mean, mask), frame)
            for frame in frames
        ]
    )


def shifts_of(rest, mask):
    """Return (h, w), what rows and columns have of what is not masked."""
    good = ~mask
    kept = np.where(mask, 0.0, rest)
    whole = kept.sum() / max(good.sum(), 1)
    in_rows, in_columns = good.sum(axis=1), good.sum(axis=0)
    rows = np.where(in_rows, kept.sum(axis=1) / np.maximum(in_rows, 1), whole)[:, None]
    columns = (kept - rows * good).sum(axis=0) / np.maximum(in_columns, 1)
    return rows + columns
