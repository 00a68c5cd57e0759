# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Effects that were renamed: a former name is refused with the one to use."""

import json

import pytest

from cg2raw import Sensor, _core
from cg2raw.cli import main
from cg2raw.diagnose.effects.catalogue import candidates
from cg2raw.synthetic.captures import draw_hidden
from cg2raw.synthetic.sensors import drawn_sensor

FORMER = {
    "early_clipping": "full_well",
    "photon_statistics": "poisson_shot_noise",
    "column_noise": "column_fixed_pattern",
}
pytestmark = pytest.mark.parametrize(("former", "current"), FORMER.items())


def profile_with(**fields):
    profile = json.loads(Sensor("nikon-d40").to_json())
    return json.dumps({**profile, **fields})


def test_its_current_name_is_known(former, current):
    assert _core.current_effect_name(former) == current
    assert _core.current_effect_name(current) == current
    assert current in {effect["name"] for effect in _core.effects()}


def test_a_profile_that_lists_it_is_refused(former, current):
    text = profile_with(effects=[{"name": former, "parameters": {"sigma": 0.1}}])
    said = f'effect "{former}" is called "{current}" since version 0.1'
    with pytest.raises(ValueError, match=said):
        Sensor.from_json(text, "mine.json")


def test_a_profile_that_draws_noise_by_it_is_refused(former, current):
    text = profile_with(noise_effects=[former, "read_noise"])
    with pytest.raises(ValueError, match=f'mine.json: .*is called "{current}" since'):
        Sensor.from_json(text, "mine.json")


def test_commands_refuse_it(former, current, capsys, tmp_path):
    assert main(["effects", former]) == 1
    assert f'is called "{current}"' in capsys.readouterr().err
    captures = tmp_path / "captures.yaml"
    captures.write_text("sensor: nikon-d40\nframes: []\n")
    words = ["diagnose", str(captures), "-o", str(tmp_path / "r")]
    assert main([*words, "--exclude", former]) == 1
    assert current in capsys.readouterr().err


def test_the_diagnosis_and_the_simulator_refuse_it(former, current):
    with pytest.raises(ValueError, match=f'is called "{current}" since'):
        candidates("RGGB", without=[former])
    with pytest.raises(ValueError, match=f"is called '{current}' now"):
        draw_hidden(drawn_sensor(1), {former: None}, seed=1)
