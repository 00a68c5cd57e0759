# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What is run under the injector: each command on small inputs, and what it writes.

A target works in a folder: in/ has what it reads, out/ what it writes."""

import contextlib
import json
import shutil
import sys
from pathlib import Path

from conftest import OIIOTOOLS

LIGHT = ("--sensor", "samsung-s20fe", "--illuminant", "D65")
OLD = b"what was there before"


def empty(folder):
    """Remove all that is in a folder."""
    shutil.rmtree(folder)
    folder.mkdir()


def write_files(folder, files):
    """Make a folder of files, {name: bytes}."""
    folder.mkdir()
    for name, data in files.items():
        (folder / name).write_bytes(data)


class Target:
    """A command line of cg2raw, which forked.py runs.

    outputs : names in out/, which are old files before, or not there."""

    is_program = False
    calls = 10**9  # that are worth trying
    name: str
    outputs: tuple[str, ...] = ()

    def prepare(self, folder):
        """Write what the target reads into folder/in; needs no injector."""

    def words(self, folder):
        """Return the command line."""
        raise NotImplementedError

    def run(self, folder):
        """Run it in this process; return the exit code."""
        from cg2raw.cli import main

        sys.argv = ["cg2raw", *map(str, self.words(Path(folder)))]
        return main(sys.argv[1:])

    def load(self, folder):
        """Do before all runs what none of them needs to do."""

    def begin(self, folder, exists):
        """Put what is there before into folder/out, which is empty."""
        for name in self.outputs if exists else ():
            (folder / "out" / name).write_bytes(OLD)
            (folder / "out" / name).chmod(0o666)  # more than a new one gets: it is kept


def images(folder, count=1, size=(64, 96)):
    """Write EXRs shot.1.exr ..."""
    from dataset.data_sets import scene, write_image

    for number in range(1, count + 1):
        write_image(folder / f"in/shot.{number}.exr", scene(size, number))


class Convert(Target):
    """One image."""

    name, outputs = "convert", ("shot.dng",)

    def prepare(self, folder):
        images(folder)

    def words(self, folder):
        source, target = folder / "in/shot.1.exr", folder / "out/shot.dng"
        return ("convert", source, "-o", target, *LIGHT, "--iso", 400)


class Sequence(Target):
    """Frames of a shot, one after the other."""

    name, outputs = "sequence", tuple(f"shot.{number}.dng" for number in (1, 2, 3))

    def prepare(self, folder):
        images(folder, 3)

    def words(self, folder):
        shot = ("--framerate", 24, "--workers", 1)
        pattern = folder / "in/shot.#.exr"
        return ("convert", pattern, "-o", folder / "out", *LIGHT, *shot)


class DataSet(Target):
    """Two images, of two files each; what fails is gone on with."""

    name = "dataset"

    def prepare(self, folder):
        images(folder, 2)

    def words(self, folder):
        which = ("--sensors", "nikon-d40", "--illuminants", "2", "--workers", 1)
        return ("dataset", folder / "in", folder / "out", *which)


class Profile(Target):
    """Of a DNG."""

    name, outputs = "profile", ("camera.json",)

    def prepare(self, folder):
        from python.commands import write_dng

        write_dng(folder / "in/shot.dng", profile="samsung-s20fe", iso=400)

    def words(self, folder):
        return ("profile", folder / "in/shot.dng", "-o", folder / "out/camera.json")


class Ocio(Target):
    """A config with files beside it."""

    name, outputs = "ocio", ("config.ocio",)

    def words(self, folder):
        pairs = ("--sensors", "nikon-d40", "--illuminants", "A,D65", "--context")
        return ("ocio", *pairs, "-o", folder / "out/config.ocio")

    def begin(self, folder, exists):
        super().begin(folder, exists)
        if exists:
            write_files(folder / "out/config_raw", {"old.ctf": OLD})


class Calibrate(Target):
    """Darks and flats are read and measured; what is slow is made up."""

    name, outputs = "calibrate", ("camera.json",)

    def prepare(self, folder):
        import numpy as np

        from calibration.planted import frames_of, sensor_of

        sensor = sensor_of(shape=(48, 64))
        (folder / "in/my.json").write_text(sensor.to_json())
        for frame in frames_of(sensor, biases=3, darks=3, flats=3):
            np.save(folder / f"in/{frame.name}.npy", frame.pixels())
        lines = [f"{kind}-{n}" for n, kind in enumerate(["dark"] * 6 + ["flat"] * 3)]
        times = [0, 0, 0, 30, 30, 30, 1, 1, 1]
        rows = [f"{a},{b},20.0" for a, b in zip(lines, times, strict=True)]
        table = "\n".join(["frame,exposure_s,temperature_c", *rows])
        (folder / "in/frames.csv").write_text(table + "\n")

    def load(self, folder):
        """Fit the law of dark current once, and draw no page: that would be all but a
        fraction of the 3 s of a run, and makes no call that is to fail."""
        from cg2raw.calibration import darks, report

        law, found = darks.dark_spread, {}

        def dark_spread(rates, gain):
            if not found:
                found["law"] = law(rates, gain)
            return found["law"]

        darks.dark_spread = dark_spread
        report.page_of = lambda measured: None
        report.html_of = lambda page: "<h1>" * 4000
        with contextlib.redirect_stdout(sys.stderr):
            self.run(folder)  # which the forks then have
        empty(Path(folder) / "out")

    def begin(self, folder, exists):
        super().begin(folder, exists)
        if exists:
            write_files(folder / "out/report", {"calibration.html": OLD})

    def words(self, folder):
        frames = sorted((folder / "in").glob("*-?.npy"))
        table = (
            "--frames",
            folder / "in/frames.csv",
            "--sensor",
            folder / "in/my.json",
        )
        out = ("-o", folder / "out/camera.json", "--report", folder / "out/report")
        return ("calibrate", *frames, "--iso", 100, *table, *out)


class Diagnose(Target):
    """A report of a diagnosis that is made up; its captures are read."""

    name = "diagnose"

    def prepare(self, folder):
        from diagnose import capture_files

        capture_files.standard_set(folder / "in", 3)

    def load(self, folder):
        """Draw the report once, and let all runs write that one."""
        from cg2raw.diagnose import pipeline, report
        from diagnose.made_up_diagnosis import made_up_diagnosis

        drawn = {"report.html": b"<h1>" * 4000, "gap.png": bytes(range(256)) * 300}

        pipeline.diagnose = lambda captures, **options: made_up_diagnosis()
        report.write_report = lambda found, path: write_files(path, drawn)

    def begin(self, folder, exists):
        if exists:
            said = json.dumps({"files": ["old.html"]}).encode()
            old = {"verdict.json": said, "old.html": OLD}
            write_files(folder / "out/report", old)

    def words(self, folder):
        return ("diagnose", folder / "in/captures.yaml", "-o", folder / "out/report")


class WriteDng(Target):
    """The function, in a process that is not the command."""

    name, outputs = "write_dng", ("shot.dng",)

    def load(self, folder):
        import numpy as np

        import cg2raw

        scene = np.random.default_rng(1).random((200, 300, 3), np.float32)
        self.frame = cg2raw.Sensor("nikon-d40").simulate(scene, illuminant="D65")

    def run(self, folder):
        import cg2raw

        try:
            cg2raw.write_dng(Path(folder) / "out/shot.dng", self.frame, threads=2)
        except (ValueError, OSError, MemoryError) as error:
            print(error, file=sys.stderr)
            return 1
        return 0


class Oiiotool(Target):
    """A program, of either OpenImageIO."""

    is_program, outputs = True, ("shot.dng",)

    def __init__(self, name):
        self.name = name
        self.tool, self.plugins = OIIOTOOLS[name]

    def prepare(self, folder):
        images(folder)

    def words(self, folder):
        said = {
            "sensor": "samsung-s20fe",
            "illuminant": "D65",
            "iso": "400",
            "frame": "1",
        }
        pairs = [w for k, v in said.items() for w in ("--attrib", f"dng:{k}", v)]
        source, target = folder / "in/shot.1.exr", folder / "out/shot.dng"
        return (self.tool, source, *pairs, "-o", target)


FOUND = [
    *(Oiiotool(name) for name in OIIOTOOLS),
    *(kind() for kind in (Convert, Sequence, DataSet, Profile, Ocio, Calibrate)),
    *(kind() for kind in (Diagnose, WriteDng)),
]
TARGETS = {target.name: target for target in FOUND}
