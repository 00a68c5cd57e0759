# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Diagnosis: the result as frozen objects, which verdict.json holds as text."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

VERDICTS = {  # and their exit codes
    "consistent": 0,
    "explained": 10,
    "ambiguous": 11,
    "partially_explained": 12,
    "unexplained": 13,
    "incomplete": 14,
}


# What the verdict goes by; reports and the command show the same.
STRUCTURE = 1e-3  # chance of one false alarm among all residual tests
LEAST_NATS = 2e-4  # per pixel; what is smaller is a trace, and no structure
SHARE_LEFT = 1e-3  # of what was closed, likewise
# Absolute bounds, whatever was closed: nats per pixel that nobody calls a trace, and
# how far reduced chi-square of whole frames may be from 1.
LARGE_NATS, LARGE_P = 1e-3, 1e-4
CHI_SQUARE, CHI_SQUARE_ERRORS = 0.02, 4.0  # standard errors, where pixels are few
CHI_SQUARE_NAME = "chi-square of whole frames"
LARGEST_E = 1e300  # the largest e-value that is written; it stands for more, too
LARGEST_SHIFT = 4  # px of misregistration that is taken up


Histogram = tuple[NDArray[Any], NDArray[Any]]  # bin edges, counts


@dataclass(frozen=True)
class Estimate:
    """A parameter: value, unit, and the interval that holds it with 95 %."""

    value: float
    unit: str
    ci95: tuple[float, float]


@dataclass(frozen=True)
class Alternative:
    """Another name that was tried in an effect's place."""

    name: str
    gain_nats: float  # held-out, over the model without either


@dataclass(frozen=True)
class Finding:
    """An effect that was accepted."""

    name: str
    parameters: Mapping[str, Estimate]
    gain_nats: float  # log-likelihood that the select frames lose without it
    e_value: float  # capped at 1e300
    alternatives: Sequence[Alternative]  # best first
    ambiguous_with: Sequence[str]
    where: str  # what the residuals looked like
    sentence: str  # plain words with numbers
    provisional: bool = False  # something unexplained is left
    stated: bool = False  # the profile has it, with other values


@dataclass(frozen=True)
class ResidualTest:
    """One question to the standardised residuals, and its answer."""

    name: str
    statistic: float  # standard deviations, or relative excess of a chi-square
    p_value: float
    nats_per_pixel: float
    where: str


@dataclass(frozen=True)
class Gap:
    """Distance of simulation and measurement on the report frames, nats per pixel.

    before, after : against the true density where it is known (simulated captures),
        else estimated from the residuals: 0 is what the final model's own noise gives.
    interval_before, interval_after : hold before and after with 95 %.
    """

    before: float
    after: float
    chi2_before: float
    chi2_after: float
    held_out: Sequence[str]
    interval_before: tuple[float, float] | None = None
    interval_after: tuple[float, float] | None = None


@dataclass(frozen=True)
class Picture:
    """One report frame before and after, reduced to at most 512 px a side.

    measured, before, after : (h, w, 3) signal per colour, 0..1 above black.
    z_before, z_after : (h, w) mean residual of a cell times the root of its pixels, in
        standard deviations: N(0, 1) if nothing is missing.
    neutral : camera RGB of a neutral patch under this light, G = 1, to show it by.
    """

    name: str
    kind: str
    measured: NDArray[np.float32]
    before: NDArray[np.float32]
    after: NDArray[np.float32]
    z_before: NDArray[np.float32]
    z_after: NDArray[np.float32]
    neutral: Sequence[float] | None = None


@dataclass(frozen=True)
class Curve:
    """A fitted curve with its interval and what was measured, to be drawn.

    Each of x, y, low, high is (n,); measured_x, measured_y (m,)."""

    title: str
    x_label: str
    y_label: str
    x: NDArray[np.float64]
    y: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    measured_x: NDArray[np.float64]
    measured_y: NDArray[np.float64]
    effect: str


@dataclass(frozen=True)
class Series:
    """What is measured at x, and what both models say; each (n,). name : of a site of
    the CFA, "" of all together."""

    name: str
    x: NDArray[np.float64]
    measured: NDArray[np.float64]
    before: NDArray[np.float64]
    after: NDArray[np.float64]


@dataclass(frozen=True)
class Chart:
    """What test frames show of one effect: measured, and predicted without it (before)
    and with it (after), all else as it was found.

    effect : its name; "" of all that was found against the profile. title : what is
    drawn. x_label, y_label : quantity and unit. form : "lines" over x, "bars" of names,
    or "bands" that hold 95 %, of which before and after are half the width.
    scale : of x and y."""

    effect: str
    title: str
    x_label: str
    y_label: str
    series: Sequence[Series]
    form: str = "lines"
    names: Sequence[str] = ()
    scale: str = "linear linear"


@dataclass(frozen=True)
class DetectionLimit:
    """How much stronger than in the profile an effect must be to be named in 95 of 100
    such sets of captures."""

    name: str
    parameter: str
    strength: float | None  # None: these captures cannot show it
    unit: str


@dataclass(frozen=True)
class Diagnosis:
    """All of a verdict. histogram_*: (bin edges, counts) of z on the report frames."""

    verdict: str
    sensor_id: str
    effects: list[Finding]
    gap: Gap
    tests_before: list[ResidualTest]
    tests_after: list[ResidualTest]
    unexplained: list[ResidualTest]
    detection_limits: list[DetectionLimit]
    next_captures: list[str]  # sentences: what to capture to decide or to go on
    notes: list[str]  # sentences: free nuisances, what was not tested
    groups: Mapping[str, Sequence[str]]  # fit, select, report -> names of frames
    pictures: list[Picture] = field(default_factory=list)
    curves: list[Curve] = field(default_factory=list)
    charts: list[Chart] = field(default_factory=list)
    histogram_before: Histogram | None = None
    histogram_after: Histogram | None = None
    profile_json: str = ""  # the sensor with the effects added
    white_dn: float | None = None  # above black
    electrons_per_dn: float | None = None  # by the profile with what was found
    interrupted: bool = False
    time_limit_reached: bool = False  # which then ended with what it had
    seconds: float = 0.0
