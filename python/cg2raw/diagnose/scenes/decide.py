# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""What scenes, charts and flats of known light show of a camera.

Each pass linearises the chain where the last one ended, sums every view into normal
equations, and chooses among all effects anew.
"""

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, reduce
from operator import add

import numpy as np
from scipy.stats import ttest_1samp

from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.diagnosis import ResidualTest
from cg2raw.diagnose.effects.base import Effect, Predicted
from cg2raw.diagnose.effects.catalogue import candidates, effect, misfit_sources
from cg2raw.diagnose.effects.registry import listed_values
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.scenes import flicker as waves
from cg2raw.diagnose.scenes.correspondence import check_correspondence
from cg2raw.diagnose.scenes.gram import Array, Gram, Normal, Space
from cg2raw.diagnose.scenes.model import Model, Term
from cg2raw.diagnose.scenes.noise import (
    excess_of,
    freedom_of,
    noise_factors,
    patch_deviation,
    with_noise,
)
from cg2raw.diagnose.scenes.nuisances import Nuisance, known_effects, nuisances_of
from cg2raw.diagnose.scenes.point import Excess, Point, normal_of, point_of
from cg2raw.diagnose.scenes.predict import predict, variance_left
from cg2raw.diagnose.scenes.registration import Placement, first_guess
from cg2raw.diagnose.scenes.residuals import Residuals
from cg2raw.diagnose.scenes.selection import Chosen, Selection, nats_to_be_seen
from cg2raw.diagnose.scenes.shapes import full_well, photons
from cg2raw.diagnose.scenes.view import View, views_of
from cg2raw.diagnose.stated_shapes import SHAPE_ERROR
from cg2raw.diagnose.workers import TimeIsUp, Workers
from cg2raw.interrupts import raised
from cg2raw.model.amplifier_mismatch import NAME as MISMATCH
from cg2raw.model.dark_levels import BLACK, CURRENT, DRIFT
from cg2raw.model.flicker import NAME as FLICKER
from cg2raw.model.lags import FILTER

RAMP, GLOW = "bias_structure", "amplifier_glow"
WELL, PHOTONS, BLUR = "full_well", "poisson_shot_noise", "blur"
FIT, SELECT, REPORT = "fit", "select", "report"
PASSES = 5
# Of the mean square of glow, that of its linear ramp where it is most even: from the
# middle of a long side, over half a diagonal.
EVEN_GLOW = 0.057
SETTLED = 0.1  # standard errors that a pass still moves values
SETTLED_POSE, SETTLED_GAIN = 0.01, 2e-3  # px; relative
SETTLED_NOISE, SETTLED_WELL = 0.02, 1e-3  # of a variance; of white
ALIGNMENTS = 12  # steps of Gauss and Newton
UNCLIPPED = 0.95  # of white
# Relative error of a prediction, step by step, while a render is moved to its place:
# beside it, edges differ by more than noise.
DOUBTS = (0.3, 0.2, 0.1, 0.1, 0.05, 0.05, 0.02)
Say = Callable[[str, float], None]
Sums = dict[str, tuple[Normal, list[Nuisance]]]  # by split and set


@dataclass
class Scenes:
    """What is known of images, more with every pass.

    names : effects that may be named. doubts : effects that there may be besides, and
    that these frames do not show. most : how many names at most. alpha : chance of a
    false first name. fits_noise : no darks and flats tell it.

    effects : those with derivatives. known : standard errors of those that darks and
    flats decided, which images correct. theta : (P,) their values beyond the profile's.
    model : the profile, effects at their values, and calibrated noise. sets, grams :
    normal equations where it was last summed. nats : of
    effects without derivatives, on validation frames; shapes : values and standard
    errors of each. least_flicker : the amplitude that validation frames would show.
    of_noise : (2, 2), the information by which noise was fitted; None where it is not.
    ended : what came in between, Ctrl-C or the time limit."""

    capture_set: CaptureSet
    views: Sequence[View]
    names: frozenset[str]
    doubts: frozenset[str]
    alpha: float
    most: int
    fits_noise: bool
    workers: Workers
    effects: list[Effect] = field(init=False)
    known: dict[str, Array] = field(init=False)
    model: Model = field(init=False)
    theta: Array = field(init=False)
    excess: Excess = field(default_factory=Excess)
    placements: dict[str, Placement] = field(default_factory=dict)
    chosen: Chosen = field(default_factory=lambda: Chosen([], {}, {}))
    sets: Sums = field(default_factory=dict)
    grams: Mapping[str, Gram] = field(default_factory=dict)
    nats: dict[str, float] = field(default_factory=dict)
    shapes: dict[str, tuple[Array, Array]] = field(default_factory=dict)
    least_flicker: float = math.inf
    of_noise: Array | None = None
    ended: type[BaseException] | None = None

    def __post_init__(self) -> None:
        if any(one.frame.capture.exposure_time is None for one in self.views):
            self.names -= {CURRENT}
        self.effects = [
            one
            for one in candidates(self.capture_set.sensor.cfa)
            if one.name in self.names and one.predicted and one.name != WELL
        ]
        errors = known_effects(self.capture_set.sensor)
        self.known = {
            one.name: error
            for one, error in errors.items()
            if one.name not in self.names
        }
        self.effects += [one for one in errors if one.name in self.known]
        self.model = Model(self.capture_set.sensor)
        for one in candidates(self.capture_set.sensor.cfa) if self.fits_noise else []:
            if one.scales:
                self.model = self.model.with_term(Term(one, one.null, calibration=True))
        self.theta = np.zeros(self.space.size)

    @property
    def space(self) -> Space:
        return Space.of({one.name: len(one.used) for one in self.effects})

    @property
    def least(self) -> float:
        """Nats that a name needs on validation frames."""
        return math.log(max(len(self.names), 1) / self.alpha)

    @property
    def _calibrates(self) -> bool:
        """Whether the size of noise, or of a chart's errors, is fitted."""
        return self.fits_noise or any(view.is_chart for view in self.views)

    @property
    def candidates(self) -> list[str]:
        return [one.name for one in self.effects if one.name not in self.known]

    @property
    def fitted(self) -> set[str]:
        """Names of the effects whose values are fitted."""
        return {*self.chosen.names, *self.known}

    @property
    def both(self) -> Gram:
        """That of training and validation together, with what is known."""
        return self.with_known(self.grams[FIT] + self.grams[SELECT])

    def with_known(self, gram: Gram) -> Gram:
        """Return a Gram with what is known of parameters: two deviations are the range
        that the registry simulates. Then what several together do not tell stays 0."""
        ranges = [(one.high - one.low)[one.is_used] / 4 for one in self.effects]
        every = np.concatenate([np.zeros(0), *ranges])
        gram = gram.with_prior(np.arange(self.space.size), every)
        for name, errors in self.known.items():
            gram = gram.with_prior(self.space.index([name]), errors)
        return gram

    # Points and sums.

    def frame(self, view: View) -> Frame:
        placement = self.placements.get(view.frame.capture.set)
        return view.frame if placement is None else placement.placed(view.frame)

    def point(self, view: View, model: Model | None = None) -> Point:
        point = point_of(view, self.frame(view), model or self.model, self.excess)
        alike = [one.is_chart and one.group == view.group for one in self.views]
        point.charts = sum(alike)
        return point

    def points_of(self, group: str, model: Model | None = None) -> list[Point]:
        views = [view for view in self.views if view.group == group]
        return self.workers.map(lambda view: self.point(view, model), views)

    def nuisances(
        self, point: Point, stated: bool = False, doubt: str = ""
    ) -> list[Nuisance]:
        """stated : flicker is that of the profile, not that which was found."""
        blurred = point.model.term(BLUR) is not None
        found = self.shapes.get(FLICKER)
        flicker = self.stated_flicker if stated or found is None else found[0]
        frame, n = point.frame, point.view.n
        return [*nuisances_of(self.capture_set, frame, n, flicker, blurred, doubt)]

    @property
    def stated_flicker(self) -> Sequence[float] | None:
        """(amplitude, period) of the profile's."""
        return listed_values(self.capture_set.sensor, FLICKER)

    def left(self, point: Point) -> Array:
        """Return residuals (T, h, w) without what nuisances take."""
        left = Residuals().taken(point, self.nuisances(point))
        return np.asarray(left / np.where(point.root > 0, point.root, 1.0))

    def _squares(
        self, *groups: str, weights: Model | None = None, stated: bool = False
    ) -> float:
        """Return the squares that nuisances leave of frames of some groups.

        weights, stated : as of _summed."""
        views = [view for view in self.views if view.group in groups]
        sets = self._summed(views, [], weights, stated).values()
        return sum(float(_without(*one, False).products[-1, -1]) for one in sets)

    def _summed(
        self,
        views: Sequence[View],
        effects: Sequence[Effect],
        weights: Model | None = None,
        stated: bool = False,
        doubt: str = "",
    ) -> Sums:
        """Return the normal equations of each set by some effects, in which views' own
        nuisances are integrated out.

        weights : whose standard deviations count, None for those of the model. stated,
        doubt : as of nuisances."""
        space = Space.of({one.name: len(one.used) for one in effects})
        counted = self._counted() if effects else np.zeros(0)

        def work(view: View) -> tuple[Normal, list[Nuisance]]:
            point = self.point(view)
            if view.group == REPORT:
                point.charts = 1  # that decide nothing together
            if weights is not None:
                point.root = self.point(view, weights).root
            nuisances = self.nuisances(point, stated, doubt)
            normal = normal_of(point, effects, space, counted, nuisances)
            # Their images are large, and what they are called is enough.
            bare = [replace(one, change=np.zeros(0)) for one in nuisances]
            return _without(normal, bare, True), bare

        sets: Sums = {}
        for view, (normal, nuisances) in zip(
            views, self.workers.map(work, views), strict=True
        ):
            key = f"{view.group}/{view.frame.capture.set}"
            known = sets.get(key)
            sets[key] = (normal if known is None else normal + known[0]), nuisances
        return sets

    def _sum(self) -> None:
        """Sum all views where the chain is linearised now."""
        self.sets = self._summed(self.views, self.effects)
        self.grams = self._grams(self.sets)

    def _grams(self, sets: Sums) -> Mapping[str, Gram]:
        """Return the Gram of each group."""
        size = self.space.size
        empty = Gram(0, 0.0, np.zeros(size), np.zeros((size, size)))
        found: dict[str, list[Gram]] = {one: [empty] for one in (FIT, SELECT, REPORT)}
        for key, (normal, nuisances) in sets.items():
            rest = _without(normal, nuisances, False)
            found[key.partition("/")[0]].append(rest.gram(size))
        return {name: reduce(add, every) for name, every in found.items()}

    def _counted(self) -> Array:
        """Return theta without parameters that are the shape of others: nothing is left
        of them where those are 0, so they count from where they are."""
        theta = self.theta.copy()
        for one in self.effects:
            first = self.space.slices[one.name].start
            for k, name in enumerate(one.used):
                if name in one.shapes:
                    theta[first + k] = 0.0
        return theta

    # Steps.

    def run(self, say: Say) -> None:
        """Decide. Ctrl-C and the time limit end it with what was found."""
        try:
            with raised():
                self._decide(say)
        except (KeyboardInterrupt, TimeIsUp) as ended:
            self.ended = type(ended)
        self.workers.deadline = None  # the report is written in any case
        if self.ended is not None or not self.grams:
            self._sum()

    def _decide(self, say: Say) -> None:
        is_free = "registration" in self.capture_set.nuisances
        if self.capture_set.nuisances & {"registration", "exposure", "white_balance"}:
            say("aligning renders with captures", 0.28)
            self._align()
        every = [
            v for v in self.views if v.frame.capture.shows.image and not v.is_table
        ]
        placements = self.placements if is_free else {}
        check_correspondence(map(self.point, every), placements)
        self._fill_well()
        if self._calibrates:
            self._fit_noise()
        self._find_flicker()
        for turn in range(PASSES):
            say("summing scenes and choosing effects", 0.3 + 0.5 * turn / PASSES)
            if not self._pass():
                break
        say("judging shapes", 0.8)
        self._refine()
        self._doubt_offsets()
        self._doubt_well()
        self._doubt_light()
        self._measure_flicker()
        self._count_photons()

    def _pass(self) -> bool:
        """Choose anew; return whether anything moved far."""
        self._sum()
        self.chosen = self._chosen(self._selection(self.grams))
        moved = self._step()
        moved |= self._fill_well()
        doubted = self.capture_set.nuisances & {"registration", "radiance"}
        if self._calibrates or doubted:
            moved |= self._fit_noise()
        return moved

    def _selection(self, grams: Mapping[str, Gram]) -> Selection:
        return Selection(
            self.space,
            self.with_known(grams[FIT]),
            grams[SELECT],
            self.least,
            self.alpha,
            self.known,
        )

    def _chosen(self, select: Selection) -> Chosen:
        """Return the effects chosen of those whose values are possible."""
        asked = set(self.candidates)
        while True:
            chosen = select.run(asked, self.most)
            theta = self._likeliest({*chosen.names, *self.known})
            impossible = {
                one.name
                for one in self.effects
                if one.name in chosen.names
                and not one.is_possible(self._with_profile(one, theta))
            }
            # A filter would take its part of the noise, whatever it stands for.
            if FILTER in chosen.nats and misfit_sources(FILTER, chosen.nats, {}):
                impossible.add(FILTER)
            if not impossible:
                return chosen
            asked -= impossible

    def _with_profile(self, one: Effect, theta: Array) -> Array:
        """Return all values of an effect, on top of the profile's."""
        stated = self.model.profile_parameters.get(one.name)
        listed = one.null if stated is None else np.array([*stated.values()])
        return listed + one.with_used(theta[self.space.slices[one.name]])

    def _likeliest(self, names: Collection[str]) -> Array:
        """Return theta (P,) of most likelihood of some effects, 0 of all others."""
        index = self.space.index(names)
        theta = self.both.fit(index)
        theta[index] += (self.theta - self._counted())[index]
        return theta

    def _step(self) -> bool:
        """Move to the values of the chosen effects; return whether that was far.

        Where the linear model of the move is wrong by more than SHAPE_ERROR of what it
        gains, those that are new and gain less than that wait: they would take up its
        errors, and are chosen anew where the others lead."""
        if self.capture_set.nuisances:
            return self._move()  # they take part of an error themselves
        theta, model, counted = self.theta, self.model, self._counted()
        both = self.grams[FIT] + self.grams[SELECT]
        there = {term.name for term in model.terms}
        chosen, is_cut = self.chosen, False
        while True:
            moved, names = self._move(), self.chosen.names
            new = [name for name in names if name not in there]
            if len(names) < 2 or not new:
                return moved or is_cut
            gain = both.gain(self.theta - theta + counted)
            squares = self._squares(FIT, SELECT, weights=model)
            wrong = abs(squares - both.squares + 2 * gain) / 4
            weakest = min(new, key=lambda name: chosen.nats[name])
            usual = SHAPE_ERROR * (gain - both.gain(counted)) / 2  # of one split
            if wrong <= max(chosen.nats[weakest], usual):
                return moved or is_cut
            self.theta, self.model = theta, model
            nats = {n: chosen.nats[n] for n in names if n != weakest}
            self.chosen, is_cut = replace(chosen, names=[*nats], nats=nats), True

    def _move(self) -> bool:
        """Move to the values of the chosen effects; return whether that was far."""
        both, index = self.both, self.space.index(self.fitted)
        theta = self._likeliest(self.fitted)
        terms = [one for one in self.model.terms if one.name not in self.space.slices]
        for one in self.effects:
            if one.name in self.fitted:
                part = self.space.slices[one.name]
                values = one.clipped(one.with_used(theta[part]))
                theta[part] = values[one.is_used]
                terms.append(Term(one, values))
        old, self.theta = self.theta, theta
        self.model = replace(self.model, terms=tuple(terms))
        errors = np.zeros_like(theta)
        errors[index] = np.sqrt(np.maximum(np.diagonal(both.covariance(index)), 0))
        change = np.abs(theta - old)
        moved = bool((change > SETTLED * np.maximum(errors, 1e-12)).any())
        counted = self._counted()
        for key, (normal, nuisances) in self.sets.items():
            name = key.partition("/")[2]
            if name in self.placements:
                step, brighter = self._place(name, normal, nuisances, counted)
                moved |= step > SETTLED_POSE or brighter > SETTLED_GAIN
        return moved

    def _place(
        self, name: str, normal: Normal, nuisances: Sequence[Nuisance], theta: Array
    ) -> tuple[float, float]:
        """Place the render of a set by its normal equations; return how far it was."""
        shared = [k for k, one in enumerate(nuisances) if not one.own]
        at = np.array(shared, np.intp) + len(theta)
        deviations = np.array([nuisances[k].deviation for k in shared])
        found = normal.found(at, deviations, theta)
        named = dict(zip([nuisances[k].name for k in shared], found, strict=True))
        self.placements[name], *far = self.placements[name].moved(named)
        return far[0], far[1]

    def _align(self) -> None:
        """Find where renders lie and how bright they are, by nuisances alone."""
        free = self.capture_set.nuisances
        members: dict[str, list[View]] = {}
        for view in self.views:
            if view.frame.level_free or view.is_table:
                continue
            if view.frame.capture.shows.render or free & {"exposure", "white_balance"}:
                members.setdefault(view.frame.capture.set, []).append(view)
        for name, views in members.items():
            self.placements[name] = Placement.none()
            first = views[0]
            if first.frame.capture.shows.render and "registration" in free:
                mean = predict(self.model, first.frame).mean
                usable = first.keep & (mean < UNCLIPPED)
                guess = first_guess(first.signal, mean, usable)
                self.placements[name].affine[:, 0] = guess
            for turn in range(ALIGNMENTS):
                doubt = DOUBTS[min(turn, len(DOUBTS) - 1)]
                normal, nuisances = self._doubted(views, doubt)
                step, brighter = self._place(name, normal, nuisances, np.zeros(0))
                still = step < SETTLED_POSE and brighter < SETTLED_GAIN
                if turn >= len(DOUBTS) - 1 and still:
                    break

    def _doubted(
        self, views: Sequence[View], doubt: float
    ) -> tuple[Normal, list[Nuisance]]:
        """Return the normal equations of a set for its nuisances alone, of a prediction
        that is wrong by a share of the light."""

        def work(view: View) -> tuple[Normal, list[Nuisance]]:
            point = self.point(view)
            doubted = np.sqrt(1 + (doubt * point.mean * point.root) ** 2)
            point.root = point.root / doubted
            nuisances = [one for one in self.nuisances(point) if not one.own]
            return normal_of(point, [], Space.of({}), np.zeros(0), nuisances), nuisances

        found = self.workers.map(work, views)
        return reduce(add, (normal for normal, _ in found)), found[0][1]

    def _fill_well(self) -> bool:
        """Fit the full well; return whether it was found, or lost, or moved."""
        stated = self.model.profile_parameters.get(WELL, {}).get("below_white", 0.0)
        if WELL not in self.names or stated:
            return False
        term, self.model = self.model.term(WELL), self.model.without(WELL)
        level, error, gain = full_well(self.points_of(FIT), self.points_of(SELECT))
        self.nats.pop(WELL, None)
        self.shapes.pop(WELL, None)
        if gain < self.least:
            return term is not None
        self.nats[WELL], self.shapes[WELL] = (
            gain,
            (np.array([1 - level]), np.array([error])),
        )
        self.model = self.model.with_term(Term(effect(WELL), np.array([1 - level])))
        return term is None or abs(term.values[0] - 1 + level) > SETTLED_WELL

    def _fit_noise(self) -> bool:
        """Fit the size of the noise, and what captures have beyond it; return whether
        that changed."""
        points = self.points_of(FIT)
        left = self.workers.map(self.left, points)
        pixels = [k for k, p in enumerate(points) if not p.view.is_table]
        changed = False
        if self.fits_noise and pixels:
            factors, self.of_noise = noise_factors(
                [points[k] for k in pixels], [left[k] for k in pixels]
            )
            self.model = with_noise(self.model, factors)
            changed = bool(np.abs(np.log(factors)).max() > SETTLED_NOISE)
        if self.capture_set.nuisances & {"registration", "radiance"}:
            images = [k for k in pixels if points[k].frame.capture.shows.image]
            shift, texture = excess_of(
                [points[k] for k in images], [left[k] for k in images]
            )
            self.excess = replace(self.excess, shift=shift, texture=texture)
        # How wrong a chart's colours are is one number, and a split has few patches.
        self.excess = replace(self.excess, patches=0.0)
        charts = [self.point(view) for view in self.views if view.is_chart]
        if charts:
            patches = patch_deviation(charts, self.workers.map(self.left, charts))
            self.excess = replace(self.excess, patches=patches)
        return changed

    def _refine(self) -> None:
        """Add the detail of the shape of chosen effects that have one, if validation
        frames gain as much as by a name."""
        effects, theta = self.effects, self.theta
        grams, sets = self.grams, self.sets
        named = self.chosen.names
        detailed = [
            one.in_detail if one.name in named and one.in_detail else one
            for one in effects
        ]
        if detailed == effects:
            return
        self.effects = detailed
        every = np.zeros(self.space.size)
        plain: list[int] = []
        old = Space.of({one.name: len(one.used) for one in effects})
        for before in effects:
            at = self.space.slices[before.name].start + np.arange(len(before.used))
            every[at] = theta[old.slices[before.name]]
            plain += at.tolist() if before.name in self.fitted else []
        self.theta = every
        self._sum()
        train, validation = self.with_known(self.grams[FIT]), self.grams[SELECT]
        whole = self.space.index(self.fitted)
        gained = validation.gain(train.fit(whole)) - validation.gain(
            train.fit(np.array(plain, np.intp))
        )
        if gained < self.least:
            self.effects, self.theta = effects, theta
            self.grams, self.sets = grams, sets
            return
        self._move()

    def _add_alternatives(self, name: str, others: Iterable[str]) -> None:
        """Say that a chosen effect may be one of others instead."""
        every = [*self.chosen.alike.get(name, ()), *((other,) for other in others)]
        alike = {**self.chosen.alike, name: every}
        self.chosen = replace(self.chosen, alike=alike)

    def _doubt_offsets(self) -> None:
        """Say what else offsets may be, which no darks tell: a ramp, and a dark current
        with it or too weak to show one, glow; a black level, drift, if scenes agree on
        it no better than by chance (Student, Biometrika 6(1), 1908)."""
        glows = {RAMP, CURRENT} & {*self.chosen.names} if GLOW in self.names else set()
        ramp = EVEN_GLOW * self.chosen.nats.get(CURRENT, math.inf)
        if RAMP in glows or ramp < nats_to_be_seen(self.least):
            for name in glows:
                self._add_alternatives(name, [GLOW])
        if BLACK not in self.chosen.names:
            return
        own, counted = self.space.index([BLACK]), self._counted()
        each = []
        for key, (normal, nuisances) in self.sets.items():
            if key.partition("/")[0] != REPORT:
                gram = _without(normal, nuisances, False).gram(self.space.size)
                left = (gram.score - gram.information @ counted)[own].sum()
                each.append(left / gram.information[np.ix_(own, own)].sum())
        index = self.space.index(self.fitted)
        at = np.ix_(places := np.searchsorted(index, own), places)
        known = np.linalg.inv(self.both.covariance(index)[at])
        mean = float((known @ self.theta[own]).sum() / known.sum())
        # Where offsets differ all over the frame, its first columns may as well.
        others = {*self.chosen.names, *sum(self.chosen.alike.get(BLACK, ()), ())}
        may_be = {RAMP} if others & {RAMP, MISMATCH} else set()
        if ttest_1samp(mean + np.array(each), 0.0).pvalue > self.alpha:
            may_be.add(DRIFT)
        may_be &= self.names - {*self.chosen.names}
        self._add_alternatives(BLACK, sorted(may_be))

    def _doubt_well(self) -> None:
        """Say whether what looks like a full well may be pixels at white that a filter
        blended with darker ones."""
        if WELL not in self.nats or FILTER not in self.names:
            return
        bare = self.model.without(WELL)
        train, validation = (self.points_of(split, bare) for split in (FIT, SELECT))
        if full_well(train, validation, are_blended=True)[2] < self.least:
            self._add_alternatives(WELL, [FILTER])

    def _doubt_light(self) -> None:
        """Say what may be an effect that these frames do not show: what gains too
        little if light is free to change as that makes it."""
        names = self.chosen.names
        for doubt in sorted(self.doubts) if names else ():
            sets = self._summed(self.views, self.effects, doubt=doubt)
            select = self._selection(self._grams(sets))
            for name in names:
                if select.nats(name, names) < self.least:
                    self._add_alternatives(name, [doubt])

    def _find_flicker(self) -> None:
        """Judge whether light comes in waves, and of which period."""
        if FLICKER not in self.names or self.stated_flicker is not None:
            return
        train, validation = (
            waves.row_waves(self.points_of(one)) for one in (FIT, SELECT)
        )
        if train is None or validation is None:
            return
        self.least_flicker = validation.smallest(self.least)
        gain = waves.validation_gain(train, validation)
        if gain >= self.least:
            self.nats[FLICKER] = gain
            self._measure_flicker()

    def _measure_flicker(self) -> None:
        """Measure the waves that were found, in means as well if all else of their
        light is known."""
        if FLICKER in self.nats:
            known = not self.capture_set.nuisances & {"registration", "radiance"}
            points = [*self.points_of(FIT), *self.points_of(SELECT)]
            if (found := waves.row_waves(points, known)) is not None:
                self.shapes[FLICKER] = waves.measured(found)

    def _count_photons(self) -> None:
        """Judge whether light is counted by Poisson's law."""
        drawn = self.capture_set.sensor.noise_effects
        if PHOTONS not in self.names or PHOTONS in drawn:
            return
        # Nothing is fitted: training frames judge it as well.
        points = [*self.points_of(FIT), *self.points_of(SELECT)]
        points = [point for point in points if not point.view.is_table]
        gain = photons(points, self.workers.map(self.left, points))
        if gain >= self.least:
            self.nats[PHOTONS], self.shapes[PHOTONS] = gain, (np.ones(1), np.zeros(1))

    # What test frames say.

    @cached_property
    def test_points(self) -> tuple[list[Point], list[Point]]:
        """Those of the profile, and of all that was found."""
        kept = [term for term in self.model.terms if term.calibration]
        before = replace(self.model, terms=tuple(kept))
        return self.points_of(REPORT, before), self.points_of(REPORT)

    @cached_property
    def residual_tests(self) -> tuple[list[ResidualTest], list[ResidualTest]]:
        """The same."""
        found = []
        for points, stated in zip(self.test_points, (True, False), strict=True):
            asked = Residuals(self.of_noise)
            for point in points:
                asked.add(point, self.nuisances(point, stated))
            found.append(asked.tests())
        return found[0], found[1]

    @property
    def freedom(self) -> float:
        """Degrees of freedom of the chi-square of test frames, as noise is known: of
        pixels that are blended, the fewer that they share noise."""
        n = max(self.grams[REPORT].n, 1)
        if self.of_noise is not None:
            points = [point for point in self.test_points[1] if not point.view.is_table]
            n = freedom_of(n, points, self.of_noise)
        return n * variance_left(self.model)

    @property
    def of_flicker(self) -> float:
        """The part of the squares of test frames that flicker, where it was found, is
        of."""
        if FLICKER not in self.shapes:
            return 0.0
        return self._squares(REPORT, stated=True) - self._squares(REPORT)

    @property
    def selected(self) -> Predicted:
        """Frames that select effects, with what is predicted of them."""
        return [(p.frame, p.prediction) for p in self.points_of(SELECT)]


def _without(normal: Normal, nuisances: Sequence[Nuisance], own: bool) -> Normal:
    """Return normal equations without the views' own nuisances, or those of sets."""
    which = [k for k, one in enumerate(nuisances) if one.own == own]
    if not which:
        return normal
    first = len(normal.products) - 1 - len(nuisances)
    deviations = np.array([nuisances[k].deviation for k in which])
    return normal.without(np.array(which) + first, deviations)


def decide(
    capture_set: CaptureSet,
    frames: Sequence[Frame],
    names: Collection[str],
    *,
    doubts: Collection[str],
    alpha: float,
    most: int,
    fits_noise: bool,
    workers: Workers,
    say: Say,
) -> Scenes:
    """Return what images show. Arguments: as of Scenes. Raises ValueError for images
    that decide nothing."""
    views = views_of(frames)
    for group in (FIT, SELECT, REPORT):
        if not any(view.group == group for view in views):
            raise ValueError(
                f"no frame is in the group {group}: not enough to fit, select and "
                "report on different frames; add frames"
            )
    found = Scenes(
        capture_set,
        views,
        frozenset(names),
        frozenset(doubts),
        alpha,
        most,
        fits_noise,
        workers,
    )
    found.run(say)
    return found
