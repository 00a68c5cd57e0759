# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""spectrum.h: the field spectral_sensitivities of a profile, and the bundled tables."""

import json

import numpy as np
import pytest

import cg2raw
from oracles import cameras

WAVELENGTHS = list(range(380, 781, 10))
BUNDLED = (
    "canon-1ds-mark-iii canon-5d canon-5d-mark-iv canon-600d nikon-d850 sony-a7s-ii"
).split()


def table(**changes):
    """Return a legal field with changes; None leaves a part out."""
    peaks = {"R": 600, "G": 540, "B": 460}
    curves = {
        name: [float(np.exp(-(((w - at) / 40) ** 2))) for w in WAVELENGTHS]
        for name, at in peaks.items()
    }
    whole = {"unit": "energy", "scale": 1.0, "wavelengths": WAVELENGTHS, **curves}
    return {k: v for k, v in {**whole, **changes}.items() if v is not None}


def load(field, **fields):
    text = cameras.profile_text(spectral_sensitivities=field, **fields)
    return cg2raw.Sensor.from_json(text, name="inline.json")


def test_a_table_is_kept_as_it_is():
    field = table(unit="photon", scale=0.55)
    kept = load(field).spectral_sensitivities
    assert (kept["unit"], kept["scale"]) == ("photon", 0.55)
    assert kept["wavelengths"].tolist() == WAVELENGTHS
    for i, name in enumerate("RGB"):
        assert kept["rgb"][:, i].tolist() == field[name]
    again = json.loads(load(field).to_json())["spectral_sensitivities"]
    assert again == field


def test_unit_and_scale_have_the_defaults_of_a_camera_measurement():
    kept = load(table(unit=None, scale=None)).spectral_sensitivities
    assert (kept["unit"], kept["scale"]) == ("energy", 1.0)


def test_a_profile_needs_none():
    assert cg2raw.Sensor("nikon-d40").spectral_sensitivities is None


def test_a_monochrome_sensor_has_one_curve():
    curve = table()["G"]
    field = table(R=None, G=None, B=None, mono=curve)
    sensor = cg2raw.Sensor.from_json(cameras.mono_text(spectral_sensitivities=field))
    assert (sensor.spectral_sensitivities["rgb"].T == curve).all()
    assert json.loads(sensor.to_json())["spectral_sensitivities"] == field


def changed(name, at, value):
    return {name: [*table()[name][:at], value, *table()[name][at + 1 :]]}


WRONG = {
    "no wavelengths": (table(wavelengths=None), "wavelengths.*missing"),
    "no blue": (table(B=None), r"spectral_sensitivities\.B.*missing"),
    "other field": (table(W=[1]), "W is unknown; known here:"),
    "too few": (table(G=[1.0]), "G has 1 values; it needs one per wavelength, 41"),
    "text": (table(**changed("G", 3, "x")), "must be a number"),
    "falling": (
        table(**changed("wavelengths", 5, 410)),
        "wavelength 410 nm comes after 420 nm; they must rise",
    ),
    "gap": (
        table(
            **{
                k: v[:10] + v[12:]
                for k, v in table().items()
                if k not in ("unit", "scale")
            }
        ),
        "a gap from 470 to 500 nm; at most 20 nm",
    ),
    "short": (
        table(**{k: v[2:] for k, v in table().items() if k not in ("unit", "scale")}),
        "wavelengths 400 to 780 nm must cover 380 to 780 nm; state 0",
    ),
    "metres": (
        table(wavelengths=[w * 1e-9 for w in WAVELENGTHS]),
        "wavelength 3.8e-07 must be 100 to 5000 nm",
    ),
    "blind": (table(R=[0.0] * 41), "R is nowhere above 0"),
    "negative": (table(**changed("B", 40, -0.02)), "B falls to -0.02; noise may reach"),
    "unit": (table(unit="relative"), '"relative" must be energy .* or photon'),
    "scale": (table(scale=0), "scale 0 must be above 0"),
    "list": ([], "must be an object|an object"),
    "empty": (table(wavelengths=[], R=[], G=[], B=[]), "at least two wavelengths"),
}


@pytest.mark.parametrize("case", WRONG)
def test_a_wrong_table_is_refused_in_one_line(case):
    field, message = WRONG[case]
    with pytest.raises(ValueError, match=message) as caught:
        load(field)
    assert str(caught.value).startswith("inline.json: ")
    assert "\n" not in str(caught.value)


def test_those_who_have_sensitivities_name_their_source():
    found = [
        id
        for id in cg2raw.installed_profiles()
        if cg2raw.Sensor(id).spectral_sensitivities is not None
    ]
    assert set(BUNDLED) <= set(found)
    for id in BUNDLED:
        source = dict(cg2raw.Sensor(id).sources)["spectral_sensitivities"]
        assert "Apache-2.0" in source and "not fitted to them" in source


@pytest.mark.parametrize("id", BUNDLED)
def test_bundled_tables_are_those_that_were_measured(id, camera_data):
    sensor = cg2raw.Sensor(id)
    source = dict(sensor.sources)["spectral_sensitivities"]
    file = next(word for word in source.split() if word.endswith(".json"))
    path = camera_data / "tables/ssf/rawtoaces-data/data/camera" / file
    rows = json.loads(path.read_text())["spectral_data"]["data"]["main"]
    kept = sensor.spectral_sensitivities
    assert kept["wavelengths"].tolist() == [float(w) for w in rows]
    measured = np.array(list(rows.values()))
    assert kept["rgb"] * kept["scale"] == pytest.approx(measured, abs=1e-6)
