# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""A capture set as a folder: captures.yaml, DNGs, renders, the sealed truth."""

import hashlib
import io
import json
import os
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from cg2raw import Sensor, write_dng
from cg2raw.interrupts import scratch_folder
from cg2raw.io.atomic_file import write_folder
from cg2raw.synthetic import conditions
from cg2raw.synthetic.synthetic_camera import Shot, SyntheticCamera

MANIFEST, TRUTH, SENSOR = "captures.yaml", "truth.json", "sensor.json"


class Folder:
    """The files of a capture set, made one at a time as they are asked for.

    sensor : the doubted model. sensor_name : what captures.yaml says of it: an id, or
    SENSOR, which is then written too. The DNGs say nothing of noise or effects."""

    def __init__(
        self,
        source: SyntheticCamera,
        shots: Sequence[Shot],
        sensor: Sensor,
        sensor_name: str,
        illuminant: str,
        iso: float,
    ) -> None:
        self.source, self.shots, self.sensor = source, shots, sensor
        self.sensor_name, self.illuminant, self.iso = sensor_name, illuminant, iso
        self.truth = self._truth()
        self.seal = hashlib.sha256(self.truth).hexdigest()

    def items(self) -> Iterator[tuple[str, bytes]]:
        """Yield names and contents of the files."""
        yield MANIFEST, self._manifest().encode()
        yield TRUTH, self.truth
        if self.sensor_name == SENSOR:
            yield SENSOR, self.sensor.to_json().encode()
        for shot in self.shots:
            if shot.kind == "scene" and shot.repeat == 0:
                buffer = io.BytesIO()
                np.save(buffer, self.source.render(shot))
                yield f"{shot.set}.npy", buffer.getvalue()
            yield f"{shot.name}.dng", self._dng(shot)

    def _truth(self) -> bytes:
        """Return what was hidden, for after the verdict."""
        camera = self.source.camera
        truth = {
            "hidden": self.source.hidden,
            "nuisances": self.source.nuisances,
            "seed": self.source.seed,
            "sensor": self.sensor.id,
            "illuminant": self.illuminant,
            "iso": self.iso,
            "full_well_electrons": camera.full_well.tolist(),
            "read_noise_electrons": camera.read_noise.tolist(),
        }
        return (json.dumps(truth, indent=2) + "\n").encode()

    def _manifest(self) -> str:
        declared = sorted(conditions.declared(self.source.nuisances))
        bounds = conditions.uncertainty(self.source.nuisances)
        lines = [
            f"# What is hidden in these frames: {TRUTH}, sha256 {self.seal}",
            f"sensor: {self.sensor_name}",
            f"iso: {self.iso:g}",
            f"illuminant: {self.illuminant}",
            "frames:",
            *(f"  - {{{self._entry(shot)}}}" for shot in self.shots),
        ]
        if declared:
            lines.append(f"nuisance: [{', '.join(declared)}]")
        if bounds:
            inner = ", ".join(f"{name}: {value:g}" for name, value in bounds.items())
            lines.append(f"uncertainty: {{{inner}}}")
        return "\n".join(lines) + "\n"

    def _entry(self, shot: Shot) -> str:
        fields = {"file": f"{shot.name}.dng", "kind": shot.kind}
        if shot.kind == "flat":
            red, green, blue = self.source.render(shot).tolist()
            fields["scene"] = f"[{red!r}, {green!r}, {blue!r}]"
        if shot.kind == "scene":
            fields["scene"] = f"{shot.set}.npy"
        fields["set"] = shot.set
        fields["group"] = shot.group
        fields["exposure_time"] = f"{shot.seconds:.6f}"
        return ", ".join(f"{name}: {value}" for name, value in fields.items())

    def _dng(self, shot: Shot) -> bytes:
        with scratch_folder("cg2raw.") as folder:
            path = os.path.join(folder, f"{shot.name}.dng")
            write_dng(
                path,
                self.source.raw(shot),
                sensor=self.sensor,
                illuminant=self.illuminant,
                iso=self.iso,
                effects=False,
                preview=False,
                shot={"exposure_time": shot.seconds},
            )
            return Path(path).read_bytes()


def write_captures(path: str | os.PathLike[str], folder: Folder) -> None:
    """Write a folder, all of it or nothing; one of an earlier run is replaced.

    Raises ValueError if it holds other files, OSError."""
    ours = (MANIFEST, TRUTH, SENSOR)

    def is_ours(name: str) -> bool:
        return name in ours or name.startswith(("fit_", "select_", "report_"))

    write_folder(os.fspath(path), folder, is_ours)
