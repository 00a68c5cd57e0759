# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Charts of what darks and flats name: measured in test frames, and predicted with and
without one effect, all others as they were found."""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cg2raw.calibration.sites import sites_of
from cg2raw.diagnose.captures.splits import GROUPS
from cg2raw.diagnose.darks_and_flats import TEST, DarksAndFlats
from cg2raw.diagnose.diagnosis import Chart, Finding, Series
from cg2raw.diagnose.verdict.unexplained import PLACES, described
from cg2raw.model.amplifier_mismatch import NAME as MISMATCH
from cg2raw.model.amplifier_mismatch import unit_step
from cg2raw.model.components import FIXED
from cg2raw.model.dark_law import fitted
from cg2raw.model.fit import Fit
from cg2raw.model.flat_levels import CHANGES
from cg2raw.model.lags import NAMES as SHARED
from cg2raw.model.lags import lags_of
from cg2raw.model.profile_values import profile_lags
from cg2raw.model.selection import NAMES
from cg2raw.model.shapes.base import Shown
from cg2raw.model.shapes.heavy_tailed_noise import EDGES, tails_of
from cg2raw.normal import CI95
from cg2raw.statistics.constant import (
    LAGS,
    PARTS,
    PIXEL,
    RATE_EDGES,
    Array,
    polynomials,
    smooth_images,
)

RINGS = 12  # of a frame, from its middle to its corners
LEAST_CHANGE, TOO_HIGH = 0.1, 2.0  # of groups that are shown beside the others
BLOCKS = 24  # of the lines on both sides of a step
MOST_SIDE = 128  # samples along a side, of which rings are means
# Times its noise, from which a rate is drawn; bins of fewer samples than one are left.
FIRST_RATE = 2.0
WAYS = {(0, 1): "right", (1, 0): "down", (1, 1): "diagonal"}


class Part(NamedTuple):
    """Mean squares of a part of frames, (G,) DN^2 each, and their freedom."""

    measured: Array
    expected: Array
    freedom: Array


def charts_of(
    found: DarksAndFlats, model: Fit, test: Fit, findings: Sequence[Finding]
) -> Iterator[Chart]:
    """Yield a chart of each effect that has one, and the photon transfer of all.

    model : what training and validation frames fitted. test : the likelihood of test
    frames at its parameters."""
    chosen = {one.name: one for one in findings}
    makers = {
        "black_level": lambda n: _levels(n, found, test),
        "dark_current": lambda n: _levels(n, found, test),
        "black_level_drift": lambda n: _drift(chosen[n], found, (model, test)),
        "hot_pixels": lambda n: _rates(n, found, model),
        "heavy_tailed_noise": lambda n: _tails(n, found, chosen[n]),
        "lens_shading": lambda n: _rings(n, test, chosen[n]),
        MISMATCH: lambda n: _step(n, found),
        **dict.fromkeys(SHARED, lambda n: _lags(n, found, model, test, chosen)),
        **dict.fromkeys(CHANGES, lambda n: _flats(n, found, model, test, chosen)),
    }
    for name in chosen:
        make = makers.get(name)
        one = make(name) if make and chosen[name].parameters else None
        one = one or (_parts(name, found, test) if name in NAMES else None)
        if one is not None:
            yield one
    yield from _transfer(found, test)


def _without(name: str, found: DarksAndFlats, fit: Fit) -> Array:
    """Return the parameters with those of an effect as the profile has them."""
    own = fit.parameters.are(NAMES[name])
    theta: Array = np.where(own, found.profile, fit.theta)
    return theta


def parts_of(fit: Fit, theta: Array) -> dict[tuple[str, str], Part]:
    """Return noise, from frame to frame, and pattern, of mean frames, of each of PARTS:
    mean squares over the frame, so that their roots are rms."""
    planes = fit.likelihood.planes
    h, w = planes[0].plane.shape
    share = np.mean([plane.plane.freedom for plane in planes], axis=0) / (h * w)
    recorded = [plane.records(theta) for plane in planes]
    expected = np.mean(
        [p.temporal(theta, *r)[0] for p, r in zip(planes, recorded, strict=True)], 0
    )
    scatter = np.mean([plane.scatter for plane in planes], axis=0)
    freedom = np.sum([plane.freedom for plane in planes], axis=0)
    found = {
        ("noise", part): Part(
            share[n] * scatter[:, n], share[n] * expected[:, n], freedom[:, n]
        )
        for n, part in enumerate(PARTS)
    }
    blocks: dict[str, list[Part]] = {}
    for block, covariance in fit.likelihood.means.covariances(theta, recorded):
        each = [
            share[block.part] * np.diagonal(one).reshape(len(block.planes), -1).mean(0)
            for one in (block.products, covariance)
        ]
        many = np.full(len(each[0]), block.freedom * len(block.planes))
        blocks.setdefault(PARTS[block.part], []).append(Part(each[0], each[1], many))
    for part, some in blocks.items():
        means = np.mean([one[:2] for one in some], axis=0)
        many = np.sum([one.freedom for one in some], axis=0)
        found["pattern", part] = Part(means[0], means[1], many)
    return found


def _parts(name: str, found: DarksAndFlats, test: Fit) -> Chart | None:
    """Return the part of darks or of flats that an effect changes by most."""
    after = parts_of(test, test.theta)
    before = parts_of(test, _without(name, found, test))
    of_patterns = {one.name for one in FIXED}
    fixed = np.isin(test.parameters.names, list(of_patterns))
    beginnings = {one.partition(",")[0] for one in of_patterns}
    is_fixed = bool(set(NAMES[name]) & beginnings)
    # Without repeats, noise is in mean frames alone.
    is_alone = all(after["noise", part].freedom.sum() <= 0 for part in PARTS)
    what = "pattern" if is_fixed or is_alone else "noise"
    floor = parts_of(test, np.where(fixed, 0.0, test.theta))
    flat = test.likelihood.planes[0].is_flat
    change = {key: _change(before[key], after[key]) for key in after if key[0] == what}
    key, is_flat = max(
        ((key, is_flat) for key in change for is_flat in (False, True)),
        key=lambda one: float(change[one[0]][flat == one[1]].sum()),
    )
    each = [after[key].measured, before[key].expected, after[key].expected]
    if is_fixed:
        each = [one - floor[key].expected for one in each]
    rms = [np.sqrt(np.maximum(one, 0.0)) for one in each]
    # What it hardly changes, and is far above the rest, would set the scale.
    moved = np.abs(rms[2] - rms[1]) / np.maximum(rms[2], 1e-300) * (flat == is_flat)
    is_moved = moved > LEAST_CHANGE * moved.max(initial=0.0)
    top = TOO_HIGH * rms[2][is_moved].max(initial=0.0)
    used = np.flatnonzero(
        (flat == is_flat) & (after[key].freedom > 0) & (is_moved | (rms[2] < top))
    )
    if not len(used):
        return None
    kind, place = "flats" if is_flat else "darks", PLACES[key[1]]
    words = {
        "noise": f"Noise of {place} from frame to frame, {kind}",
        "pattern": f"Mean {kind}: {place}" + ", without noise" * is_fixed,
    }[key[0]]
    return _over_groups(name, words, test, used, [one[used] for one in rms], "rms, DN")


def _change(before: Part, after: Part) -> Array:
    """Return (G,) by how many nats two predictions differ."""
    ratio = np.where(after.freedom > 0, after.expected / before.expected, 1.0)
    found: Array = after.freedom / 2 * (ratio - 1 - np.log(ratio))
    return found


def _over_groups(
    name: str,
    words: str,
    fit: Fit,
    used: NDArray[np.intp],
    each: Sequence[Array],
    unit: str,
) -> Chart:
    """Return measured, before and after of groups: flats by level, darks by time; bars
    where these are not several."""
    plane = fit.likelihood.planes[0]
    signal = np.mean([one.signal(fit.theta) for one in fit.likelihood.planes], axis=0)
    is_flat = bool(plane.is_flat[used[0]])
    x = (signal if is_flat else plane.time)[used]
    label = "signal, DN" if is_flat else "exposure time, s"
    order = np.argsort(x, kind="stable")
    series = Series("", x[order], *(one[order] for one in each))
    if len(np.unique(x)) > 1:
        return Chart(name, words, label, unit, (series,))
    groups = fit.likelihood.means.statistics.groups
    names = tuple(described(groups[used[n]]) for n in order)
    return Chart(name, words, "", unit, (series,), "bars", names)


def _levels(name: str, found: DarksAndFlats, test: Fit) -> Chart | None:
    """Return levels of darks above the black level of the profile."""
    planes, own = test.likelihood.planes, test.parameters.each("black_level")
    used = np.flatnonzero(~planes[0].is_flat)
    if not len(used):
        return None
    black = found.profile[own].mean()
    level = np.mean([one.plane.level for one in planes], axis=0) - black
    rate = test.parameters.of("dark_current")
    before, after = (
        theta[own].mean() - black + theta[rate] * planes[0].time
        for theta in (_without(name, found, test), test.theta)
    )
    each = [one[used] for one in (level, before, after)]
    return _over_groups(
        name, "Level of darks", test, used, each, "DN above the profile's black"
    )


def _drift(finding: Finding, found: DarksAndFlats, fits: Sequence[Fit]) -> Chart | None:
    """Return the levels of the shortest darks, frame by frame, and 95 % bands."""
    order = {one.name: n for n, one in enumerate(found.captures.captures)}
    white, rows = found.captures.sensor.signal_range, []
    variance = (finding.parameters["sigma"].value * white) ** 2
    for fit in fits:
        statistics, planes = fit.likelihood.means.statistics, fit.likelihood.planes
        noise = fit.likelihood.levels.noise[0]
        for g in statistics.shortest_darks():
            levels = np.mean([one.plane.levels[g] for one in planes], axis=0)
            ends = (CI95 * np.sqrt(v) for v in (noise[g], noise[g] + variance))
            bands = tuple(ends)
            for frame, away in zip(
                statistics.groups[g].frames, levels - levels.mean(), strict=True
            ):
                rows.append((order.get(frame, len(order)), away, *bands))
    if not rows:
        return None
    _, *each = np.array(sorted(rows)).T
    series = Series("", np.arange(1.0, len(rows) + 1), *each)
    words = "Level of each of the shortest darks, less the mean of its repeats"
    return Chart(finding.name, words, "dark, in order", "DN", (series,), "bands")


def _rates(name: str, found: DarksAndFlats, model: Fit) -> Chart | None:
    """Return the histogram of the dark rates of pixels."""
    rates = {one.split: one for one in found.statistics.rates}
    if not {GROUPS[0], TEST} <= rates.keys():
        return None
    first, last = rates[GROUPS[0]], rates[TEST]
    gain = float(np.mean(model.theta[model.parameters.each("gain")]))
    shots = [one.shot(max(gain, 0.0)) for one in (first, last)]
    counts = first.counts.astype(float)
    shares = [
        fitted(counts, shots[0], uneven=True, hot=hot)
        .over(last.noise / first.noise, shots[1])
        .shares
        for hot in (False, True)
    ]
    measured = last.counts / last.counts.sum()
    most = np.flatnonzero(last.counts)[-1] + 1
    used = np.flatnonzero(RATE_EDGES[:-1] >= FIRST_RATE)
    used = used[used <= most]
    middles = np.sqrt(RATE_EDGES[used] * RATE_EDGES[used + 1]) * last.noise
    each = [_above(100 * one[used], measured) for one in (measured, *shares)]
    series = Series("", middles, *each)
    words = "Rates of dark current of all pixels"
    labels = ("dark current above the pixels around, DN/s", "% of pixels in a bin")
    return Chart(name, words, *labels, (series,), scale="log log")


def _above(percent: Array, measured: Array) -> Array:
    """Return percentages without those far below the least that is measured."""
    least = 30 * measured[measured > 0].min()
    found: Array = np.where(percent >= least, percent, np.nan)
    return found


def _tails(name: str, found: DarksAndFlats, finding: Finding) -> Chart | None:
    """Return the histogram of differences of two darks."""
    tails = tails_of(Shown(found.statistics, GROUPS[:2], ()), TEST)  # type: ignore[arg-type]
    if tails is None or tails.is_coarse or not tails.counts.sum():
        return None
    share, ratio = (
        finding.parameters[one].value for one in ("fraction", "variance_ratio")
    )
    measured = tails.counts / tails.counts.sum()
    each = [measured, tails.shares(1.0, 0.0, 1.0), tails.shares(1.0, share, ratio)]
    used = measured > 0
    middles = (EDGES + np.append(EDGES[1:], EDGES[-1] + 0.5)) / 2
    each = [_above(100 * one[used], measured) for one in each]
    series = Series("", middles[used], *each)
    words = "Differences of two darks, in which patterns cancel"
    labels = ("size, standard deviations", "% of pixels in a bin")
    return Chart(name, words, *labels, (series,), scale="linear log")


def _lags(
    name: str,
    found: DarksAndFlats,
    model: Fit,
    test: Fit,
    chosen: Mapping[str, Finding],
) -> Chart | None:
    """Return correlations of noise with that of neighbours."""
    both = found.statistics.of_splits(GROUPS[:2])
    null = profile_lags(found.captures.sensor)
    trained = lags_of(both, model, found.profile, null=null)
    lags = lags_of(found.statistics.of_splits([TEST]), test, found.profile, null=null)
    if trained is None or lags is None:
        return None
    values, _ = trained.fitted_of(chosen)
    without = values.copy()
    without[SHARED[name]] = null[SHARED[name]]
    weights = lags.samples / lags.samples.sum()
    each = [
        weights @ one
        for one in (lags.measured, lags.expected(without), lags.expected(values))
    ]
    names = tuple(
        f"{max(lag)} px {WAYS[min(lag[0], 1), min(lag[1], 1)]}" for lag in LAGS
    )
    series = Series("", np.arange(float(len(names))), *each)
    words = "Correlation of a pixel's noise with that of a neighbour"
    return Chart(name, words, "", "correlation", (series,), "bars", names)


def _flats(
    name: str,
    found: DarksAndFlats,
    model: Fit,
    test: Fit,
    chosen: Mapping[str, Finding],
) -> Chart | None:
    """Return levels of flats over those that the profile predicts, of each site."""
    both, last = (found.statistics.of_splits(s) for s in (GROUPS[:2], [TEST]))
    trained = found.levels_of(both, model, chosen)
    levels = found.levels_of(last, test, chosen)
    if trained is None or levels is None:
        return None
    names = [one for one in CHANGES if one in chosen]
    values = trained.fitted(names)
    places = np.repeat(names, [CHANGES[one][0] for one in names])
    shape = levels.predicted.shape
    each = [
        100 * (one.reshape(shape) - 1)
        for one in (
            levels.ratios,
            levels.expected(names, np.where(places == name, 0.0, values)),
            levels.expected(names, values),
        )
    ]
    sites = sites_of(found.captures.sensor).names
    series = []
    for site, label in enumerate(sites):
        order = np.argsort(levels.predicted[site], kind="stable")
        x = 100 * levels.predicted[site][order]
        series.append(Series(label, x, *(one[site][order] for one in each)))
    words = "Level of flats beyond what the profile predicts"
    labels = ("predicted signal, % of white", "deviation, %")
    return Chart(name, words, *labels, tuple(series))


def _rings(name: str, test: Fit, finding: Finding) -> Chart | None:
    """Return the signal of the brightest flats against the distance from the middle."""
    planes = test.likelihood.planes
    light = np.mean([one.light for one in planes], axis=0)
    if not light.any():
        return None
    g = int(np.argmax(light))
    h, w = planes[0].plane.shape
    y, x = (slice(None, None, max(1, n // MOST_SIDE)) for n in (h, w))
    one = slice(g, g + 1)
    fields = [
        smooth_images(p.rows[one], p.columns[one], p.field[one], y, x)[0]
        for p in (plane.plane for plane in planes)
    ]
    field: Array = 1 + np.mean(fields, axis=0) / light[g]
    down, across = (
        (np.arange(n)[s] + 0.5 - n / 2) / np.hypot(h, w) * 2
        for n, s in ((h, y), (w, x))
    )
    radius = np.hypot(down[:, None], across)
    ring = np.minimum((radius * RINGS).astype(int), RINGS - 1).ravel()
    count = np.bincount(ring, minlength=RINGS)
    used = count > 0
    means = [
        np.bincount(ring, values.ravel(), RINGS)[used] / count[used]
        for values in (radius, field)
    ]
    powers = {"r2": 2, "r4": 4, "r6": 6}
    after = np.ones_like(means[0])
    for parameter, power in powers.items():
        if parameter in finding.parameters:
            after += finding.parameters[parameter].value * means[0] ** power
    measured = means[1] * (after.mean() / means[1].mean())
    each = [100 * one for one in (measured, np.ones_like(after), after)]
    series = Series("", means[0], *each)
    words = "Signal of flats by distance from the middle of the frame"
    labels = ("distance, 1 in the corners", "signal, % of the middle")
    return Chart(name, words, *labels, (series,))


def _step(name: str, found: DarksAndFlats) -> Chart | None:
    """Return the step between halves that test frames show best, by blocks of lines."""
    halves, side = found.amplifiers, found.statistics.side
    tested = {n: step for n, step in halves.tested.items() if n in halves.steps}
    if not tested:
        return None
    parameter, step = max(
        tested.items(), key=lambda one: abs(one[1].value) / one[1].error
    )
    before, after = halves.stated.get(parameter, 0.0), halves.steps[parameter].value
    count = len(step.lines)
    low, along, of_step = polynomials(count), np.arange(count), unit_step(count)
    rest = step.lines - low.T @ (low @ (step.lines - after * of_step))
    block = along * BLOCKS // count
    places, measured, of_step = (
        np.bincount(block, values) / np.bincount(block)
        for values in (side * (along + 0.5), rest, of_step)
    )
    is_dark = parameter.endswith("offset")
    scale = 1.0 if is_dark else 100.0
    each = [scale * one for one in (measured, before * of_step, after * of_step)]
    line = "column" if parameter.startswith("horizontal") else "row"
    kind, unit = ("darks", "DN") if is_dark else ("flats", "% of the light")
    words = f"Means of {line}s of {kind}, without what is smooth"
    return Chart(name, words, line, unit, (Series("", places, *each),))


def _transfer(found: DarksAndFlats, test: Fit) -> Iterator[Chart]:
    """Yield the photon transfer of all groups that repeat: by the profile, and with all
    that was found."""
    pixel = ("noise", PARTS[PIXEL])
    before, after = (parts_of(test, one)[pixel] for one in (found.profile, test.theta))
    signal = np.mean([p.signal(test.theta) for p in test.likelihood.planes], axis=0)
    used = np.flatnonzero((after.freedom > 0) & (signal > 0))
    if len(used) > 1:
        used = used[np.argsort(signal[used], kind="stable")]
        each = (after.measured, before.expected, after.expected)
        series = Series("", signal[used], *(one[used] for one in each))
        words = "Photon transfer"
        labels = ("signal, DN", "variance, DN\N{SUPERSCRIPT TWO}")
        yield Chart("", words, *labels, (series,), scale="log log")
