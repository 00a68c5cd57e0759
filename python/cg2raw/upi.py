# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""UPI: random cameras instead of a chosen one, for comparison.

Source: T. Brooks et al., Unprocessing Images for Learned Raw Denoising, CVPR 2019. Its
inverse tone curve and gamma are left out: a render is scene linear already.
"""

import itertools
import json
import math
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cg2raw import _core
from cg2raw.cfa import is_mono, sites_of
from cg2raw.core_arguments import shown
from cg2raw.exposure import takes_run
from cg2raw.raw_frame import RawFrame
from cg2raw.sensor import Sensor

if TYPE_CHECKING:  # type checkers bring it along
    from typing_extensions import Unpack

    from cg2raw.exposure import RunFields

SensorLike = Sensor | str | os.PathLike[str]
Range = tuple[float, float]

# Section 3.2 and 4 of the paper: white balance gains, and what a global gain is the
# inverse of.
# By name: red's and blue's. Sources: Brooks et al.; what Seo et al. compared with.
GAINS = {
    "published": ((1.9, 2.4), (1.5, 1.9)),
    "graphics2raw": ((1.0, 3.3), (1.3, 4.4)),
}
LEAST_GAIN, MOST_GAIN = 0.01, 100.0
DIGITAL_GAIN_MEAN, DIGITAL_GAIN_SIGMA = 0.8, 0.1
# Noise of the Darmstadt data set's cameras: variance = shot x + read, x in 0..1.
SHOT_NOISE = (1e-4, 1.2e-2)
READ_SLOPE, READ_INTERCEPT, READ_SIGMA = 2.18, 1.20, 0.26
# The ten cameras of Graphics2RAW (Seo et al., ICCV 2023): nine of NUS, and a phone.
PAPER_SENSORS = (
    "canon-1ds-mark-iii",
    "canon-600d",
    "fujifilm-x-m1",
    "nikon-d40",
    "nikon-d5200",
    "olympus-e-pl6",
    "panasonic-gx1",
    "samsung-nx2000",
    "sony-a57",
    "samsung-s20fe",
)
DECIMALS = 4  # of a DNG's matrices: pixels are made with what the file will say
DROPPED = (
    "calibration_illuminant_2",
    "color_matrix_2",
    "forward_matrix_2",
    "illuminants",
    "digital_gain",
    "effects",
)


@dataclass(frozen=True)
class UpiDraw:
    """One camera that UPI has drawn."""

    weights: tuple[float, ...]  # of Upi.matrices, 0 or above, sum 1
    camera_from_xyz: NDArray[np.float64]  # (3, 3), of D65
    red_gain: float  # white balance gains over green's
    blue_gain: float
    digital_gain: float  # multiplies the image: the inverse of UPI's global gain
    shot_noise: float | None  # None: the sensor's noise, or none
    read_noise: float | None
    sensor: Sensor  # the given one with the drawn matrix
    illuminant: str  # word of the drawn gains


class Upi:
    """Draws cameras as UPI does, with the CFA, levels and bits of one sensor.

    sensor : Sensor, or its id or path.
    matrices : sensors whose D65 matrices are mixed, at least one.
    gains : "published" (red 1.9..2.4, blue 1.5..1.9), "graphics2raw" (1.0..3.3,
        1.3..4.4: what that paper compared with), "camera" (those of the box around the
        hull of @sensor's neutrals), or ranges ((low, high) of red, (low, high) of
        blue); independent and uniform.
    digital_gain : "upi" for N(0.8, 0.1), the inverse of UPI's global gain, or a number.
    noise : "sensor" (at the ISO of each `simulate`, none without one), or "upi" (drawn,
        on every Bayer sensor).
    Raises ValueError for a sensor without a D65 matrix, or without a hull where that is
    asked for."""

    def __init__(
        self,
        sensor: SensorLike,
        *,
        matrices: Iterable[SensorLike] = PAPER_SENSORS,
        gains: str | Sequence[Sequence[float]] = "published",
        digital_gain: float | str = "upi",
        noise: str = "sensor",
    ) -> None:
        self.sensor = _sensor(sensor)
        self.matrices = {s.id: d65_matrix(s) for s in map(_sensor, matrices)}
        if not self.matrices:
            raise ValueError("matrices is empty: name at least one sensor")
        _one_of("noise", noise, ("sensor", "upi"))
        if is_mono(self.sensor.cfa):
            raise ValueError(
                f"UPI draws colour matrices and white balances, and {self.sensor.id} "
                "is monochrome: take the sensor itself (method graphics2raw)"
            )
        if noise == "upi" and len(sites_of(self.sensor.cfa)) != 4:
            raise ValueError(
                f"noise upi: is for Bayer sensors; the CFA of {self.sensor.id} is of "
                f"{len(sites_of(self.sensor.cfa))} sites"
            )
        self.red_gains, self.blue_gains = asked_ranges(gains, self.sensor)
        if isinstance(digital_gain, str):
            _one_of("digital_gain", digital_gain, ("upi",))
        self.digital_gain = digital_gain
        self.noise = noise

    def draw(self, seed: int = 0) -> UpiDraw:
        """Return the UpiDraw of a seed; a pure function of it and of the parameters.

        Weights are uniforms over their sum: the paper says "random convex combination"
        and no more."""
        rng = _core.Rng(seed, "upi/matrix")
        uniforms = [rng.uniform(n) for n in range(len(self.matrices))]
        weights = tuple(value / math.fsum(uniforms) for value in uniforms)
        parts = [
            weight * each
            for weight, each in zip(weights, self.matrices.values(), strict=True)
        ]
        matrix = sum(parts, start=np.zeros((3, 3))).round(DECIMALS)
        rng = _core.Rng(seed, "upi/gains")
        red, blue = (
            low + (high - low) * rng.uniform(n)
            for n, (low, high) in enumerate((self.red_gains, self.blue_gains))
        )
        shot, read = drawn_noise(seed) if self.noise == "upi" else (None, None)
        return UpiDraw(
            weights=weights,
            camera_from_xyz=matrix,
            red_gain=red,
            blue_gain=blue,
            digital_gain=self._drawn_digital_gain(seed),
            shot_noise=shot,
            read_noise=read,
            sensor=_with_draw(self.sensor, matrix, shot, read),
            illuminant=f"neutral:{1 / red:.6f}:{1 / blue:.6f}",
        )

    @partial(takes_run, without=("illuminant", "digital_gain"))
    def simulate(
        self,
        rgb: ArrayLike,
        *,
        threads: int = 0,
        **run: "Unpack[RunFields]",
    ) -> RawFrame:
        """Return the RawFrame of an image by the camera that @seed draws.

        rgb : (H, W, 3) or (H, W, 4) float, scene-linear Rec.709.
        run : fields of cg2raw.Run, but for illuminant and digital_gain, which are
            drawn; neither iso nor noise with noise "upi" of this Upi. frame : noise
            differs from frame to frame, the camera does not.
        Raises ValueError."""
        if self.noise == "upi" and {run.get("iso"), run.get("noise")} != {None}:
            raise ValueError("UPI draws the noise itself: leave iso and noise out")
        drawn_fields = sorted({"illuminant", "digital_gain"} & run.keys())
        if drawn_fields:
            raise ValueError(f"UPI draws {drawn_fields[0]} itself: leave it out")
        drawn = self.draw(run.get("seed", 0))
        run["illuminant"] = drawn.illuminant
        run["digital_gain"] = drawn.digital_gain
        return drawn.sensor.simulate(
            rgb,
            threads=threads,
            **run,
        )

    def _drawn_digital_gain(self, seed: int) -> float:
        """Return the factor of the image, above 0."""
        if not isinstance(self.digital_gain, str):
            return self.digital_gain
        rng = _core.Rng(seed, "upi/digital_gain")
        draws = (
            DIGITAL_GAIN_MEAN + DIGITAL_GAIN_SIGMA * rng.normal(n)
            for n in itertools.count()
        )
        return round(next(value for value in draws if value > 0), 6)


def d65_matrix(sensor: Sensor) -> NDArray[np.float64]:
    """Return the (3, 3) ColorMatrix of a sensor for D65. Raises ValueError."""
    for calibration in sensor.calibrations:
        if calibration["light_source"] == "D65":
            return np.asarray(calibration["camera_from_xyz"])
    raise ValueError(f"sensor {sensor.id} has no colour matrix for D65")


def asked_ranges(
    gains: str | Sequence[Sequence[float]], sensor: Sensor
) -> tuple[Range, Range]:
    """Return (red's, blue's) ranges of what Upi takes for gains. Raises ValueError."""
    if isinstance(gains, str):
        _one_of("gains", gains, (*GAINS, "camera"))
        return gain_ranges(sensor) if gains == "camera" else GAINS[gains]
    try:
        ranges = np.array(gains, object).astype(float)
    except (TypeError, ValueError, OverflowError):
        ranges = np.empty(0)
    if ranges.shape != (2, 2) or not (
        LEAST_GAIN <= ranges.min() and ranges.max() <= MOST_GAIN
    ):
        raise ValueError(
            f"gains {shown(gains)} must be ((low, high), (low, high)) of red and blue, "
            f"{LEAST_GAIN:g} to {MOST_GAIN:g}"
        )
    if (ranges[:, 0] > ranges[:, 1]).any():
        raise ValueError(f"gains {shown(gains)}: a range goes from low to high")
    (red_low, red_high), (blue_low, blue_high) = ranges.tolist()
    return (red_low, red_high), (blue_low, blue_high)


def gain_ranges(sensor: Sensor) -> tuple[Range, Range]:
    """Return ((low, high) of red, (low, high) of blue) white balance gains of a sensor.

    They are 1 over its neutrals, over the hull of what was measured. Raises ValueError
    if it has no hull."""
    hull = np.asarray(sensor.illuminants["hull"], float)
    if not hull.size:
        raise ValueError(
            f"sensor {sensor.id} has fewer than 3 measured neutrals, so no range of "
            "gains: take the published ones"
        )
    least, most = hull.min(axis=0), hull.max(axis=0)
    (red_low, blue_low), (red_high, blue_high) = (
        (1 / most).tolist(),
        (1 / least).tolist(),
    )
    return (red_low, red_high), (blue_low, blue_high)


def drawn_noise(seed: int) -> tuple[float, float]:
    """Return (shot, read) of a seed: variance = shot x + read, x in 0..1.

    log shot is uniform, log read normal around a line in log shot. Six digits, so that
    no machine's logarithm makes a difference."""
    rng = _core.Rng(seed, "upi/noise")
    low, high = map(math.log, SHOT_NOISE)
    log_shot = low + (high - low) * rng.uniform(0)
    # The uniforms 2 and 3.
    log_read = READ_SLOPE * log_shot + READ_INTERCEPT + READ_SIGMA * rng.normal(1)
    return float(f"{math.exp(log_shot):.6g}"), float(f"{math.exp(log_read):.6g}")


def _with_draw(
    sensor: Sensor, matrix: NDArray[np.float64], shot: float | None, read: float | None
) -> Sensor:
    """Return @sensor with the drawn matrix, and noise if it was drawn.

    UPI's pixels are camera = row-normalised(matrix . XYZ D65 from sRGB), with no
    adaptation to the light. A reader with one matrix (LibRaw, dcraw) inverts just that.
    The ForwardMatrix makes those that adapt invert it too, and the core follow it."""
    fields = json.loads(sensor.to_json())
    for name in DROPPED:
        fields.pop(name, None)
    balanced = matrix @ _core.xyz_d65_from_srgb()
    balanced /= balanced.sum(axis=1, keepdims=True)
    forward = _core.xyz_d50_from_srgb() @ np.linalg.inv(balanced)
    source = "drawn by UPI (Brooks et al., CVPR 2019)"
    fields |= {
        "calibration_illuminant_1": "D65",
        "color_matrix_1": matrix.ravel().tolist(),
        "forward_matrix_1": forward.round(DECIMALS).ravel().tolist(),
        # Converters know cameras by name, and would take their own matrices.
        "model": f"{sensor.model} UPI",
        "unique_camera_model": f"{sensor.unique_camera_model} UPI",
    }
    if shot is not None:
        fields.pop("noise", None)
        fields.pop("noise_effects", None)
        fields["effects"] = [
            {"name": "shot_noise", "parameters": _per_site("beta1", shot)},
            {"name": "read_noise", "parameters": _per_site("beta2", read)},
        ]
    kept = {name: text for name, text in fields["sources"].items() if name in fields}
    fields["sources"] = kept | dict.fromkeys(
        ("calibration_illuminant_1", "color_matrix_1", "forward_matrix_1"), source
    )
    return Sensor.from_json(json.dumps(fields), sensor.id)


def _per_site(name: str, value: float | None) -> dict[str, float | None]:
    """Return an effect's parameters that are the same at the four sites."""
    return {f"{name}_{site}": value for site in ("00", "01", "10", "11")}


def _sensor(sensor: SensorLike) -> Sensor:
    """Return a Sensor of itself, its id or its path."""
    return sensor if isinstance(sensor, Sensor) else Sensor(sensor)


def _one_of(name: str, value: object, allowed: Sequence[str]) -> None:
    """Raise ValueError unless @value is one of @allowed."""
    if value not in allowed:
        raise ValueError(f"{name} {shown(value)} must be {' or '.join(allowed)}")
