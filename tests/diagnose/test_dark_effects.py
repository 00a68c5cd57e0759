# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What is there without light, simulated by the registry and diagnosed: named first,
with what was planted within its interval."""

import numpy as np
import pytest

from cg2raw import Sensor
from cg2raw.diagnose import diagnose
from cg2raw.diagnose.captures.capture import CaptureSet
from cg2raw.diagnose.captures.reader import in_groups
from cg2raw.diagnose.captures.splits import GROUPS
from diagnose.closed_loop import by_registry, simulated
from diagnose.effects.test_by_registry import BIAS, GLOW
from diagnose.planted import READ, READ_NOISE, capture_of, sensor_of

SHAPE = (96, 128)
TIMES = (0.0, 0.0, 0.5, 2.0, 4.0, 4.0)  # seconds: two biases, and darks
SENSOR = sensor_of()
ALL = {
    "dark_current": {"per_second": 0.4 * READ},
    "dark_current_nonuniformity": {"rate": 0.4 * READ, "log_sigma": 0.8},
    "bias_structure": BIAS,
    "black_level_drift": {"sigma": 0.2 * READ},
    "amplifier_glow": GLOW,
}


def shots():
    """Return captures without pixels: six darks and two flats a group."""
    for number, group in enumerate(GROUPS):
        for n, time in enumerate(TIMES):
            name = f"dark-{group}-{n}"
            yield capture_of("dark", n, name=name, group=group, set=f"dark-{group}",
                             exposure_time=time, shape=SHAPE)  # fmt: skip
        for n, level in enumerate((0.2, 0.6)):
            name = f"flat-{group}-{n}"
            yield capture_of("flat", 10 * number + n, name=name, group=group,
                             level=level, exposure_time=0.1, shape=SHAPE)  # fmt: skip


def diagnosed(true, doubted=SENSOR, draw=0, details=False):
    """draw : of the noise; the sensor's maps are the same in all."""

    def simulate(sensor, capture, number):
        return by_registry(sensor, capture, number + draw * len(GROUPS) * 8)

    captures = simulated(CaptureSet(true, list(shots())), true, simulate).captures
    return diagnose(CaptureSet(doubted, captures), details=details, threads=2)


def missed(finding, planted):
    """Return the parameters that lie farther from what was planted than a half more
    than their intervals of 95 %: one in 300 by chance, of ten."""
    pairs = [(finding.parameters[name], value) for name, value in planted.items()]
    return [
        (one, value)
        for one, value in pairs
        if abs(one.value - value) > 1.5 * (one.ci95[1] - one.ci95[0]) / 2
    ]


@pytest.mark.slow
def test_uneven_dark_current_is_named_with_its_law():
    """Beside the dark current that a profile has."""
    known, name = {"dark_current": ALL["dark_current"]}, "dark_current_nonuniformity"
    true = sensor_of(effects={**known, name: ALL[name]})
    found = diagnosed(true, sensor_of(effects=known))
    assert [f.name for f in found.effects] == [name]
    assert missed(found.effects[0], ALL[name]) == []
    effects = Sensor.from_json(found.profile_json, "found").effects
    assert set(effects[1]["parameters"]) == set(ALL[name])


@pytest.mark.slow
def test_all_of_them_at_once_are_found():
    """As real sensors have them, with a dark current, by darks of four times.

    Chi-square of one draw is off by 0.011, one standard deviation of four: 0.005 by the
    noise of its report frames, the rest by the shot noise of a charge that so few darks
    do not tell better. A wrong law of the noise would be off in all of them."""
    true = sensor_of(effects=ALL)
    draws = [diagnosed(true, draw=number) for number in range(4)]
    for found in draws:
        assert {finding.name for finding in found.effects} == set(ALL)
    chi2 = [found.gap.chi2_after for found in draws]
    assert np.mean(chi2) == pytest.approx(1, abs=0.015), chi2
    assert np.ptp(chi2) < 0.05, chi2


@pytest.mark.slow
def test_noise_before_a_filter_of_the_file_is_what_the_profile_gets():
    """Frames have what it leaves, and those of the found profile agree with it."""
    noise = {"noise_reduction": {"blend": 0.15, "diagonal": 0.05}}
    noise |= {"dsnu": {"sigma": 0.5 * READ}, "row_noise": {"sigma": 0.3 * READ}}
    found = diagnosed(sensor_of(read_noise=np.exp(0.15) * READ_NOISE, effects=noise))
    by_name = {finding.name: finding for finding in found.effects}
    assert set(by_name) == {*noise, "read_noise"}
    for name, planted in {**noise, "read_noise": {"log_variance": 0.3}}.items():
        assert missed(by_name[name], planted) == [], name
    better = Sensor.from_json(found.profile_json, "found")
    assert diagnosed(better, better, draw=1).verdict == "consistent"


def test_a_chart_without_a_filter_has_the_profile_s():
    """Of pixels two apart, whose noise 0.1 of the neighbours leaves alike by 0.055."""
    weak, strong = ({"blend": b, "diagonal": 0.0} for b in (0.1, 0.3))
    each = [sensor_of(effects={"noise_reduction": one}) for one in (strong, weak)]
    found = diagnosed(*each, details=True)
    [finding] = found.effects
    assert (finding.name, finding.stated) == ("noise_reduction", True)
    assert missed(finding, strong) == []
    [chart] = [one for one in found.charts if one.effect == "noise_reduction"]
    [series] = chart.series
    at = [n for n, name in enumerate(chart.names) if name.startswith("2 px")]
    assert max(series.before[at]) == pytest.approx(0.055, abs=0.03)
    assert max(series.after[at]) > 3 * max(series.before[at])


@pytest.mark.slow
def test_a_structure_that_is_in_the_profile_is_found_where_it_changed():
    """Steps start from what the profile has: not from zero, nor twice. What is too
    little to name is no other effect either."""
    known = sensor_of(effects={"bias_structure": BIAS})
    moved = {**BIAS, "edge": -0.5 * READ}
    found = diagnosed(sensor_of(effects={"bias_structure": moved}), known)
    assert [finding.name for finding in found.effects] == ["bias_structure"]
    (effect,) = Sensor.from_json(found.profile_json, "found").effects
    assert effect["parameters"]["edge"] == pytest.approx(moved["edge"], abs=0.1 * READ)
    assert effect["parameters"]["edge_length"] == pytest.approx(12.0, abs=4.0)
    for edge in (0.5 * READ, BIAS["edge"]):
        true = sensor_of(effects={"bias_structure": {**BIAS, "edge": edge}})
        assert diagnosed(true, known).effects == []


COLDER = 0.45  # of the charge
RATES = {
    "dark_current": {"per_second": 0.3 * READ},
    "dark_current_nonuniformity": {"rate": 0.1 * READ, "log_sigma": 0.8},
    "hot_pixels": {"fraction": 0.01, "rate": 4 * READ},
    "amplifier_glow": {
        "per_second": 0.3 * READ, "row": -1.0, "column": 1.0, "extent": 0.3,
    },
}  # fmt: skip
RATE_OF = {"dark_current_nonuniformity": "rate", "hot_pixels": "rate"}


def sensor_at(warmth):
    effects = {"dsnu": {"sigma": 0.3 * READ}}
    for name, parameters in RATES.items():
        rate = RATE_OF.get(name, "per_second")
        effects[name] = {**parameters, rate: warmth * parameters[rate]}
    return sensor_of(effects=effects)


@pytest.mark.slow
def test_a_colder_sensor_has_less_dark_current_and_no_other_effect():
    """Single darks do not tell the charge of hot pixels and of the glow from that of
    all: it is in the dark current, and what is left of it is said."""
    shots = [
        capture_of("dark", n, shape=(240, 320), exposure_time=time)
        for n, time in enumerate((2.0, 4.0, 30.0))
    ]
    cold = sensor_at(COLDER)
    darks = simulated(CaptureSet(cold, shots), cold).captures
    parts = [part for dark in darks for part in in_groups(dark, None)]
    found = diagnose(CaptureSet(sensor_at(1.0), parts), details=False, threads=2)
    assert [effect.name for effect in found.effects] == ["dark_current"]
    [dark] = found.effects
    rate = COLDER * RATES["dark_current"]["per_second"]
    assert rate < dark.parameters["per_second"].value < 1.25 * rate
    assert "K colder" in dark.sentence
    assert found.verdict == "partially_explained"
    assert any("most in darks of 30 s" in left.where for left in found.unexplained)
    [updated] = [
        effect
        for effect in Sensor.from_json(found.profile_json, "updated").effects
        if effect["name"] == "dark_current"
    ]
    assert updated["parameters"]["per_second"] == dark.parameters["per_second"].value
