# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""What one exposure is asked to be, as the core takes it."""

from collections.abc import Sequence

from cg2raw import _core

Light = str | _core.Illuminant


def run_of(
    *,
    illuminant: str,
    iso: float | None = None,
    noise: str | None = None,
    seed: int = 0,
    frame: int = 0,
    digital_gain: float | str = 1.0,
    convention: str = "dng",
    highlights: bool = True,
    effects: bool = True,
    camera_input: bool = False,
    as_shot: Sequence[float] | None = None,
    exposure_time: float | None = None,
    color_effects: bool = True,
) -> _core.Run:
    """Return what one exposure is asked to be. Raises ValueError for other types."""
    sampled = isinstance(digital_gain, str) and digital_gain == "sample"
    try:
        return _core.Run(
            illuminant=illuminant,
            iso=iso,
            noise=noise,
            seed=seed,
            frame=frame,
            digital_gain=1.0 if sampled else digital_gain,  # type: ignore[arg-type]
            sample_digital_gain=sampled,
            convention=convention,
            highlights=highlights,
            effects=effects,
            camera_input=camera_input,
            as_shot=as_shot,
            exposure_time=exposure_time,
            color_effects=color_effects,
        )
    except TypeError:
        raise ValueError(
            f"iso {iso!r}, exposure_time {exposure_time!r} and digital_gain "
            f"{digital_gain!r} must be numbers (or digital_gain sample), "
            f"seed {seed!r} and frame {frame!r} whole numbers from 0 to 2**64 - 1, "
            f"noise {noise!r} and convention {convention!r} texts, highlights "
            f"{highlights!r}, effects {effects!r}, color_effects {color_effects!r} and "
            f"camera_input {camera_input!r} True or False, and as_shot {as_shot!r} "
            "three numbers"
        ) from None


def illuminant_word(illuminant: Light, sensor: str) -> str:
    """Return the word of the grammar that names an illuminant, exactly."""
    if isinstance(illuminant, str):
        return illuminant
    if not isinstance(illuminant, _core.Illuminant):
        raise ValueError(
            f"illuminant {illuminant!r} must be one word or an Illuminant; the words: "
            f"{_core.illuminant_grammar}"
        )
    if illuminant.sensor != sensor:
        raise ValueError(
            f"{illuminant!r} is as {illuminant.sensor} sees it, not {sensor}: give the "
            f"word {illuminant.spec!r}, or the illuminant of {sensor}"
        )
    red, _, blue = illuminant.neutral
    return f"neutral:{red!r}:{blue!r}"
