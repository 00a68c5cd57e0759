# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Captures: measured RAW frames and what was in front of the lens."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from cg2raw.arrays import FloatImage, RawImage
from cg2raw.diagnose.captures.patch_means import PatchMeans
from cg2raw.sensor import Sensor

Kind = Literal["dark", "flat", "scene", "chart"]
Group = Literal["fit", "select", "report"]


@dataclass(frozen=True)
class CaptureKind:
    """What captures of a kind show. light : any at all. image : differing parts.
    render : the pixels of one, whose edges are known. fields : of the manifest, that
    this kind has besides those of all. scene : what its scene must be, "" for none."""

    light: bool
    image: bool
    render: bool
    fields: frozenset[str] = frozenset()
    scene: str = ""


KINDS: Mapping[Kind, CaptureKind] = {
    "dark": CaptureKind(light=False, image=False, render=False),
    "flat": CaptureKind(
        light=True,
        image=False,
        render=False,
        fields=frozenset({"scene", "gain"}),
        scene="its radiance, a number or [r, g, b], or unknown",
    ),
    "scene": CaptureKind(
        light=True,
        image=True,
        render=True,
        fields=frozenset({"scene", "gain", "linearize"}),
        scene="the render of it (EXR, TIFF, PNG or .npy)",
    ),
    "chart": CaptureKind(
        light=True,
        image=True,
        render=False,
        fields=frozenset({"gain", "patches", "chart", "corners"})
        | {"unit", "count", "cut_below", "cut_above"},  # of a table of patch means
    ),
}
NUISANCES = (
    *("exposure", "white_balance", "registration", "light", "radiance"),
    "temperature",
)


@dataclass(frozen=True)
class Capture:
    """One RAW frame; its pixels are read when they are asked for, and not kept.

    name : of its file, for messages and the report.
    shape : (H, W) of the active area.
    group : of frames it belongs to: parameters are fitted on "fit", effects accepted
        on "select", numbers shown are of "report".
    set : frames of one set repeat the same light from the same place.
    illuminant : word of the illuminant grammar.
    iso : None where neither manifest nor file says it.
    exposure_time : s; None where it is not known.
    temperature : of the sensor, degrees Celsius; None where it is not known.
    raw : () -> (H, W) uint16 DN, the active area.
    scene : () -> what the camera should have seen, scene-linear Rec.709 times the gain,
        so that 1 is the model's white level: (H, W, 3) float32, or (3,) where it is
        uniform. None if it is unknown; zeros for a dark.
    mask : () -> (H, W) bool, True where a pixel counts; None where all do.
    digest : of the bytes of its file; "" where there is none.
    divided : it is one of three captures of one frame, a group each by its mask.
    means : of a chart without pixels, in the place of raw and scene; shape is (P, 4).
    """

    name: str
    kind: Kind
    shape: tuple[int, int]
    group: Group
    set: str
    illuminant: str
    iso: float | None
    exposure_time: float | None
    raw: Callable[[], RawImage]
    scene: Callable[[], FloatImage] | None
    mask: Callable[[], NDArray[np.bool_]] | None = None
    as_shot: Sequence[float] | None = None
    temperature: float | None = None
    means: PatchMeans | None = None
    digest: str = ""
    divided: bool = False

    @property
    def shows(self) -> CaptureKind:
        return KINDS[self.kind]

    @property
    def is_uniform(self) -> bool:
        """Whether it is a dark or a flat."""
        return self.kind in ("dark", "flat")

    @property
    def has_known_light(self) -> bool:
        """Whether what was in front of the lens is known."""
        return self.scene is not None or self.shows.image


@dataclass(frozen=True)
class CaptureSet:
    """The frames of one sensor, and what of their capture is not to be trusted.

    sensor : the baseline, a Sensor.
    nuisances : what may float without being called an effect: "exposure" (each set's
        brightness), "white_balance" (each set's), "registration" (affine, each set),
        "light" (brightness from frame to frame), "radiance" (smooth error of a render),
        "temperature" (of the sensor, and with it dark charge, from frame to frame).
    uncertainty : declared lower bounds of nuisances: "light" and "radiance" relative,
        "registration" px after alignment.
    notes : sentences on what was assumed of the files, for the report.
    """

    sensor: Sensor
    captures: Sequence[Capture]
    nuisances: frozenset[str] = frozenset()
    uncertainty: Mapping[str, float] = field(default_factory=dict)
    file: str = ""
    notes: Sequence[str] = ()

    @property
    def temperature(self) -> float | None:
        """Temperature that half of the captures are warmer than; None if it is not
        known of all."""
        known = [capture.temperature for capture in self.captures]
        if not known or None in known:
            return None
        return float(np.median(np.array(known, float)))
