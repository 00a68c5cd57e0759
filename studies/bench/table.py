# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""One table of what is fast and what is not, with peers in the same run: oiiotool
writing a TIFF, NumPy, tifffile, and PiDNG where it is installed.

Rounds run every row of a group once; what counts is the median. A ratio is against the
group's peer. CPU seconds hardly depend on what else the machine does, seconds do."""

import json
import os
import platform
import statistics
import subprocess
import sys
import time
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from functools import partial

import numpy as np

from studies.bench import processes, uniform
from studies.bench.dataset import paper_arguments, paper_raw, paper_raw_at_best
from studies.bench.peers import writers
from studies.bench.processes import FLOOR, FOLDER, HEIGHT, OIIOTOOLS, WIDTH

SENSOR, LIGHT, ISO = "samsung-s20fe", "2856K", 3200
SIZES = (1, 3, 12, 48)  # MP
READ = """
import sys, OpenImageIO as oiio
file = oiio.ImageInput.open(sys.argv[1])
file.read_image(0, 0, 0, 3, sys.argv[2])
"""


@dataclass
class Row:
    """One line of the table; None does not apply. ratio : of seconds, cpu_ratio : of
    CPU seconds, to the group's peer."""

    group: str
    name: str
    seconds: float
    cpu_seconds: float
    megapixels: float
    peak_mb: float | None = None
    file_mb: float | None = None
    ratio: float | None = None
    cpu_ratio: float | None = None


def timed(action):
    """Return (seconds, CPU seconds) of a call, all threads of this process."""
    wall, cpu = time.perf_counter(), time.process_time()
    action()
    return time.perf_counter() - wall, time.process_time() - cpu


def rows_of(group, results, megapixels, peer=None):
    """Return Rows of {name: [(seconds, CPU seconds, peak MB, file MB)]}.

    megapixels : of each name, or of all. peer : the name that all are compared with, or
    what gives it for a name."""
    medians = {
        name: [statistics.median(column) for column in zip(*values, strict=True)]
        for name, values in results.items()
    }
    rows = []
    for name, (seconds, cpu, *more) in medians.items():
        peak, size = more or (None, None)
        count = megapixels[name] if isinstance(megapixels, dict) else megapixels
        row = Row(group, name, seconds, cpu, count, peak, size)
        if peer:
            other = medians[peer(name) if callable(peer) else peer]
            row.ratio = seconds / other[0]
            row.cpu_ratio = cpu / other[1]
        rows.append(row)
    return rows


def in_rounds(actions, rounds, measure=timed):
    """Return {name: [measure(action)]}, after one round that warms caches."""
    results = {name: [] for name in actions}
    for number in range(rounds + 1):
        for name, action in actions.items():
            found = measure(action)
            if number:
                results[name].append(found)
    return results


def scene_of(megapixels):
    """Return (H, W, 3) float16, 4:3, without a pattern."""
    height = round((megapixels * 1e6 * 3 / 4) ** 0.5) // 2 * 2
    shape = (height, height * 4 // 3 // 2 * 2, 3)
    return np.random.default_rng(1).random(shape, dtype=np.float32).astype(np.float16)


def hosts(rounds):
    """Return Rows of whole oiiotool processes."""
    rows = []
    for oiiotool in OIIOTOOLS:
        found = processes.process_results(oiiotool, rounds)
        results = {
            name: [(seconds, cpu, peak, size) for seconds, peak, cpu, size in values]
            for name, values in found.items()
        }
        group = f"oiiotool {processes.version_of(oiiotool)}"
        rows += rows_of(group, results, WIDTH * HEIGHT / 1e6, processes.peer_command)
    return rows


def conversions(rounds):
    """Return Rows of cg2raw convert, against reading the EXR alone."""
    source = processes.input_image(OIIOTOOLS[1])
    base = [sys.executable, "-m", "cg2raw", "convert", source, "--quiet"]
    base += ["-o", FOLDER / "out.dng", "--sensor", SENSOR, "--illuminant", LIGHT]
    commands = {
        "read, float (peer)": [sys.executable, "-c", READ, source, "float"],
        "read, half": [sys.executable, "-c", READ, source, "half"],
        "start": [sys.executable, "-c", "import OpenImageIO, cg2raw; cg2raw.Sensor"],
        "convert, none": [*base, "--compression", "none"],
        "convert, ljpeg": base,
        f"convert, ljpeg, ISO {ISO}": [*base, "--iso", str(ISO)],
    }

    def measure(command):
        seconds, peak, cpu = processes.measured(command)
        return seconds, cpu, peak, 0.0

    results = in_rounds(commands, rounds, measure)
    group = "cg2raw convert"
    return rows_of(group, results, WIDTH * HEIGHT / 1e6, "read, float (peer)")


def simulations(rounds):
    """Return Rows of scene -> RAW in memory, one thread, against NumPy."""
    import cg2raw

    sensor, scene = cg2raw.Sensor(SENSOR), scene_of(12)
    arguments, wide = paper_arguments(), scene.astype(np.float32)
    signal = np.ascontiguousarray(wide[..., 1])  # of a mosaic

    def simulated(**run):
        return lambda: sensor.simulate(scene, illuminant=LIGHT, threads=1, **run)

    peer = "NumPy, at its best (peer)"
    actions = {
        peer: lambda: paper_raw_at_best(wide, *arguments),
        "NumPy, paper's way": lambda: paper_raw(wide, *arguments),
        "simulate": simulated(),
        f"simulate, ISO {ISO}": simulated(iso=ISO),
        "simulate, paper": simulated(convention="paper"),
        f"noise alone, ISO {ISO}": lambda: sensor.add_noise(
            signal, iso=ISO, seed=1, threads=1
        ),
    }
    found = in_rounds(actions, rounds)
    count = scene.shape[0] * scene.shape[1] / 1e6
    return rows_of("scene to RAW, 1 thread", found, count, peer)


def files(rounds):
    """Return Rows of RAW in memory -> file, one thread, against tifffile."""
    import cg2raw

    scene = scene_of(1)
    # Smooth, so that compression has something to find: each pixel four times as wide.
    scene = scene.repeat(4, 0).repeat(4, 1)[:HEIGHT, :WIDTH]
    raw = cg2raw.Sensor(SENSOR).simulate(scene, illuminant=LIGHT, iso=100)
    actions = writers(raw, FOLDER)
    found = in_rounds({name: action for name, (action, _) in actions.items()}, rounds)
    results = {
        name: [(*value, 0.0, actions[name][1].stat().st_size / 1e6) for value in values]
        for name, values in found.items()
    }
    return rows_of("RAW to file, 1 thread", results, raw.size / 1e6, "tifffile (peer)")


def statistics_of_darks(rounds):
    """Return Rows of what darks say, one thread, against NumPy."""
    actions, megapixels, peer = uniform.actions()
    found = in_rounds(actions, rounds)
    return rows_of("statistics of darks, 1 thread", found, megapixels, peer)


def scaling(rounds):
    """Return Rows over threads and over sizes; the first of each is the peer."""
    import cg2raw

    sensor, scene = cg2raw.Sensor(SENSOR), scene_of(12)
    out = FOLDER / "scaling.dng"

    def work(image, iso, threads):
        raw = sensor.simulate(image, illuminant=LIGHT, iso=iso, threads=threads)
        cg2raw.write_dng(out, raw, threads=threads, sync=False)

    def noise(array, threads):
        sensor.add_noise(signal, iso=ISO, threads=threads, out=array)

    signal = np.ascontiguousarray(scene[..., 1], np.float32)
    megapixels = signal.size / 1e6
    scenes = {"clean": partial(work, scene, None)}
    scenes[f"ISO {ISO}"] = partial(work, scene, ISO)
    arrays = {"noise alone": None, "noise, out=": signal.copy()}
    noises = {name: partial(noise, array) for name, array in arrays.items()}
    images = {f"{size} MP": scene_of(size) for size in SIZES}
    actions = {name: partial(work, image, ISO, 0) for name, image in images.items()}
    sizes = {name: i.shape[0] * i.shape[1] / 1e6 for name, i in images.items()}
    return [
        *over_threads("threads: scene to DNG", scenes, megapixels, rounds),
        *over_threads("threads: noise", noises, megapixels, rounds),
        *rows_of("sizes: scene to DNG", in_rounds(actions, rounds), sizes),
    ]


def over_threads(table, works, megapixels, rounds):
    """Return Rows of works, {name: work(threads)}, by 1, 2, 4, ... threads; one thread
    is the peer of each."""
    cores = os.cpu_count() or 1
    counts = sorted({1, 2, *(2**n for n in range(8) if 2**n < cores), cores})
    rows = []
    for name, work in works.items():
        actions = {f"{name}, {n} threads": partial(work, n) for n in counts}
        found = in_rounds(actions, rounds)
        rows += rows_of(table, found, megapixels, next(iter(actions)))
    return rows


def about():
    """Return what the numbers depend on."""
    import cg2raw

    model = [
        line.partition(":")[2].strip()
        for line in open("/proc/cpuinfo")
        if line.startswith("model name")
    ]
    commit = subprocess.run(
        ["git", "describe", "--always", "--dirty"], capture_output=True, text=True
    )
    return {
        "date": datetime.now(UTC).strftime("%Y-%m-%d"),
        "commit": commit.stdout.strip(),
        "cg2raw": cg2raw.__version__,
        "processor": model[0] if model else platform.processor(),
        "cores": os.cpu_count(),
        "load": round(os.getloadavg()[0], 2),
        "python": platform.python_version(),
        "numpy": np.__version__,
    }


def print_rows(rows):
    """Print the table."""
    group = None
    for row in rows:
        if row.group != group:
            group = row.group
            print(
                f"\n{group:28}{'s':>8}{'ratio':>7}{'CPU s':>8}{'ratio':>7}"
                f"{'MP/s':>8}{'peak MB':>9}{'file MB':>9}"
            )
        print(
            f"{row.name:28}{row.seconds:8.3f}{number(row.ratio, '7.2f')}"
            f"{row.cpu_seconds:8.3f}{number(row.cpu_ratio, '7.2f')}"
            f"{row.megapixels / row.seconds:8.0f}{number(row.peak_mb, '9.0f')}"
            f"{number(row.file_mb, '9.1f')}"
        )


def number(value, form):
    """Return a number in a column, blank for what does not apply."""
    return format(value, form) if value else " " * int(form.partition(".")[0])


def bench(rounds, path):
    """Print one table; write it to @path as JSON, too, unless that is None."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    before = about()
    print(", ".join(f"{name} {value}" for name, value in before.items()))
    rows = []
    for measure in (
        hosts,
        conversions,
        simulations,
        files,
        statistics_of_darks,
        scaling,
    ):
        found = measure(rounds)
        print_rows(found)
        rows += found
    if path:
        after = {"rounds": rounds, "load_after": round(os.getloadavg()[0], 2)}
        table = [asdict(row) for row in rows]
        report = {"about": {**before, **after}, "floor": FLOOR, "rows": table}
        path.write_text(json.dumps(report, indent=1) + "\n")
        print(f"\nwrote {path}: studies/run performance-page {path} refreshes the page")
