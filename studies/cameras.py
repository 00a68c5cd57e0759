# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The cameras of the studies: sensors whose spectral sensitivities were measured."""

import csv
import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

import cg2raw
from cg2raw.profile.neutral_mixture import without_neutrals
from cg2raw.profile.spectral import profile_from_ssf, spectral_field
from cg2raw.profile.spectral_file import Sensitivities, read_sensitivities
from studies.world.colorimetry import Array
from studies.world.shots import GreyCards, neutrals

ACADEMY = "tables/ssf/rawtoaces-data/data/camera/"
CARDS = "tables/illuminants/nus9_gt_illuminants.csv"
FILES = {  # of sensitivities, below the folder of camera data
    "canon-600d": ACADEMY + "Canon_EOS_600D_380_780_5.json",
    "nikon-d40": "tables/ssf/ssf-data/Nikon/D40/camspec/Nikon_D40.csv",
    "canon-1ds-mark-iii": ACADEMY + "Canon_EOS-1Ds_Mark_III_380_780_5.json",
    "sony-a7s-ii": ACADEMY + "Sony_ILCE-7SM2_380_780_5.json",
    "nikon-d850": ACADEMY + "Nikon_D850_380_780_5.json",
    "canon-5d-mark-iv": ACADEMY + "Canon_EOS_5D_Mark_IV_380_780_5.json",
}
NUS = {  # those with grey cards, as the table calls them
    "canon-600d": "Canon600D",
    "nikon-d40": "NikonD40",
    "canon-1ds-mark-iii": "Canon1DsMkIII",
}
LENDER = "canon-600d"  # whose grey cards stand for those of cameras without


@dataclass(frozen=True)
class Camera:
    """A sensor as users have it, and what the studies know besides."""

    id: str
    sensor: cg2raw.Sensor  # matrices as published
    measured: Sensitivities
    cards: GreyCards  # of its own, or of LENDER

    @property
    def sensitivities(self) -> Array:
        """Sensitivities (81, 3) to radiant energy, peak 1."""
        return self.measured.rgb

    def neutrals(self, powers: Array) -> Array:
        """Return (n, 3), G = 1, of lights (n, 81)."""
        return neutrals(powers, self.sensitivities)

    def told(self, found: Array) -> cg2raw.Sensor:
        """Return the sensor whose lights are drawn from neutrals (n, 3), as found in
        training captures."""
        ratios = found[:, [0, 2]].round(6).tolist()
        return self.with_illuminants({"neutrals": ratios})

    def told_mixture(self, found: Array) -> cg2raw.Sensor:
        """Return the sensor as bundled profiles have it: what stands for neutrals
        (n, 3) is their mean, covariance, hull and mixture of Gaussians."""
        return self.with_illuminants(without_neutrals(self.told(found).illuminants))

    def with_illuminants(self, illuminants: Mapping[str, Any]) -> cg2raw.Sensor:
        """Return the sensor with that field of a profile."""
        profile = json.loads(self.sensor.to_json())
        profile["illuminants"] = illuminants
        return cg2raw.Sensor.from_json(json.dumps(profile), self.id)

    def with_sensitivities(self) -> cg2raw.Sensor:
        """Return the sensor for convention spectral: sensitivities added."""
        profile = json.loads(self.sensor.to_json())
        profile["spectral_sensitivities"] = spectral_field(self.measured)
        return cg2raw.Sensor.from_json(json.dumps(profile), self.id)

    def fitted(self) -> cg2raw.Sensor:
        """Return a sensor whose matrices are fitted to the measured sensitivities."""
        body = self.sensor
        profile = profile_from_ssf(
            self.measured,
            cfa=body.cfa,
            width=body.width,
            height=body.height,
            bits=body.bits,
            black_level=body.black_level,
            white_level=body.white_level,
            make=body.make,
            model=body.model,
        )
        return cg2raw.Sensor.from_json(json.dumps(profile), self.id)


def known_camera(name: str, data: Path) -> Camera:
    """Return one of FILES. Raises ValueError for another name or a missing file."""
    if name not in FILES:
        raise ValueError(f"camera {name} must be one of {', '.join(FILES)}")
    measured = read_sensitivities(data / FILES[name])
    lender = name if name in NUS else LENDER
    return Camera(name, cg2raw.Sensor(name), measured, grey_cards(lender, data))


def own_camera(ssf: Path, profile: Path, data: Path) -> Camera:
    """Return a user's camera. Raises ValueError naming file and field."""
    sensor = cg2raw.Sensor(profile)
    cards = grey_cards(LENDER, data)
    return Camera(sensor.id, sensor, read_sensitivities(ssf), cards)


@cache
def grey_cards(name: str, data: Path) -> GreyCards:
    """Return the GreyCards of one of NUS. Raises ValueError without the table."""
    try:
        with open(data / CARDS, newline="") as file:
            rows = [row for row in csv.DictReader(file) if row["camera"] == NUS[name]]
    except OSError as error:
        raise ValueError(f"{error.filename}: {error.strerror}") from None
    rgb = np.array([[float(row[channel]) for channel in "rgb"] for row in rows])
    sensitivities = read_sensitivities(data / FILES[name]).rgb
    return GreyCards(rgb / rgb[:, 1:2], sensitivities)
