# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The profiles that a data set keeps in dataset.json, each checked by its SHA-256."""

import hashlib
import json
import os
from collections.abc import Callable, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Any

from cg2raw import _core
from cg2raw.sensor import Sensor
from cg2raw.system import has_folder

PLAN = "dataset.json"


def sensor_of(folder: str | os.PathLike[str], row: Mapping[str, Any]) -> Sensor:
    """Return the Sensor by which a file of a data set was made, as the data set keeps
    its profile: also one of your own, on any machine.

    folder : the data set. row : of its manifest. For method upi it is the sensor from
    which cg2raw.Upi draws.
    Raises ValueError if dataset.json has no such profile or another one, OSError."""
    path = os.path.join(os.fspath(folder), PLAN)
    status = os.stat(path)
    sensor, sha256 = kept_sensor(
        path, row["sensor"], status.st_mtime_ns, status.st_size
    )
    if sha256 != row["profile_sha256"]:
        raise ValueError(
            f"{path}: the SHA-256 of its profile of {sensor.id}, {sha256}, is not the "
            f"row's, {row['profile_sha256']}: they are of two data sets"
        )
    return sensor


@lru_cache(maxsize=64)
def kept_sensor(path: str, id: str, *stamp: int) -> tuple[Sensor, str]:
    """Return (Sensor, SHA-256 of its JSON text) of a dataset.json.

    stamp : time and size of the file, to know whether it has changed."""
    found = plan_fields(path)
    if id not in found["profiles"]:
        raise ValueError(
            f"{path}: keeps no profile of {id}; {', '.join(found['profiles'])}"
        )
    text = checked(path, id, found)
    return Sensor.from_json(text, id), sha256_of(text)


def load_or_kept(
    word: str, folder: str, tell: Callable[[str], None]
) -> _core.SensorProfile:
    """Return the profile of an id or path; of one that is not there, the profile of
    that id or file name that the data set in @folder keeps, so that it can be resumed.

    tell : called with a sentence if a kept profile stands in for a file.
    Raises ValueError."""
    is_path = has_folder(word) or word.endswith(".json")
    plan = os.path.join(folder, PLAN)
    known = os.path.exists(word) if is_path else word in _core.installed_profiles()
    if known or not os.path.exists(plan):
        return _core.load_profile(word)
    found = plan_fields(plan)
    kept = found["profiles"]
    id = Path(word).stem if is_path else word
    if id in kept:
        if is_path:
            tell(f"{word} is not there: {plan} keeps the profile of {id}, used instead")
        return Sensor.from_json(checked(plan, id, found), id).profile
    try:
        return _core.load_profile(word)
    except ValueError as error:
        raise ValueError(
            f"{error}; {plan} keeps {', '.join(kept)}: name it by that"
        ) from None


def plan_fields(path: str) -> dict[str, Any]:
    """Return the object in a dataset.json. Raises ValueError, OSError."""
    try:
        with open(path, encoding="utf-8") as stream:
            found = json.load(stream)
        if all(isinstance(found[name], dict) for name in ("profiles", *hashes(found))):
            return dict(found)
    except (ValueError, KeyError, TypeError):
        pass
    raise ValueError(f"{path}: is damaged")


def hashes(found: Mapping[str, Any]) -> list[str]:
    """Return the field of a dataset.json that has SHA-256s; older ones have none."""
    return [name for name in found if name == "profile_sha256"]


def checked(path: str, id: str, found: Mapping[str, Any]) -> str:
    """Return the JSON text of a profile of dataset.json, as Sensor.to_json gives it.

    Raises ValueError if it is not the one whose SHA-256 is beside it."""
    text: str = Sensor.from_json(json.dumps(found["profiles"][id]), id).to_json()
    said = found.get("profile_sha256", {}).get(id)
    if said not in (None, sha256_of(text)):
        raise ValueError(
            f"{path}: the profile of {id} has another SHA-256 than when the data set "
            "was begun: undo the change, or give another OUT"
        )
    return text


def sha256_of(text: str) -> str:
    """Return the SHA-256 of a profile's JSON text, in hexadecimal."""
    return hashlib.sha256(text.encode()).hexdigest()
