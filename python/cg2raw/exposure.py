# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Run: the options of one exposure, as the core takes them."""

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypedDict, TypeVar

from cg2raw import _core
from cg2raw.argument_types import NUMBER, TEXT, TRUTH, check_types
from cg2raw.core_arguments import shown

Light = str | _core.Illuminant
Limits = tuple[float, float] | str  # "LOW:HIGH"
Function = TypeVar("Function", bound=Callable[..., Any])


@dataclass(frozen=True, kw_only=True)
class Run:
    """What one exposure is asked to be: the keywords of Sensor.simulate and its like.

    illuminant : word of the illuminant grammar, or an Illuminant. A monochrome sensor
        needs none.
    iso : None for no noise; else within one stop of the calibrated ISOs.
    noise : how it is drawn, with the same variance: None for what the profile says
        (its noise_effects), "gaussian", or "physical" (Poisson photons, Tukey lambda
        read noise with the profile's outliers, row noise), which needs an iso and a
        profile whose noise has tukey_lambda and row_sigma.
    seed, frame : key of everything random; noise differs from frame to frame.
    exposure : stops by which the scene is brightened before anything clips; or "auto"
        (metered), "auto:PERCENTILE:LEVEL", "random:LOW:HIGH", "normal:MEAN:SD" (drawn
        by seed and frame), "match:FILE" (metered: its level is that of captures, by
        a file of `cg2raw match`), "match:FILE:draw" (drawn of that file). None for 0.
    exposure_time : seconds, or "1/60"; effects of dark current need it.
    f_number : of the lens.
    scene_luminance : cd/m2 of the value 1: brightness follows exposure_time, f_number
        and iso then (ISO 12232), and exposure comes on top; "auto" finds the one of the
        three that is None.
    nd_filter : stops that a neutral density filter takes of scene_luminance.
    iso_limits, time_limits, f_number_limits : of what "auto" finds, (low, high) or
        "LOW:HIGH"; None for the calibrated ISOs, 1/8000 to 30 s, 1 to 32.
    bracket : stops by which exposure_time is another; noise differs between them.
    meter : what a meter has read, as luminance in units of the value 1; None:
        simulate, signal and predict read it of their image.
    digital_gain : multiplies the white balance gains (0 to 1000); "sample" draws it
        from the profile, by seed and frame.
    convention : "dng" (inverse of a DNG renderer), "paper", or "sensor": the light as a
        camera takes it, which clips where its effects and its white level say and no
        earlier; noise falls on every site. "spectral" is "sensor" with colours as the
        spectral_sensitivities see reflectances under the illuminant's spectrum.
    highlights : keep white white while white balance is undone; not with "sensor" or
        "spectral".
    effects : False for neither the profile's effects nor noise.
    camera_input : the image already is camera RGB under this illuminant.
    as_shot : (3,) neutral that the word as-shot stands for.
    color_effects : False if the image has the profile's effects of stage color
        already, as pixels in a RAW space of OpenColorIO have."""

    illuminant: Light = ""
    iso: float | None = None
    noise: str | None = None
    seed: int = 0
    frame: int = 0
    digital_gain: float | str = 1.0
    convention: str = "dng"
    highlights: bool = True
    effects: bool = True
    camera_input: bool = False
    as_shot: Sequence[float] | None = None
    exposure_time: float | str | None = None
    color_effects: bool = True
    exposure: float | str | None = None
    f_number: float | None = None
    scene_luminance: float | None = None
    nd_filter: float = 0.0
    iso_limits: Limits | None = None
    time_limits: Limits | None = None
    f_number_limits: Limits | None = None
    bracket: float | None = None
    meter: float | None = None


class RunFields(TypedDict, total=False):
    """The fields of a Run as the keywords of a function, for type checkers."""

    illuminant: Light
    iso: float | None
    noise: str | None
    seed: int
    frame: int
    digital_gain: float | str
    convention: str
    highlights: bool
    effects: bool
    camera_input: bool
    as_shot: Sequence[float] | None
    exposure_time: float | str | None
    color_effects: bool
    exposure: float | str | None
    f_number: float | None
    scene_luminance: float | None
    nd_filter: float
    iso_limits: Limits | None
    time_limits: Limits | None
    f_number_limits: Limits | None
    bracket: float | None
    meter: float | None


def takes_run(function: Function, without: Sequence[str] = ()) -> Function:
    """Return a method whose **run is the fields of Run, which help() then lists.

    without : fields that it does not take."""
    signature = inspect.signature(function)
    own = [p for p in signature.parameters.values() if p.kind is not p.VAR_KEYWORD]
    fields = inspect.signature(Run).parameters.values()
    of_run = [field for field in fields if field.name not in without]
    listed = signature.replace(parameters=[*own, *of_run])
    function.__signature__ = listed  # type: ignore[attr-defined]
    hints = {
        p.name: p.annotation for p in listed.parameters.values() if p.name != "self"
    }
    function.__annotations__ = {**hints, "return": signature.return_annotation}
    return function


def core_run(sensor: str, run: Run) -> _core.Run:
    """Return a Run as the core takes it.

    sensor : the id of whose exposure it is. Raises ValueError for other types, and for
    an Illuminant of another sensor."""
    fields: dict[str, Any] = vars(run) | {
        "illuminant": illuminant_word(run.illuminant, sensor)
    }
    if isinstance(run.digital_gain, str) and run.digital_gain == "sample":
        fields |= {"digital_gain": 1.0, "sample_digital_gain": True}
    try:
        return _core.Run(**fields)
    except TypeError:
        raise ValueError(_wrong_types(fields)) from None


def check_transform(convention: str, digital_gain: float, highlights: bool) -> None:
    """Raise ValueError for what are, by their types, no options of a Run."""
    check_types(TEXT, {"convention": convention})
    check_types(NUMBER, {"digital_gain": digital_gain})
    check_types(TRUTH, {"highlights": highlights})


LIMITS = "two numbers, LOW:HIGH or None"
WHOLE = "a whole number from 0 to 2**64 - 1"
# What the fields of a Run must be; the core refuses other types.
TYPES = {
    "iso": f"{NUMBER} or None",
    "noise": "gaussian, physical or None",
    "seed": WHOLE,
    "frame": "a whole number from -2**63 to 2**63 - 1",
    "digital_gain": f"{NUMBER} or sample",
    "convention": "dng, paper, sensor or spectral",
    "highlights": TRUTH,
    "effects": TRUTH,
    "camera_input": TRUTH,
    "as_shot": "three numbers or None",
    "exposure_time": f"{NUMBER}, a text or None",
    "color_effects": TRUTH,
    "exposure": f"{NUMBER}, a text or None",
    "f_number": f"{NUMBER} or None",
    "scene_luminance": f"{NUMBER} or None",
    "nd_filter": NUMBER,
    "iso_limits": LIMITS,
    "time_limits": LIMITS,
    "f_number_limits": LIMITS,
    "bracket": f"{NUMBER} or None",
    "meter": f"{NUMBER} or None",
}


def _wrong_types(fields: Mapping[str, Any]) -> str:
    """Return what is wrong with the fields of a Run that the core does not take."""
    right = vars(Run())
    wrong = []
    for name, words in TYPES.items():
        try:
            _core.Run(**{**right, name: fields[name]})
        except TypeError:
            wrong.append(f"{name} {shown(fields[name])} must be {words}")
    return "; ".join(wrong)


def illuminant_word(illuminant: Light, sensor: str) -> str:
    """Return the word of the grammar that names an illuminant, exactly."""
    if isinstance(illuminant, str):
        return illuminant
    if not isinstance(illuminant, _core.Illuminant):
        raise ValueError(
            f"illuminant {shown(illuminant)} must be one word or an Illuminant; the "
            f"words: {_core.illuminant_grammar}"
        )
    if illuminant.sensor != sensor:
        raise ValueError(
            f"{illuminant!r} is as {illuminant.sensor} sees it, not {sensor}: give the "
            f"word {illuminant.spec!r}, or the illuminant of {sensor}"
        )
    red, _, blue = illuminant.neutral
    return f"neutral:{red!r}:{blue!r}"
