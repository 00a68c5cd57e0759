# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The evidence study's world, its cameras, and results with planted gaps."""

import os
import shutil
import subprocess
import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

# The fixtures and options of cg2raw's own tests; the folder is on the path of pytest.
from conftest import *  # noqa: F403


@pytest.fixture(scope="session")
def world():
    """Return the World of luxpy's data files if found, else the small one, whose frames
    have a quarter of the pixels."""
    from studies.places import luxpy_folder
    from studies.protocol import PROTOCOL
    from studies.world.shots import load_world

    scene = replace(PROTOCOL.scene, height=48, width=64)
    return load_world(luxpy_folder(), replace(PROTOCOL, scene=scene))


@pytest.fixture(autouse=True)
def no_intervals(monkeypatch):
    """Let a match draw no bootstrap: of it no study reads the intervals."""
    from cg2raw.match import shift

    monkeypatch.setattr(shift, "intervals", lambda found, *_: ((x, x) for x in found))


@pytest.fixture(scope="session")
def camera_of(camera_data):
    """Return camera_of(id): a Camera; skipped without camera data."""
    from studies.cameras import known_camera

    return lambda name: known_camera(name, camera_data)


@pytest.fixture(scope="session")
def run_module():
    """Return run_module(name, *words): the finished process of a module of studies."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}

    def run(name, *words):
        return subprocess.run(
            [sys.executable, "-m", f"studies.{name}", *map(str, words)],
            env=environment,
            capture_output=True,
            text=True,
        )

    return run


GAPS = {  # of a source to real
    "real": 0.0,
    "real, other scenes": 0.1,
    "ours, dng": 0.2,
    "ours, paper": 0.5,
    "ours, spectral": 0.15,
    "upi, published": 2.0,
    "upi, camera": 1.0,
    "upi, graphics2raw": 1.2,
    "upi's matrices, our lights": 0.3,
    "translation, graphics2raw": 1.5,
    "ours, match": 0.25,
    "upi, match": 1.1,
}
GOALS = ("CIE XYZ", "camera's own rendering")
CONDITIONS = ("ISO 1600, brightness 0.35", "ISO 1600, brightness 0.03")
CAMERAS = ("sony-a7s-ii", "nikon-d850")
DRAWS, FRAMES = 2, 8


def errors(seed):
    """Return {source: (draws, frames)}: alike noise, whose mean is 0, over each gap."""
    rng = np.random.default_rng(seed)
    base = 3.0 + rng.random((DRAWS, FRAMES))
    found = {}
    for source, gap in GAPS.items():
        noise = rng.normal(0.0, 0.05, (DRAWS, FRAMES)) if gap else np.zeros(1)
        found[source] = (base + gap + noise - noise.mean()).tolist()
    return found


def measures(seed):
    """Return {source: {measure: (draws, frames)}}; PSNR falls as errors rise."""
    return {
        source: {
            "difference": values,
            "psnr": (40.0 - np.array(values)).tolist(),
            "ssim": (1.0 - np.array(values) / 100.0).tolist(),
        }
        for source, values in errors(seed).items()
    }


def gains(seed):
    """Return measures() of which more is better."""
    return {
        source: {name: of[name] for name in ("psnr", "ssim")}
        for source, of in measures(seed).items()
    }


@pytest.fixture(scope="session")
def planted():
    """Return results of what is learnt whose gaps to real are known, and those gaps."""
    entries = {
        "illuminant": errors,
        "isp": lambda seed: {goal: measures(seed) for goal in GOALS},
        "denoising": lambda seed: {condition: gains(seed) for condition in CONDITIONS},
    }
    results = {
        study: {
            "made by": {"seeds": "real 1", "host": "planted"},
            "cameras": {
                camera: {"hash": "planted", "entry": entry(seed)}
                for seed, camera in enumerate(CAMERAS)
            },
        }
        for study, entry in entries.items()
    }
    from studies.summaries import summaries

    return SimpleNamespace(
        summaries=summaries(results),
        goals=GOALS,
        gaps=GAPS,
        sources=list(GAPS),
        cameras=list(CAMERAS),
        conditions=CONDITIONS,
        results=results,
    )


TOOLS = ("bash", "cat", "cksum", "dirname", "grep", "rm", "tail")
# Stands in for a Python: makes an environment whose pip fails as pip does.
NO_NETWORK = """#!/bin/bash
/bin/mkdir -p "$3/bin"
cat > "$3/bin/python" <<'EOF'
#!/bin/bash
echo "Looking in indexes: planted" >&2
echo "ERROR: No matching distribution found for {package}" >&2
exit 1
EOF
/bin/chmod +x "$3/bin/python"
"""


@pytest.fixture
def copied_script(repository, tmp_path):
    """Return copied_script(command, requirements): run(**environment) of a command of
    studies/run, a copy in tmp_path with few programs on PATH."""

    def copied(command, requirements):
        script = "studies/run"
        files = (script, "studies/environment.sh", f"studies/{requirements}")
        for file in files:
            (tmp_path / file).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(repository / file, tmp_path / file)
        programs = tmp_path / "bin"
        programs.mkdir()
        for tool in TOOLS:
            (programs / tool).symlink_to(shutil.which(tool))
        usual = {"PATH": str(programs), "HOME": os.environ.get("HOME", "/")}

        def run(**environment):
            return subprocess.run(
                [tmp_path / script, command, tmp_path / "out", "-n", "1"],
                env={**usual, **environment},
                capture_output=True,
                text=True,
            )

        return run

    return copied


@pytest.fixture
def python_without_network(tmp_path):
    """Put on a copied script's PATH a Python of a name, whose pip finds no package."""

    def put(name, package):
        python = tmp_path / "bin" / name
        python.write_text(NO_NETWORK.replace("{package}", package))
        python.chmod(0o755)

    return put
