# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What is said of a new profile: what it has, what it lacks, and what that costs."""

import numpy as np
import pytest

from cg2raw.profile.report import as_text, missing, noise_words
from cg2raw.profile.summary import cfa_word, neutral_words

MATRIX = {"light_source": "A", "xyz_d50_from_camera": None}
WHOLE = {
    "cfa": "RGGB",
    "noise": {"iso": [100, 3200]},
    "calibrations": [
        {"light_source": light, "xyz_d50_from_camera": np.eye(3).tolist()}
        for light in ("A", "D65")
    ],
    "illuminants": {"hull": [[1, 1]] * 3, "count": 5},
    "effects": [{"name": "lens_shading"}],
}
LIGHTS = {"hull": [], "count": 2}


@pytest.mark.parametrize(
    ("lacks", "words"),
    [
        ({}, []),
        ({"noise": {"iso": None}}, ["noise: frames are clean, an ISO is an error; "]),
        (
            {"noise": {"iso": [400, 400]}},
            ["noise at a second ISO: only ISO 400 can be"],
        ),
        ({"effects": [{"name": "prnu"}]}, ["lens shading (GainMap): corners are as"]),
        (
            {"illuminants": LIGHTS},
            ["3 neutrals that span an area (there are 2): sample:n is drawn along"],
        ),
        (
            {"illuminants": LIGHTS, "calibrations": [MATRIX]},
            [
                "second colour matrix: nothing is interpolated, every light gets the "
                "matrix of A",
                "forward matrix: colours are adapted to D50 by Bradford",
                "3 neutrals that span an area (there are 2): sample:n is an error; ",
            ],
        ),
        ({"cfa": "MONO", "illuminants": LIGHTS, "calibrations": []}, []),
    ],
)
def test_what_a_profile_lacks_is_named_with_its_cost(lacks, words):
    found = missing(WHOLE | lacks)
    assert len(found) == len(words)
    for line, start in zip(found, words, strict=True):
        assert line.startswith(start)


def test_the_text_has_levels_files_and_matrices():
    text = as_text(
        WHOLE
        | {
            **{"camera": "Acme One", "id": "acme-one", "files": 3, "kind": "DNG"},
            **{"skipped": ["x.dng: is cut off"], "notes": ["odd"], "missing": ["much"]},
            **{"width": 40, "height": 30, "bits": 12, "white_level": 3880},
            **{"black_level": [64, 60, 64, 64], "noise": {"rows": []}},
            "illuminants": {"mean": None},
            "calibrations": [MATRIX, WHOLE["calibrations"][1]],
        }
    )
    assert text.splitlines() == [
        "camera    Acme One, id acme-one",
        "files     3 DNG, 1 skipped",
        "skipped   x.dng: is cut off",
        "CFA       RGGB, 40 x 30",
        "levels    12 bits, black 60 to 64 DN, white 3880 DN",
        "matrices  A; D65 with forward matrix",
        "neutrals  none",
        "noise     none",
        "effects   lens_shading",
        "note      odd",
        "missing   much",
    ]


def test_many_isos_are_the_first_two_and_the_last():
    rows = [
        {"iso": iso, "beta1": [iso * 1e-6, 1], "beta2": [iso * 1e-9, 1]}
        for iso in (100, 200, 400, 800, 1600)
    ]
    said = [f"ISO {r['iso']} (beta1 {r['beta1'][0]:.3g}, beta2 {r['beta2'][0]:.3g})"
            for r in rows]  # fmt: skip
    assert noise_words(rows[:1]) == said[0] == "ISO 100 (beta1 0.0001, beta2 1e-07)"
    assert noise_words(rows[:4]) == f"4 ISOs: {', '.join(said[:4])}"
    assert noise_words(rows) == f"5 ISOs: {said[0]}, {said[1]}, ..., {said[4]}"


def test_neutrals_in_words():
    lights = {"mean": [0.5, 0.75], "sd": [0.01, 0.02], "cct": [2856.2, 6504.1]}
    spread = "R/G 0.5000 sd 0.0100, B/G 0.7500 sd 0.0200"
    assert neutral_words(lights | {"count": 7}) == f"7, 2856-6504 K, {spread}"
    found = neutral_words(lights | {"count": 0, "hull": [0] * 4})
    assert found == f"hull of 4 corners, 2856-6504 K, {spread}"
    found = neutral_words(lights | {"count": 1, "cct": [5000, 5000]})
    assert found == "1, 5000 K, R/G 0.5000, B/G 0.7500"


@pytest.mark.parametrize(
    ("cfa", "word"),
    [("GRBG", "GRBG"), ("MONO", "mono"), ("R" * 36, "X-Trans"), ("R" * 16, "16 sites")],
)
def test_a_cfa_in_words(cfa, word):
    assert cfa_word(cfa) == word
