# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""The public names of cg2raw, whose __init__.py loads them when one is asked for."""

from cg2raw._core import (
    DngMetadata,
    Illuminant,
    SensorProfile,
    Simulation,
    __version__,
    effects,
    illuminant_grammar,
    illuminant_list,
    installed_profiles,
    philox_words,
    planckian_xy,
    profile_folders,
    raw_space_alias,
    raw_space_from_name,
    raw_space_name,
    temperature_from_xy,
)
from cg2raw.cfa import demosaic, mosaic
from cg2raw.dng import read_dng_metadata, write_dng
from cg2raw.exposure import Run
from cg2raw.oiio.registration import register_oiio_plugin
from cg2raw.raw_frame import RawFrame
from cg2raw.sensor import Sensor
from cg2raw.upi import Upi

__all__ = [
    "DngMetadata",
    "Illuminant",
    "RawFrame",
    "Run",
    "Sensor",
    "SensorProfile",
    "Simulation",
    "Upi",
    "__version__",
    "demosaic",
    "effects",
    "illuminant_grammar",
    "illuminant_list",
    "installed_profiles",
    "mosaic",
    "philox_words",
    "planckian_xy",
    "profile_folders",
    "raw_space_alias",
    "raw_space_from_name",
    "raw_space_name",
    "read_dng_metadata",
    "register_oiio_plugin",
    "temperature_from_xy",
    "write_dng",
]
