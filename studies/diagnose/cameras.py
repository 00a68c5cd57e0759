# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Cameras: real frames of which it is known what they show.

    ./studies/run diagnose cameras --data FOLDER

frozen/cameras.json says, per set, the files below FOLDER, the profile of a header, the
names that frames of that kind can show, and values with their standard errors, as of
by_hand.py. Sets whose files are absent are left out, and said to be."""

import json
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from cg2raw import Sensor
from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.captures.reader import read_captures, read_frames
from cg2raw.synthetic.synthetic_camera import stream
from studies.diagnose.real import calibrated_by, uniform
from studies.diagnose.real_frames import Shot, shots
from studies.places import ROOT

FILE = Path(__file__).with_name("frozen") / "cameras.json"
BY_HAND = FILE.with_name("by_hand.json")
BUILD = ROOT / "build" / "diagnose_cameras"
ISO = 100
# Names of by_hand.py whose value is a sd in DN, and the effects that have it.
SPREADS = {
    "row_noise": "row_noise",
    "column_fixed_pattern": "column_fixed_pattern",
    "dsnu": "dsnu",
    "drift": "black_level_drift",
}


def sets() -> dict[str, dict[str, Any]]:
    """Return name -> what the file says of a set."""
    found: dict[str, dict[str, Any]] = json.loads(FILE.read_text())
    return found


@dataclass(frozen=True)
class CameraCase:
    """Real frames of one camera. number : of the set in the file. strengths : of the
    names that are expected, none of which is known. data : folder of real frames."""

    suite: str
    number: int
    seed: int
    strengths: dict[str, float | None]
    name: str
    data: Path
    without: tuple[str, ...] = ()

    def captures(self) -> tuple[CaptureSet, dict[str, dict[str, float]]]:
        """Return the frames with the profile that is doubted."""
        said = sets()[self.name]
        found = read_captures(manifest(self.name, self.data))
        if "calibrated_by" in said:
            sensor = _calibrated(manifest(said["calibrated_by"], self.data))
            found = replace(found, sensor=sensor)
        return found, {}

    def evidence(self, _: object) -> dict[str, float]:
        """Nobody knows the density of real frames."""
        return {}

    def expected(self) -> dict[str, dict[str, float]]:
        """Return the values that were measured by hand, in the registry's units."""
        said = sets()[self.name]
        if said["values"] == "by_hand":
            table = json.loads(BY_HAND.read_text())
            values = {name: one["value"] for name, one in table.items()}
        else:
            values = {name: pair[0] for name, pair in said["values"].items()}
        return in_registry(values, said["profile"]) if values else {}


def cameras(data: Path) -> tuple[list[CameraCase], list[str]]:
    """Return (the sets whose files are there, sentences on those that are not)."""
    found, absent = [], []
    for number, (name, said) in enumerate(sets().items()):
        files = said.get("frames") or said["chart"]
        if not any(data.glob(files)):
            absent.append(f"{name}: left out, {data} has no {files}")
            continue
        names = dict.fromkeys(said["names"])
        found.append(CameraCase("cameras", number, 0, names, name, data))
    return found, absent


def in_registry(
    values: Mapping[str, float], profile: Mapping[str, Any]
) -> dict[str, dict[str, float]]:
    """Return effect -> parameter -> value, of figures as by_hand.py has them."""
    reach = 2 ** profile["bits"] - 1 - profile["black"]
    found = {
        effect: {"sigma": values[name] / reach}
        for name, effect in SPREADS.items()
        if name in values
    }
    if "read_noise" in values:
        ratio = values["read_noise"] / profile["read_noise"]
        found["read_noise"] = {"log_variance": 2 * math.log(ratio)}
    if "gain" in values:
        ratio = profile["electrons_per_dn"] / values["gain"]
        found["shot_noise"] = {"log_gain": math.log(ratio)}
    if "dark_current" in values:
        found["dark_current"] = {"per_second": values["dark_current"] / reach}
    if "prnu" in values:
        found["prnu"] = {"sigma": values["prnu"]}
    if "correlation" in values:
        found["read_noise_correlation"] = {"coefficient": values["correlation"]}
    return found


def chosen(said: Mapping[str, Any], data: Path) -> list[Shot]:
    """Return the frames of a set: all, those of some exposure times, or a draw."""
    found = shots(data, said["frames"], said.get("kind"))
    if "seconds" in said:
        found = [shot for shot in found if shot.seconds in said["seconds"]]
    if "unsaturated" in said:
        white = 2 ** said["profile"]["bits"] - 1
        found = [shot for shot in found if np.median(shot.frame) < white]
    if "draw" in said:
        count, seed = said["draw"]
        drawn = stream(seed, "draw").permutation(len(found))[:count]
        found = [found[n] for n in sorted(drawn)]
    return found


def manifest(name: str, data: Path) -> Path:
    """Write a captures.yaml and its profile into the build folder; return its path."""
    said = sets()[name]
    folder = BUILD / f"set-{name}"
    folder.mkdir(parents=True, exist_ok=True)
    if "chart" in said:
        file = str((data / said["chart"]).resolve())
        chart = {"file": file, "kind": "chart", "chart": "colorchecker"}
        frames: list[dict[str, Any]] = [chart | {"corners": said["corners"]}]
        top: dict[str, Any] = {"sensor": file, "nuisance": ["exposure", "radiance"]}
    else:
        (folder / "sensor.json").write_text(json.dumps(_profile(name, said["profile"])))
        top = {"sensor": "sensor.json", "iso": ISO}
        if "cfa" in said["profile"]:
            top["illuminant"] = "D65"
        frames = [_entry(shot) for shot in chosen(said, data)]
    path = folder / "captures.yaml"
    path.write_text(yaml.safe_dump(top | {"frames": frames}, sort_keys=False))
    return path


def _entry(shot: Shot) -> dict[str, Any]:
    entry: dict[str, Any] = {"file": str(_file(shot)), "kind": shot.kind}
    known = {
        "exposure_time": shot.seconds,
        "temperature": shot.temperature,
        "scene": "unknown" if shot.kind == "flat" else None,
    }
    return entry | {key: value for key, value in known.items() if value is not None}


def _file(shot: Shot) -> Path:
    """Return a file of one frame, written for those of an .npz: a manifest has each
    file once."""
    if shot.image is None:
        return shot.path.resolve()
    path = BUILD / shot.path.parent.name / f"{shot.image}.npy"
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists():
        np.save(path, shot.frame)
    return path


def _profile(name: str, said: Mapping[str, Any]) -> dict[str, Any]:
    white = 2 ** said["bits"] - 1
    reach, cfa = white - said["black"], said.get("cfa", "MONO")
    electrons, read = said["electrons_per_dn"], said["read_noise"]
    sites = 1 if cfa == "MONO" else 4
    noise = {
        "iso": ISO,
        "beta1": [1 / (electrons * reach)] * sites,
        "beta2": [(read / reach) ** 2] * sites,
    }
    found = {
        "schema": 1,
        "id": name,
        "make": "Real",
        "model": name,
        "unique_camera_model": f"Real {name}",
        "sources": {"noise": "header"},
        "cfa": cfa,
        "width": said["size"][0],
        "height": said["size"][1],
        "bits": said["bits"],
        "black_level": [said["black"]] * sites,
        "white_level": white,
        "noise": [noise],
    }
    if sites == 4:  # darks have no colours
        base: dict[str, Any] = json.loads(Sensor("canon-70d").to_json())
        return base | found
    return found


def _calibrated(path: Path) -> Sensor:
    _, sensor, frames, _ = read_frames(path)
    return calibrated_by(sensor, [uniform(frame.capture) for frame in frames])
