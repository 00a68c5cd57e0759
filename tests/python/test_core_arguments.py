# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Arguments of wrong types, for every public name: one of two errors, in our words."""

import inspect
import subprocess
import sys

import numpy as np
import pytest

import cg2raw
from cg2raw import _core
from cg2raw.core_arguments import shown
from python.commands import write_dng

LONGEST = 2000  # letters of a message
RGB = np.full((16, 24, 3), 0.2, np.float32)
PLANE = RGB[..., 0]
DN = np.full((16, 24), 900, np.uint16)
SENSOR = cg2raw.Sensor("canon-5d-mark-iv")
UPI = cg2raw.Upi("nikon-d40")
LIGHT = {"illuminant": "D65"}
RUN = {**LIGHT, "iso": 400, "noise": "gaussian", "seed": 1, "frame": 1}
RUN |= {"digital_gain": 1.0, "convention": "dng", "highlights": True, "effects": True}
RUN |= {"camera_input": False, "as_shot": (1, 1, 1), "exposure_time": 0.1}
RUN |= {"color_effects": True}
EFFECT = {"name": "row_noise", "parameters": {"sigma": 0.001}}
WRONG = [
    None,
    True,
    1.5,
    -1,
    2**70,
    10**5000,
    float("nan"),
    float("inf"),
    "",
    "\udc80",
    "a\0b",
    "x" * 10**5,
    "many words " * 10**4,
    b"bytes",
    object(),
    [],
    [None],
    (1, 2, 3, 4, 5, 6, 7, 8, 9),
    {},
    {"a": 1},
    {"\udc80": 1},
    lambda: None,
    int,
    np.zeros(0),
    np.zeros((0, 0, 3), np.float32),
    np.zeros((2, 2), complex),
    np.array([object()]),
    np.array(["text"]),
]


def calls(folder):
    """Return {name: (callable, keywords that are right)} of what is public."""
    dng = write_dng(folder / "shot.dng")
    metadata = cg2raw.read_dng_metadata(str(dng))
    profile, text = SENSOR.profile, SENSOR.to_json()
    simulation = SENSOR.simulation((16, 24), **LIGHT)
    core_run = cg2raw.exposure.core_run(SENSOR.id, cg2raw.Run(**LIGHT))
    frame = {"sensor": SENSOR, **LIGHT, "iso": 400, "effects": True}
    how = {"compression": "none", "preview": False, "matrices": "camera"}
    how |= {"tone_curve": "camera", "crop": "none", "shading": None, "threads": 1}
    how |= {"shot": {"f_number": 4}, "sync": False}
    found = {
        "Sensor": (cg2raw.Sensor, {"id_or_path": SENSOR.id}),
        "from_json": (cg2raw.Sensor.from_json, {"text": text, "name": "n"}),
        "from_dng": (cg2raw.Sensor.from_dng, {"path": dng}),
        "from_profile": (cg2raw.Sensor.from_profile, {"profile": profile}),
        "simulation": (SENSOR.simulation, {"shape": (16, 24), **RUN}),
        "to_camera": (SENSOR.to_camera, {"rgb": RGB, **LIGHT, "threads": 1}),
        "to_scene": (SENSOR.to_scene, {"camera": RGB, **LIGHT, "threads": 1}),
        "transform": (SENSOR.transform, {"light": "D65", "convention": "dng"}),
        "signal_from_raw": (SENSOR.signal_from_raw, {"raw": DN}),
        "raw_from_signal": (SENSOR.raw_from_signal, {"signal": PLANE}),
        "add_noise": (SENSOR.add_noise, {"signal": PLANE, "iso": 400, "threads": 1}),
        "apply_effect": (SENSOR.apply_effect, {"image": PLANE, **EFFECT, **LIGHT}),
        "predict_effect": (SENSOR.predict_effect, {"image": PLANE, **EFFECT}),
        "Simulation": (
            cg2raw.Simulation,
            {"profile": profile, "shape": (16, 24), "run": core_run},
        ),
        "Simulation.raw": (simulation.raw, {"rgb": RGB, "threads": 1}),
        "Upi": (cg2raw.Upi, {"sensor": "nikon-d40", "gains": "published"}),
        "illuminant": (profile.illuminant, {"spec": "D65", "as_shot": (1, 1, 1)}),
        "noise_at": (profile.noise_at, {"iso": 400}),
        "demosaic": (cg2raw.demosaic, {"signal": PLANE, "cfa": "RGGB", "threads": 1}),
        "mosaic": (cg2raw.mosaic, {"camera": RGB, "cfa": "RGGB", "threads": 1}),
        "effects": (cg2raw.effects, {"cfa": "RGGB"}),
        "illuminant_list": (cg2raw.illuminant_list, {"words": "A"}),
        "philox_words": (
            cg2raw.philox_words,
            {"counter": (1, 2, 3, 4), "key": (1, 2)},
        ),
        "planckian_xy": (cg2raw.planckian_xy, {"cct": 3000}),
        "raw_space_from_name": (cg2raw.raw_space_from_name, {"name": "a"}),
        "read_dng_metadata": (cg2raw.read_dng_metadata, {"path": str(dng)}),
        "merged_shot": (metadata.merged_shot, {"of_image": _core.Shot()}),
        "temperature_from_xy": (
            cg2raw.temperature_from_xy,
            {"xy": (0.3, 0.3), "table": "adobe"},
        ),
        "write_dng": (
            cg2raw.write_dng,
            {"path": folder / "new.dng", "raw": DN, **frame, **how},
        ),
    }
    for name in ("simulate", "signal", "predict"):
        found[name] = (getattr(SENSOR, name), {"rgb": RGB, "threads": 1, **RUN})
    found["Upi.draw"] = (UPI.draw, {"seed": 1})
    found["Upi.simulate"] = (UPI.simulate, {"rgb": RGB, "seed": 1, "threads": 1})
    for name in ("raw_space_name", "raw_space_alias"):
        found[name] = (getattr(cg2raw, name), {"sensor": SENSOR.id, **LIGHT})
    return found


NAMES = [
    *("Sensor", "Simulation", "Simulation.raw", "Upi", "Upi.draw", "Upi.simulate"),
    *("add_noise", "apply_effect", "demosaic", "effects", "from_dng", "from_json"),
    *("from_profile", "illuminant", "illuminant_list", "merged_shot", "mosaic"),
    *("noise_at", "philox_words", "planckian_xy", "predict", "predict_effect"),
    *("raw_from_signal", "raw_space_alias", "raw_space_from_name", "raw_space_name"),
    *("read_dng_metadata", "signal", "signal_from_raw", "simulate", "simulation"),
    *("temperature_from_xy", "to_camera", "to_scene", "transform", "write_dng"),
]
# Public names that take no arguments, or are what others return.
WITHOUT = {"DngMetadata", "Illuminant", "RawFrame", "SensorProfile", "__version__"}
WITHOUT |= {"Run", "illuminant_grammar", "installed_profiles", "profile_folders"}
WITHOUT |= {"register_oiio_plugin"}


def test_every_public_name_is_tried(tmp_path):
    assert sorted(calls(tmp_path)) == NAMES
    assert set(cg2raw.__all__) == (set(NAMES) & set(cg2raw.__all__)) | WITHOUT


@pytest.mark.parametrize("name", NAMES)
def test_wrong_arguments_are_told_in_one_short_line(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)  # bytes are a path, too
    function, right = calls(tmp_path)[name]
    function(**right)
    refused, bad = 0, []
    for argument in right:
        for value in WRONG:
            try:
                function(**{**right, argument: value})
            except (ValueError, TypeError) as error:
                said, refused = str(error), refused + 1
                if len(said) > LONGEST or "\n" in said or "incompatible" in said:
                    bad.append((argument, shown(value), said[:300]))
            except Exception as error:
                bad.append((argument, shown(value), type(error), str(error)[:300]))
    assert refused > len(right) and bad == []


def message_of(call, *args, **named):
    with pytest.raises(TypeError) as found:
        call(*args, **named)
    return str(found.value)


def test_a_message_names_the_argument_its_value_and_what_it_may_be():
    planckian, light = cg2raw.planckian_xy, SENSOR.profile.illuminant
    assert message_of(planckian, "x") == "planckian_xy(): cct 'x' must be a number"
    assert message_of(planckian) == "planckian_xy() needs cct"
    assert message_of(planckian, 1, 2) == (
        "planckian_xy() does not take 2 arguments; it takes cct"
    )
    assert message_of(light, spec="A", at=1) == (
        "illuminant() does not take 'at'; it takes spec, as_shot"
    )
    assert message_of(light, "A", as_shoot=None) == (
        "illuminant() does not take 'as_shoot'; did you mean as_shot?"
    )
    assert message_of(light, "A", (1, 2)) == (
        "illuminant(): as_shot (1, 2) must be 3 numbers or None"
    )
    assert message_of(cg2raw.illuminant_list, "\udc80") == (
        r"illuminant_list(): words '\udc80' must be a text (no Unicode: it has lone "
        "surrogates)"
    )
    assert message_of(cg2raw.philox_words, (0, 0, 0, -1), (0, 0)).startswith(
        "philox_words(): a number out of range, or a wrong type: counter (0, 0, 0, -1)"
    )
    assert message_of(_core.SpectralResponse, SENSOR.profile, "A", [400], 1.0) == (
        "SpectralResponse(): light 'A' must be an Illuminant or a sequence of values"
    )
    assert message_of(cg2raw.Simulation, SENSOR.profile, (4, 4), RGB) == (
        "Simulation(): run an array (16, 24, 3) of float32 must be a Run"
    )


@pytest.mark.parametrize("bins", ["x", [400, "a"], [400.0, None], 5])
def test_a_sequence_of_numbers_is_no_text_and_holds_no_other_values(bins):
    light = SENSOR.profile.illuminant("A")
    message = message_of(_core.SpectralResponse, SENSOR.profile, light, bins, 1.0)
    assert message == (
        f"SpectralResponse(): bins {bins!r} must be a SpectralChannels or a sequence "
        "of numbers"
    )


def test_the_documentation_of_the_core_stays():
    assert inspect.getdoc(cg2raw.planckian_xy).startswith("planckian_xy(cct: ")
    assert cg2raw.planckian_xy.__name__ == "planckian_xy"


@pytest.mark.parametrize(
    "first",
    [
        "import cg2raw",
        "from cg2raw import _core, Sensor",
        "from cg2raw.sensor import Sensor",
        "from cg2raw._core import SensorProfile; from cg2raw.exposure import Run",
        "import cg2raw.near_words",
    ],
)
def test_the_core_speaks_so_whatever_is_imported_first(first):
    program = (
        f"{first}\nimport cg2raw\n"
        "for call in (cg2raw.planckian_xy, cg2raw.Sensor):\n"
        "  try: call('nikon-d41')\n"
        "  except (ValueError, TypeError) as error:\n"
        "    print(str(error).partition(' installed')[0])\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True
    )
    assert done.stdout.splitlines() == [
        "planckian_xy(): cct 'nikon-d41' must be a number",
        'unknown sensor "nikon-d41"; did you mean nikon-d40?',
    ], done.stderr
