# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What diagnose writes on made-up captures, to the last number, is as it was."""

from dataclasses import replace

import pytest

pytest.importorskip("scipy")

from cg2raw.diagnose import diagnose
from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.report.folder import write_report_folder
from cg2raw.synthetic.captures import draw_hidden, simulate_captures
from cg2raw.synthetic.conditions import STUDIO
from cg2raw.synthetic.sensors import drawn_sensor
from diagnose import planted, test_mono
from diagnose.closed_loop import simulated
from golden import outlines

SHAPE = (80, 96)
EVERY = ("dark", "flat", "scene")
STUDIO_TWICE = {"nuisances": STUDIO, "twice": True}
PIXELS = (
    "hot_pixels",
    "random_telegraph_noise",
    "dsnu",
    "dark_current_nonuniformity",
    "prnu",
    "dust",
    "amplifier_mismatch",
    "nonlinearity",
    "heavy_tailed_noise",
)
# What is hidden, the seed of the sensor, kinds of captures, how else they differ.
SETS = {
    "mixed": (
        ("lens_shading", "row_noise", "blur", "mains_flicker", "full_well"),
        7,
        EVERY,
        {},
    ),
    "studio": (
        ("color_matrix", "veiling_glare", "noise_reduction", "gr_gb_imbalance"),
        7,
        ("scene",),
        STUDIO_TWICE,
    ),
    "pixels": (PIXELS, 7, ("dark", "flat"), {"twice": True}),
    "offsets": (
        ("read_noise", "black_level", "dark_current", "column_fixed_pattern"),
        7,
        ("dark",),
        {"twice": True},
    ),
    "readout": (
        ("bias_structure", "black_level_drift", "read_noise_correlation"),
        2,
        ("dark",),
        {"twice": True},
    ),
    "flats": (
        ("color_shading", "pdaf_pixels", "shot_noise", "gr_gb_imbalance"),
        2,
        ("flat",),
        {"twice": True},
    ),
    "edges": (
        ("exposure", "lateral_chromatic_aberration", "crosstalk", "poisson_shot_noise"),
        7,
        ("scene",),
        {},
    ),
    "unknown": (("smear", "lens_distortion"), 2, EVERY, {}),
}
# Of which the pages are compared as well: those of the others have no other elements.
PAGES = ("mixed", "studio", "pixels")
# Of one frame of each, which are too few for three splits.
FEW = (("white_balance", "amplifier_glow", "shot_noise"), 7, EVERY, {})
# What the registry draws, and the sensor that is doubted.
DRAWN = {
    "mono": (
        {"lens_shading": {"r2": -0.25}, "prnu": {"sigma": 0.01}},
        test_mono.sensor_of(),
    ),
    "stated": (
        {"lens_shading": {"r2": -0.25}, "prnu": {"sigma": 0.015}},
        planted.stating(
            planted.sensor_of(),
            {"lens_shading": {"r2": -0.2}, "prnu": {"sigma": 0.01}},
        ),
    ),
}


def check(name, found, folder):
    """Compare a report with its golden file."""
    write_report_folder(replace(found, seconds=1.0), folder)
    lines = []
    for file in sorted(folder.iterdir()):
        if file.suffix != ".html" or name in PAGES:
            lines += [f"{file.name}:", *outlines.of_file(file)]
    outlines.check(f"diagnose_{name}", lines)


def captures_of(effects, seed, kinds, more):
    sensor = drawn_sensor(seed)
    hidden = draw_hidden(sensor, dict.fromkeys(effects), seed=seed)
    captures = simulate_captures(sensor, hidden, seed=seed, shape=SHAPE, **more)
    chosen = [one for one in captures.captures if one.kind in kinds]
    return replace(captures, captures=chosen)


@pytest.mark.parametrize("name", SETS)
def test_of_hidden_effects(name, tmp_path):
    check(name, diagnose(captures_of(*SETS[name]), threads=1), tmp_path / "report")


def test_of_few_captures(tmp_path):
    every = captures_of(*FEW)
    first = [one for one in every.captures if one.name.endswith("_0")]
    found = diagnose(replace(every, captures=first), threads=1)
    check("few", found, tmp_path / "report")


@pytest.mark.parametrize("name", DRAWN)
def test_of_effects_of_the_registry(name, tmp_path):
    effects, known = DRAWN[name]
    true = planted.stating(known, effects)
    captures = CaptureSet(true, planted.standard_set(SHAPE))
    shown = replace(simulated(captures, true), sensor=known)
    check(name, diagnose(shown, threads=1), tmp_path / "report")


def test_the_sets_hide_what_a_diagnosis_names(tmp_path):
    """Else a golden file would guard little."""
    hidden = {one for effects, *_ in [*SETS.values(), FEW] for one in effects}
    missed = {*planted.BY_NAME} - hidden
    assert missed <= {"dark_current_nonuniformity"}
