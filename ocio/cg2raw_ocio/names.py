# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What the spaces of a config are called, by sensor and illuminant."""

from cg2raw import _core

SCENE_LINEAR = "Linear Rec.709 (sRGB)"
RAW_FAMILY = "RAW"
# The space of a sensor and a light that the environment chooses. A file cannot say
# which: they have no interop ID.
CONTEXT = ("RAW - context", "raw_context", "")
CONTEXT_UNBOUNDED = ("RAW unbounded - context", "raw_unbounded_context", "")
SENSOR_VARIABLE, ILLUMINANT_VARIABLE = "CG2RAW_SENSOR", "CG2RAW_ILLUMINANT"


def raw_space(sensor: str, illuminant: str) -> tuple[str, str, str]:
    """Return (name, alias, interop ID) of a sensor's RAW under an illuminant, as the
    plugin reads them."""
    return (
        _core.raw_space_name(sensor, illuminant),
        _core.raw_space_alias(sensor, illuminant),
        _core.raw_space_interop_id(sensor, illuminant),
    )


def unbounded_space(sensor: str, illuminant: str) -> tuple[str, str, str]:
    """Return what raw_space does of its twin that never clips."""
    name, alias, interop_id = raw_space(sensor, illuminant)
    return (
        name.replace("RAW - ", "RAW unbounded - ", 1),
        alias.replace("raw_", "raw_unbounded_", 1),
        interop_id.replace(":raw_", ":raw_unbounded_", 1),
    )


def table_file(sensor: str, illuminant: str) -> str:
    """Return the name of the file that holds the chain of a RAW space with a table: one
    that all file systems allow."""
    return f"{raw_space(sensor, illuminant)[1]}.ctf"


def family(profile: _core.SensorProfile) -> str:
    """Return "RAW/<make>": "NIKON CORPORATION" is Nikon in a menu."""
    make = (profile.make.split() or ["Other"])[0].replace("/", " ")
    if make.isupper() or make.islower():
        make = make.capitalize()
    return f"{RAW_FAMILY}/{make}"
