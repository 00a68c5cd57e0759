# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Measure `cg2raw diagnose` on 12 frames of 1 MP and of 12 MP, and on 204 of 1 MP:
seconds and memory.

The frames are those of a profile with lens shading and row noise, in DNGs; the baseline
model lacks both. There is no peer that names effects: bounds are absolute, for two
cores that do nothing else."""

import json
import os
import subprocess
import sys
import time
from itertools import product

import numpy as np

GROUPS = ("fit", "select", "report")
SENSOR, LIGHT, ISO = "canon-5d-mark-iv", "D65", 800
# Width, height, how often four frames of a group are taken; bounds of seconds and MB.
SIZES = {
    "12 of 1 MP": (1200, 840, 1, 30, None),
    "12 of 12 MP": (4000, 3000, 1, 300, 3000),
    "204 of 1 MP": (1200, 840, 17, 510, None),
}
EFFECTS = [
    {
        "name": "lens_shading",
        "parameters": {
            "r2": -0.25,
            "r4": 0.03,
            "r6": -0.05,
            "tilt_x": 0.02,
            "tilt_y": -0.01,
            "tilt_x_r2": 0.0,
            "tilt_y_r2": 0.0,
        },
    },
    {"name": "row_noise", "parameters": {"sigma": 0.0006}},
]


def rendered(width, height, seed):
    """Return (H, W, 3) float32: squares of many sizes and colours."""
    rng = np.random.default_rng(seed)
    scene = np.zeros((height, width, 3), np.float32)
    for side, share in ((500, 0.4), (100, 0.24), (20, 0.16), (4, 0.08)):
        shape = (height // side + 1, width // side + 1, 3)
        squares = rng.random(shape).astype(np.float32)
        big = squares.repeat(side, 0)[:height].repeat(side, 1)[:, :width]
        scene += np.float32(share) * big
    return scene


def make_captures(folder, width, height, times):
    """Write 12 frames, @times over, their renders and captures.yaml."""
    import cg2raw

    folder.mkdir(parents=True, exist_ok=True)
    baseline = json.loads(cg2raw.Sensor(SENSOR).to_json())
    (folder / "sensor.json").write_text(json.dumps(baseline))
    true = cg2raw.Sensor.from_json(json.dumps({**baseline, "effects": EFFECTS}))
    lines = ["sensor: sensor.json", f"iso: {ISO}", f"illuminant: {LIGHT}", "frames:"]
    number = 0

    def shoot(name, scene, seconds, words):
        nonlocal number
        raw = true.simulate(
            scene,
            illuminant=LIGHT,
            iso=ISO,
            convention="sensor",
            frame=number,
            exposure_time=seconds,
        )
        number += 1
        cg2raw.write_dng(folder / f"{name}.dng", raw, shot={"exposure_time": seconds})
        lines.append(f"  - {{file: {name}.dng, exposure_time: {seconds}, {words}}}")

    for place, (group, taken) in enumerate(product(GROUPS, range(times))):
        name = f"{group}_{taken}"
        dark = np.zeros((height, width, 3), np.float32)
        shoot(f"{name}_dark", dark, 0.5, f"kind: dark, group: {group}")
        flat = f"kind: flat, scene: 0.4, set: {name}_flat, group: {group}"
        shoot(f"{name}_flat", dark + np.float32(0.4), 0.1, flat)
        scene = rendered(width, height, place)
        np.save(folder / f"{name}.npy", scene)
        words = f"kind: scene, scene: {name}.npy, set: {name}, group: {group}"
        for repeat in range(2):
            shoot(f"{name}_scene_{repeat}", scene, 0.1, words)
    (folder / "captures.yaml").write_text("\n".join(lines) + "\n")


def bench(folder):
    """Print seconds, memory and verdict of each size."""
    print(f"\n{'cg2raw diagnose':16}{'seconds':>9}{'bound':>7}{'MB':>7}{'bound':>7}")
    for name, (width, height, times, bound, most) in SIZES.items():
        make_captures(folder / name.replace(" ", ""), width, height, times)
        captures = folder / name.replace(" ", "") / "captures.yaml"
        report = captures.parent / "report"
        command = [sys.executable, "-m", "cg2raw", "diagnose", captures, "-o", report]
        begin = time.perf_counter()
        process = subprocess.Popen([*map(str, command), "--overwrite", "--quiet"])
        _, status, used = os.wait4(process.pid, 0)
        seconds = time.perf_counter() - begin
        if status:
            raise SystemExit(f"bench: cg2raw diagnose failed on {captures}")
        found = json.loads((report / "verdict.json").read_text())
        names = ", ".join(effect["name"] for effect in found["effects"])
        memory = used.ru_maxrss / 1024
        print(
            f"{name:16}{seconds:9.1f}{bound:7}{memory:7.0f}{most or '-':>7}"
            f"   {found['verdict']}: {names}"
        )
