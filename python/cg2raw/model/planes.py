# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The scatter of a plane's frames: linear in variances, but for rounding.

Within a group it is T times chi-square, T = read noise + gain * signal + TEMPORAL, as
it is recorded. Weights (freedoms) come from the data alone: those that moved with
a parameter would make a likelihood that rises by their moves."""

from collections.abc import Sequence

import numpy as np

from cg2raw.model.components import (
    COLUMNS,
    EVEN_ACROSS,
    EVEN_DOWN,
    FIXED,
    ROWS,
    TEMPORAL,
    Component,
)
from cg2raw.model.evaluation import Evaluation, Parameters
from cg2raw.model.recorded import (
    LEAST_OFFSET,
    Offsets,
    Profiles,
    Recorder,
    Recording,
    Records,
    fine_records,
    recorder_of,
    shrunk,
)
from cg2raw.statistics.constant import (
    FIELD,
    LAGS,
    PARTS,
    PIXEL,
    Array,
    ConstantStatistics,
    PlaneStatistics,
)

FAST_LINES = (PARTS.index("fast_rows"), PARTS.index("fast_columns"))
LOW_ROWS = (PARTS.index("smooth_rows"), PARTS.index("slow_rows"))
# Of what is fixed, the share that is charge, and has shot noise; of a covariance half.
SHARES = {"constant": 0.0, "constant and time": 0.5, "time": 1.0, "light": 1.0}
CHARGE = np.array([SHARES[component.signature] for component in FIXED])


class PlaneLikelihood:
    """The scatter of one plane, and how its codes are recorded."""

    def __init__(
        self,
        statistics: ConstantStatistics,
        site: int,
        parameters: Parameters,
        theta: Array | None,
        earlier: Sequence[Recorder],
    ) -> None:
        plane = statistics.planes[site]
        self.plane, self.site, self.parameters = plane, site, parameters
        self.frames = statistics.frames
        self.is_flat = statistics.is_flat
        self.time = np.array([g.charge_time for g in statistics.groups])
        self.repeats = self.frames > 1
        # Groups whose noise is measured: without repeats, by what images do not share.
        alone = ~self.repeats & (self.is_flat | ~self.repeats[~self.is_flat].any())
        self.measured = self.repeats | (alone & (alone.sum() > 1))
        self.side = statistics.side
        again = np.maximum(self.frames - 1, 1)[:, None]
        # Means of lines are of the samples that are left, and freedom is less by those.
        left = np.array(
            [
                plane.left_in(n) if ROWS[n] or COLUMNS[n] else 1.0
                for n in range(len(PARTS))
            ]
        )
        self.scatter = plane.scatter / np.maximum(plane.freedom, 1) / again * left**2
        self.products = plane.products / np.maximum(plane.freedom, 1)[:, None, None]
        single = self.measured & ~self.repeats
        if single.any():
            self.scatter[single] = unshared(self.products[PIXEL])[single, None]
            for n in FAST_LINES:
                self.scatter[single, n] = unshared(self.products[n])[single]
        # A lamp's shape changes slowly: frames next to each other have it in common.
        self.paired = self.is_flat & (statistics.pairs > 0) & (plane.freedom[PIXEL] > 0)
        self.scatter[self.paired, PIXEL] = plane.power[self.paired]
        self.correlation = correlation_of(statistics)
        self.freedom = freedom_of(plane, statistics, self.scatter)
        pairs = statistics.pairs / np.maximum(self.frames - 1, 1)
        self.freedom[self.paired, PIXEL] *= pairs[self.paired]
        self.light = self._light(theta)
        vectors = [self.vectors(c) for c in (*TEMPORAL, *FIXED)]
        sizes = [len(v) * np.prod(v, axis=0) * v[-1] ** (2 - len(v)) for v in vectors]
        # (K, G, 8), of one unit of a component in a coefficient of a frame.
        each = np.array([c.multiplicity(*plane.shape) for c in (*TEMPORAL, *FIXED)])
        each = np.array(sizes)[:, :, None] * each[:, None]
        self.sizes = each[: len(TEMPORAL)] * left
        self.fixed_sizes = each[len(TEMPORAL) :]
        self.fixed_sizes[:, :, PIXEL] = 0.0
        # (2, G, K), of one unit in the places of samples: lines', and pixels'.
        lines = [bool(c.parts[list(FAST_LINES)].any()) for c in TEMPORAL]
        pixels = [bool(c.parts[PIXEL]) for c in FIXED]
        these = [lines + len(pixels) * [False], len(lines) * [False] + pixels]
        self.in_places = np.array(these)[:, None] * np.array(sizes).T
        self.recorders = self._recorders(statistics.white, theta, earlier)
        self.levels = np.array([each.mean() for each in plane.levels])
        self.coarse = [g for g, one in enumerate(self.recorders) if one.table]
        # The same lines put all their pixels elsewhere within a code.
        by_lines = np.array([one.by_lines for one in self.recorders])
        chance = by_lines / (min(plane.shape) * again[:, 0])
        known = self.freedom[:, PIXEL] > 0
        own = 2 / self.freedom[known, PIXEL]
        own += chance[known] / self.scatter[known, PIXEL] ** 2
        # What a reading leaves open of a temperature, shot noise has.
        if theta is not None:
            of = [parameters.of("gain", site), parameters.of("dark_current")]
            error = np.array([g.warmth_error for g in statistics.groups])
            error[self.is_flat] = 0.0  # its charge is that of its level
            charge = np.prod(theta[of]) * self.time * error / np.sqrt(self.frames)
            own += (charge[known] / self.scatter[known, PIXEL]) ** 2
        self.freedom[known, PIXEL] = 2 / own

    def _recorders(
        self, white: int, theta: Array | None, earlier: Sequence[Recorder]
    ) -> list[Recorder]:
        """Return that of each group. earlier : of the same groups at other offsets; one
        that holds at these stays."""
        if theta is None:
            about = self._recorded_offsets()
        else:
            about = np.vstack([self.offsets(theta)[0], self._charged(theta)])
            about[1:] = np.maximum(about[1:], 0.0)
        usual = self.scatter[self.measured, PIXEL].min(initial=np.inf)
        noise = np.where(self.measured, self.scatter[:, PIXEL], usual)
        found = []
        for g in range(len(self.frames)):
            if earlier and earlier[g].holds_at(Offsets(*about[:, g])):
                found.append(earlier[g])
                continue
            levels, level = self.plane.levels[g], self.plane.level[g]
            # Places have the chance of lines, and are known from 0 and white as far.
            h, w = self.plane.shape
            chance = noise[g] / self.frames[g] * (1 / h + 1 / w)
            places = self.plane.places[g] * shrunk(self.plane.places[g], chance)
            room = min(np.sqrt(chance), white / 2)  # of unknown noise all of it
            places = np.clip(level + places, room, white - room)
            places -= level
            offsets = Offsets(*about[:, g])
            cut = self.plane.low[g] + self.plane.high[g] > 0
            profiles = Profiles(self.plane.rows[g], self.plane.columns[g])
            one = recorder_of(
                levels, places, profiles, offsets, float(noise[g]), white, cut
            )
            found.append(one)
        return found

    def _charged(self, theta: Array) -> Array:
        """Return (G,) DN, by how much the noise of pixels grows with their offsets."""
        first = self.parameters.of(FIXED[0].name)
        of_pixels = self.in_places[1][:, len(TEMPORAL) :] * theta[first:]
        fixed = np.maximum(of_pixels.sum(axis=1), LEAST_OFFSET)
        charge = np.maximum(of_pixels @ CHARGE, 0.0)
        gain = max(float(theta[self.parameters.of("gain", self.site)]), 0.0)
        return np.asarray(gain * charge / fixed)

    def _recorded_offsets(self) -> Array:
        """Return (3, G) Offsets as they were recorded, without a fit."""
        noise = self.scatter[:, PIXEL]
        h, w = self.plane.shape
        lines = self.scatter[:, list(FAST_LINES)] - noise[:, None]
        lines = np.maximum(lines / np.array([w, h]), 0).sum(axis=1)
        fixed = np.diagonal(self.products[PIXEL]) - noise / self.frames
        return np.array([noise, lines, np.maximum(fixed, 0)])

    def offsets(self, theta: Array) -> tuple[Array, Array]:
        """Return (3, G) Offsets before they were recorded and (3, G, n) their slopes.
        Those of fixed lines are among the places."""
        place = self.parameters.of
        read, gain = place("read_noise", self.site), place("gain", self.site)
        by = np.zeros((3, len(self.time), len(theta)))
        signal = self.signal(theta)
        by[0, :, read], by[0, :, gain] = 1.0, signal
        by[0, self.is_flat, place("black_level", self.site)] = -theta[gain]
        charge = theta[gain] * self.time[~self.is_flat]
        by[0, ~self.is_flat, place("dark_current")] = charge
        by[1:, :, place(TEMPORAL[0].name) :] = self.in_places
        found = np.array([self.noise(theta), *(by[1:] @ theta)])
        return found, by

    def _light(self, theta: Array | None) -> Array:
        """Return (G,) DN, what light adds to a level, by a fit before; else it is what
        is above the shortest dark."""
        if theta is not None:
            charge = theta[self.parameters.of("dark_current")] * self.time
            found = self.signal(theta) - charge
        elif self.is_flat.all():
            found = self.plane.level
        else:
            shortest = np.argmin(np.where(self.is_flat, np.inf, self.time))
            found = self.plane.level - self.plane.level[shortest]
        return np.where(self.is_flat, np.maximum(found, 0.0), 0.0)

    def signal(self, theta: Array) -> Array:
        """Return (G,) DN above black: a flat's by its level, a dark's by its time."""
        black = theta[self.parameters.of("black_level", self.site)]
        charge = theta[self.parameters.of("dark_current")] * self.time
        found: Array = np.where(self.is_flat, self.plane.level - black, charge)
        return found

    def noise(self, theta: Array) -> Array:
        """Return (G,) DN^2, the variance of a pixel's noise before it is recorded."""
        place = self.parameters.of
        read, gain = place("read_noise", self.site), place("gain", self.site)
        found: Array = theta[read] + theta[gain] * self.signal(theta)
        return found

    def unrounded(self) -> Array:
        """Return (G,) DN^2, the noise of pixels before it is recorded, by its codes."""
        both = zip(self.recorders, self.scatter[:, PIXEL], strict=True)
        return np.array([recorder.unrounded(variance) for recorder, variance in both])

    def places(self, noise: float) -> Array:
        """Return (G,) DN, where signals lie whose pixels have a noise, DN^2."""
        found = self.levels.copy()
        for g in self.coarse:
            one = self.recorders[g]
            found[g] = one(one.about._replace(noise=noise))[0][0]
        return found

    def records(self, theta: Array) -> Records:
        """Return what is recorded, (G,) each, and its slopes by parameters, (G, n)."""
        offsets, by = self.offsets(theta)
        found = fine_records(self.levels, offsets[0], by[0])
        for g in self.coarse:
            known, slopes = self.recorders[g](Offsets(*offsets[:, g]))
            moved = slopes @ by[:, g]
            for values, by_each, value, slope in zip(*found, known, moved, strict=True):
                values[g], by_each[g] = value, slope
        return found

    def temporal(
        self, theta: Array, known: Recording[Array], moving: Recording[Array]
    ) -> tuple[Array, Array]:
        """Return (G, 8) variances of a frame's coefficients and (G, 8, n) slopes.
        known, moving : Records at theta."""
        share = 1 + self.correlation
        rows = ROWS.astype(int)  # other parts have nothing of lines
        response = np.array([known.columns, known.rows])[rows].T
        by_lines = np.array([moving.columns, moving.rows])[rows].swapaxes(0, 1)
        expected = known.variance[:, None] * share
        by = share[:, :, None] * moving.variance[:, None]
        first = self.parameters.of(TEMPORAL[0].name)
        own = slice(first, first + len(TEMPORAL))
        more = (theta[own] @ self.sizes.reshape(len(TEMPORAL), -1)).reshape(share.shape)
        expected = expected + more * response**2
        by[:, :, own] += self.sizes.transpose(1, 2, 0) * response[:, :, None] ** 2
        by += (2 * more * response)[:, :, None] * by_lines
        # Patterns that are recorded otherwise in each frame, but for pixels' own.
        if (fading := known.fading).any():
            first += len(TEMPORAL)
            pattern = np.tensordot(theta[first:], self.fixed_sizes, 1)
            expected = expected + pattern * fading[:, None]
            by += pattern[:, :, None] * moving.fading[:, None]
            by[:, :, first:] += (
                self.fixed_sizes.transpose(1, 2, 0) * fading[:, None, None]
            )
        return expected, by

    def vectors(self, component: Component) -> list[Array]:
        """Return one (G,), what a component is proportional to, or two, of a covariance
        of what is proportional to each."""
        known = {
            "constant": np.ones(len(self.time)),
            "time": self.time,
            "light": self.light,
        }
        return [known[name] for name in component.signature.split(" and ")]

    def add_to(
        self,
        found: Evaluation,
        theta: Array,
        known: Recording[Array],
        moving: Recording[Array],
    ) -> None:
        """Add the scatter. known, moving : Records at theta. The value is -inf
        where a variance is not above 0."""
        expected, by = self.temporal(theta, known, moving)
        if (expected <= 0).any():
            found.value = -np.inf
            return
        used = self.freedom > 0
        found.add_chi_square(
            self.scatter[used], expected[used], by[used], self.freedom[used]
        )

    def usual_scatter(self, theta: Array | None) -> Array:
        """Return (G, 8) DN^2, the scatter; of groups without repeats that of the darks
        that have them, or of all. theta : of a fit, by whose gain their shot noise is
        another."""
        found: Array = self.scatter.copy()
        usual = self.measured & ~self.is_flat
        usual = usual if usual.any() else self.measured
        if usual.any() and (alone := ~self.measured).any():
            found[alone] = found[usual].mean(axis=0)
            if theta is not None:
                noise = self.noise(theta)
                found[alone] += (noise[alone] - noise[usual].mean())[:, None]
        return found

    def level_noise(self, theta: Array | None = None) -> tuple[Array, Array]:
        """Return (G,) DN^2 each, the variances of a frame's level by the noise of its
        pixels and of its lines, as of usual_scatter."""
        scatter = self.usual_scatter(theta)
        pixel = scatter[:, PIXEL]
        lines = scatter[:, list(FAST_LINES)].sum(axis=1) - 2 * pixel
        low = self.correlation[:, PARTS.index("field")]
        found = np.array([pixel * (1 + low), np.maximum(lines, 0)])
        found *= self.plane.copies.level / (self.plane.left * self.plane.masked.size)
        return found[0], found[1]


def unshared(products: Array) -> Array:
    """Return (G,) DN^2, what is in each of some images and in no sum of the others.

    products : (G, G) of their pixel parts, mean over freedom."""
    found: Array = 1 / np.diagonal(np.linalg.pinv(products, hermitian=True))
    return found


def neighbours(statistics: ConstantStatistics, down: int, across: int) -> Array | None:
    """Return (G,) correlations with the sample @down rows and @across columns away; 0
    of groups without pairs. None if it was not measured.

    Residuals have lost the means of their lines and the field: white noise has -1 / n
    along a line of n, and correlation itself loses twice that, and 1 / n' of lines of
    n' that run the other way. Lines of two planes lose only half of it."""
    if (down, across) not in LAGS:
        return None
    h, w = statistics.planes[0].shape
    along, other = (w, h) if across else (h, w)
    within = down % statistics.side == 0 and across % statistics.side == 0
    measured = statistics.lags[:, LAGS.index((down, across))]
    if min(along, other) < 4:
        return 0 * measured
    if down and across:
        lost = within * (FIELD**2 - 1) / (h * w)
        return np.where(statistics.pairs > 0, measured + lost, 0.0)
    lost = 1 / along + FIELD**2 / (h * w)
    found: Array = (measured + within * lost) / (1 - (1 + within) * lost - 1 / other)
    found[statistics.pairs == 0] = 0.0
    return found


def correlation_of(statistics: ConstantStatistics) -> Array:
    """Return (G, 8) by how much the correlation of next neighbours raises the variance
    of a part, as measured; groups without pairs have it of the darks, or of all."""
    found, side = np.zeros((len(statistics.groups), len(PARTS))), statistics.side
    for down, across, parts in ((0, side, EVEN_ACROSS), (side, 0, EVEN_DOWN)):
        if (measured := neighbours(statistics, down, across)) is not None:
            found += 2 * measured[:, None] * parts
    known = statistics.pairs > 0
    darks = known & ~statistics.is_flat
    usual = darks if darks.any() else known
    if usual.any():
        found[~known] = found[usual].mean(axis=0)
    return found


def freedom_of(
    plane: PlaneStatistics, statistics: ConstantStatistics, scatter: Array
) -> Array:
    """Return (G, 8) degrees of freedom of the scatter: fewer where noise has tails, is
    correlated, or is of lines that planes share."""
    again, side = statistics.frames - 1, statistics.side
    found: Array = plane.freedom * again[:, None]
    tails = np.nan_to_num(plane.fourth - 3) * again / statistics.frames
    within = [lag for lag in LAGS if not (lag[0] % side or lag[1] % side)]
    places = [LAGS.index(lag) for lag in within]
    of_lags = 2 * (statistics.lags[:, places] ** 2).sum(axis=1)
    found[:, PIXEL] /= np.maximum(1 + tails + of_lags, 0.2)
    for part in range(PIXEL):
        planes = side if part in FAST_LINES else side**2
        for g in np.flatnonzero(again):
            alike = planes * waves(plane, part, bool(statistics.is_flat[g]))
            found[g, part] *= less_of(scatter[g, part], scatter[g, PIXEL], alike)
    return found


def waves(plane: PlaneStatistics, part: int, is_flat: bool) -> float:
    """Return how many coefficients of a part there are for each number of what moves
    them: those of rows that a wave of light runs down are by its amplitude and phase.
    """
    if not is_flat or part not in LOW_ROWS:
        return 1.0
    return max(float(plane.freedom[part]) / 2, 1.0)


def less_of(size: float, pixel: float, alike: float) -> float:
    """Return by how much the freedom of a part is less where so many coefficients are
    alike: by what is above the pixels' variance. Lines run through as many planes as
    the repeat has sites along them; what is smooth is in all."""
    if size <= pixel:
        return 1.0
    return 1 / (1 + (alike - 1) * (1 - pixel / size) ** 2)
