# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Measure `cg2raw dataset` on 12-MP half-float EXRs against the paper's way in NumPy.

The paper's way is a straightforward transcription: two matrix products with clips,
white balance undone with highlights kept, mosaic, and a DNG by tifffile (uncompressed).
Both sides run on one core, round by round, so that what else the machine does meets
both."""

import os
import resource
import statistics
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

ROWS = 16  # of paper_raw_at_best at a time
PEER_FILES = 4  # of the images; more take long
SENSOR, LIGHT = "nikon-d40", "2856K"
BOUNDS = {"conversion": 20.0, "files": 5.0, "workers": 1.8, "bytes": 6.0, "MB": 200.0}


def paper_raw(scene, matrices, neutral, levels, cfa):
    """Return (H, W) uint16 of an (H, W, 3) scene, step by step over whole arrays."""
    camera = scene
    for matrix in matrices:
        camera = np.clip(np.einsum("ij,hwj->hwi", matrix, camera), 0, 1)
    grey = camera.mean(axis=2, keepdims=True)
    mask = (np.maximum(grey - 0.9, 0) / 0.1) ** 2
    camera = camera * np.maximum(mask + (1 - mask) * neutral, neutral)
    raw = np.empty(scene.shape[:2])
    for site, letter in enumerate(cfa):
        at = np.s_[site // 2 :: 2, site % 2 :: 2]
        raw[at] = camera[at + ("RGB".index(letter),)]
    black, white = levels
    return np.clip(np.rint(raw * (white - black) + black), 0, white).astype(np.uint16)


def paper_raw_at_best(scene, matrices, neutral, levels, cfa):
    """Return paper_raw() as fast as NumPy can: float32, BLAS, rows that fit a cache.

    Rounding may differ by 1 DN."""
    first, second = (np.array(matrix, np.float32).T for matrix in matrices)
    black, white = map(np.float32, levels)
    third = np.full(3, 1.0 / 3.0, np.float32)
    raw = np.empty(scene.shape[:2], np.uint16)
    for top in range(0, len(scene), ROWS):
        rows = scene[top : top + ROWS]
        camera = rows.reshape(-1, 3)
        for matrix in (first, second):
            camera = camera @ np.ascontiguousarray(matrix)
            np.clip(camera, 0, 1, out=camera)
        mask = camera @ third
        mask -= np.float32(0.9)
        np.maximum(mask, 0, out=mask)
        mask *= np.float32(10)
        mask *= mask
        mask, camera = mask.reshape(rows.shape[:2]), camera.reshape(rows.shape)
        for site, letter in enumerate(cfa):
            at = np.s_[site // 2 :: 2, site % 2 :: 2]
            channel = "RGB".index(letter)
            gain = np.float32(neutral[channel])
            values = np.maximum(mask[at] * (1 - gain) + gain, gain)
            values *= camera[(*at, channel)]
            values *= white - black
            values += black
            np.rint(values, out=values)
            raw[top : top + ROWS][at] = values.clip(0, white)
    return raw


def paper_arguments():
    """Return (matrices, neutral, levels, cfa) of the sensor in convention paper."""
    import cg2raw
    from cg2raw import _core

    sensor = cg2raw.Sensor(SENSOR)
    light = sensor.illuminant(LIGHT)
    transform = _core.camera_from_scene(sensor.profile, light, "paper")
    levels = sensor.black_level[0], sensor.white_level
    neutral = np.array(transform.gains)
    return (transform.first, transform.second), neutral, levels, sensor.cfa


def paper_file(source, target, arguments):
    """Read an EXR, convert it, write a minimal DNG."""
    import OpenImageIO as oiio
    import tifffile

    file = oiio.ImageInput.open(str(source))
    raw = paper_raw(file.read_image(0, 0, 0, 3, oiio.FLOAT), *arguments)
    codes = bytes("RGB".index(letter) for letter in arguments[3])
    tags = [
        (50706, 1, 4, b"\1\4\0\0", True),  # DNGVersion
        (33421, 3, 2, (2, 2), True),  # CFARepeatPatternDim
        (33422, 1, 4, codes, True),  # CFAPattern
        (50714, 4, 1, int(arguments[2][0]), True),  # BlackLevel
        (50717, 4, 1, int(arguments[2][1]), True),  # WhiteLevel
    ]
    tifffile.imwrite(target, raw, photometric=32803, extratags=tags)


def timed(action):
    """Return the seconds of a call, and what it returned."""
    begin = time.perf_counter()
    result = action()
    return time.perf_counter() - begin, result


def bench_conversion(source, rounds):
    """Print megapixels per second of both conversions, and compare their DN."""
    import cg2raw
    from cg2raw.io.image_file import read_image

    scene = read_image(source, undo="stated").pixels
    sensor, arguments = cg2raw.Sensor(SENSOR), paper_arguments()

    def ours():
        return sensor.simulate(scene, illuminant=LIGHT, convention="paper", threads=1)

    pairs = [
        (timed(lambda: paper_raw(scene, *arguments)), timed(ours))
        for _ in range(rounds)
    ]
    (_, peer), (_, own) = pairs[-1]
    apart = np.abs(peer.astype(int) - own).max()
    peer, own = (statistics.median(p[i][0] for p in pairs) for i in (0, 1))
    size = scene.shape[0] * scene.shape[1] / 1e6
    print(
        f"\nconversion, one core, {size:.1f} MP: NumPy {size / peer:.1f} MP/s, ", end=""
    )
    print(f"cg2raw {size / own:.1f} MP/s, at most {apart} DN apart")
    say("conversion", peer / own, "x")


def run_dataset(images, out, workers, *options):
    """Run the command as a process; return (seconds, CPU seconds)."""
    subprocess.run(["rm", "-rf", out], check=True)
    words = ["dataset", images, out, "--sensors", SENSOR, "--illuminants", LIGHT]
    words += ["--convention", "paper", "--workers", workers, "--quiet", *options]
    return spent([sys.executable, "-m", "cg2raw", *map(str, words)])


def spent(command, **keywords):
    """Return (seconds, CPU seconds) of a process and those it started."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds, _ = timed(lambda: subprocess.run(command, check=True, **keywords))
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
    return seconds, cpu


def bench_files(images, folder, rounds):
    """Print seconds of whole files, EXR to DNG, and of two workers against one."""
    sources = sorted(images.iterdir())
    script = (
        "import os, sys; import studies.bench.dataset as b; "
        "os.makedirs(sys.argv[1], exist_ok=True); a = b.paper_arguments(); "
        "[b.paper_file(s, f'{sys.argv[1]}/{i}.dng', a) "
        "for i, s in enumerate(sys.argv[2:])]"
    )
    peer_out = folder / "peer"
    peer_command = [sys.executable, "-c", script, peer_out, *sources[:PEER_FILES]]
    single = {**os.environ, "OPENIMAGEIO_THREADS": "1", "OMP_NUM_THREADS": "1"}
    peer, plain, one, two = [], [], [], []
    for _ in range(rounds):
        peer.append(spent(peer_command, env=single))
        plain.append(run_dataset(images, folder / "o", 1, "--compression", "none"))
        one.append(run_dataset(images, folder / "o", 1))
        two.append(run_dataset(images, folder / "o", 2))
    count = len(sources)
    print(f"\n{count} files, EXR to DNG and manifest, processes started anew")
    named = {"NumPy, 1 process": peer, "uncompressed": plain, "1 worker": one}
    medians = {}
    for name, runs in {**named, "2 workers": two}.items():
        seconds, cpu = (statistics.median(column) for column in zip(*runs, strict=True))
        rate = (PEER_FILES if runs is peer else count) / seconds
        medians[name] = rate
        print(f"{name:18}{rate:6.2f} files/s {rate * 12.19:7.1f} MP/s {cpu:7.2f} CPU s")
    names = ("NumPy, 1 process", "uncompressed", "1 worker", "2 workers")
    peer_rate, plain, one, two = (medians[name] for name in names)
    say("files", plain / peer_rate, "x, uncompressed as the peer")
    say("files", one / peer_rate, "x, ljpeg")
    say("workers", two / one, "x of one worker with two")


def bench_resume(images, folder, rounds):
    """Print how fast finished files are verified, beside sha256sum of the same."""
    out = folder / "resumed"
    run_dataset(images, out, 2, "--compression", "none")
    files = sorted(out.rglob("*.dng"))
    megabytes = sum(file.stat().st_size for file in files) / 1e6
    again = ["dataset", images, out, "--sensors", SENSOR, "--illuminants", LIGHT]
    again += ["--convention", "paper", "--compression", "none", "--quiet"]
    base = [sys.executable, "-m", "cg2raw", *map(str, again)]
    commands = {
        "sha256sum": ["sha256sum", *files],
        "--verify hash": [*base, "--workers", "1"],
        "--verify hash, 2 workers": [*base, "--workers", "2"],
        "--verify size": [*base, "--workers", "1", "--verify", "size"],
    }
    times = {name: [] for name in commands}
    for _ in range(rounds):
        for name, command in commands.items():
            how = {"stdout": subprocess.DEVNULL}
            times[name].append(spent(command, **how)[0])
    print(f"\nresuming {len(files)} finished files, {megabytes:.0f} MB")
    for name, seconds in times.items():
        middle = statistics.median(seconds)
        print(f"{name:26}{middle:6.2f} s {megabytes / middle:8.0f} MB/s")


def bench_memory(source):
    """Print the peak memory of one worker over one 12-MP image, per input sample."""
    from multiprocessing import Process

    for name, options in {"dng": {}, "npy": {"format": "npy"}}.items():
        process = Process(target=worker_memory, args=(str(source), name, options))
        process.start()
        process.join()


def worker_memory(source, name, changed):
    """Make one image's files in this process and print its peak memory."""
    import hashlib
    import tempfile

    import cg2raw
    from cg2raw.dataset import job, options, worker

    worker.use_one_thread()
    fields = {"illuminants": ("A",), "digital_gains": (1.0,), "isos": (None, 400.0)}
    fields |= {
        "exposure_time": None,
        "noise": "gaussian",
        "convention": "dng",
        "method": "graphics2raw",
    }
    fields |= {"format": "dng", "element_type": "float32", "compression": "ljpeg"}
    fields |= {"crop": None, "patches": 1, "seed": 0}
    fields |= {"layer": None, "frame_from": "name", "white_luminance": None}
    sensors = [cg2raw.Sensor("samsung-s20fe")]
    plan = options.make_plan(sensors, print, **(fields | changed))
    with tempfile.TemporaryDirectory() as out:
        text = plan.to_json().encode()
        Path(out, "dataset.json").write_bytes(text)
        digest = hashlib.sha256(text).hexdigest()
        result = job.make(job.Job(out, digest, "image.exr", source, 0))
    assert result["made"] == 2, result
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    samples = 4032 * 3024 * 3
    bound = BOUNDS["bytes"] * samples / 1e6 + BOUNDS["MB"]
    print(f"worker, {name}: peak {peak:.0f} MB (at most {bound:.0f})")


def say(name, ratio, text):
    """Print a ratio beside its bound."""
    print(f"{ratio:.2f} {text} (at least {BOUNDS[name]})")


def bench(source, folder, rounds, copies=48):
    """Run all of it on @copies of one EXR."""
    images = folder / "images"
    images.mkdir(parents=True, exist_ok=True)
    for number in range(copies):
        link = images / f"{number}.exr"
        if not link.exists():
            os.link(source, link)
    bench_memory(source)
    bench_conversion(source, rounds)
    bench_files(images, folder, rounds)
    bench_resume(images, folder, rounds)
