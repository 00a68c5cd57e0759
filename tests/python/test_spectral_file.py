# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Files of spectral sensitivities: what is read, what a profile keeps, bad files."""

import json

import numpy as np
import pytest

import cg2raw
from cg2raw import _core
from cg2raw.profile.spectral import neutral_under, profile_from_ssf, spectral_field
from cg2raw.profile.spectral_file import (
    WAVELENGTHS,
    Sensitivities,
    SpectralTable,
    read_sensitivities,
)
from python.spectra import SENSOR, camera_json, three_lobes
from tiers import slow


def test_csv_and_json_hold_the_same_camera(written):
    rgb = three_lobes().rgb
    rows = [
        f"{wavelength:g},{b!r},{r!r},{g!r}"
        for wavelength, (r, g, b) in zip(WAVELENGTHS, rgb.tolist(), strict=True)
    ]
    text = "\n".join(["# Camera: Acme", "nm,B,R,G", *rows])
    from_csv = read_sensitivities(written(text, "camera.csv"))
    from_json = read_sensitivities(written(camera_json(rgb)))
    assert np.array_equal(from_csv.rgb, from_json.rgb)
    assert from_csv.rgb == pytest.approx(rgb, rel=1e-12, abs=1e-15)
    with pytest.raises(ValueError, match="do not tell make, model; give each"):
        profile_from_ssf(from_csv, **SENSOR)


def test_a_coarser_table_is_the_same_camera(written):
    rgb = three_lobes().rgb
    coarse = camera_json(rgb)
    rows = coarse["spectral_data"]["data"]
    rows["main"] = dict(list(rows["main"].items())[::2])
    found = neutral_under(read_sensitivities(written(coarse)), "A")
    assert found == pytest.approx(neutral_under(three_lobes(), "A"), rel=2e-3)


def test_a_profile_keeps_the_wavelengths_that_were_measured(written):
    fine = np.arange(375.0, 790.0, 2.5)
    curves = [np.interp(fine, WAVELENGTHS, c) for c in three_lobes().rgb.T]
    rows = [
        f"{w:g},{r!r},{g!r},{b!r}"
        for w, r, g, b in zip(fine, *map(np.ndarray.tolist, curves), strict=True)
    ]
    found = read_sensitivities(written("\n".join(rows), "fine.csv"))
    field = spectral_field(found)
    assert field["wavelengths"] == fine.tolist()
    assert field["R"] == pytest.approx(curves[0] / np.max(curves), abs=1e-6)
    assert field["scale"] == pytest.approx(np.max(curves), rel=1e-12)


def table_of(wavelengths):
    """Return Sensitivities that are measured there, each its wavelength over 800."""
    rgb = np.repeat(np.asarray(wavelengths, float)[:, None] / 800, 3, axis=1)
    return Sensitivities("t.csv", rgb, table=SpectralTable(np.array(wavelengths), rgb))


def test_rows_that_lie_anywhere_farther_apart_than_5_nm_give_way_to_a_curve():
    fine = np.arange(380.0, 781.0, 2.5)
    five = np.arange(380.0, 781.0, 5.0)
    for rows, kept in (
        (fine, fine),
        (five, five),
        (np.delete(fine, [40, 41]), five),  # 2.5 nm, and once 7.5 nm
        (five[::2], five),
    ):
        field = spectral_field(table_of(rows))
        assert field["wavelengths"] == kept.tolist()
        assert field["G"] == pytest.approx(kept / 800, abs=1e-6)


def test_a_profile_has_0_where_nothing_was_measured(written):
    rows = [
        f"{w:g},{r!r},{g!r},{b!r}"
        for w, (r, g, b) in zip(WAVELENGTHS, three_lobes().rgb.tolist(), strict=True)
        if 400 <= w <= 720 and w % 10 == 0
    ]
    path = written("\n".join(rows), "short.csv")
    profile = profile_from_ssf(
        path, **SENSOR, make="Acme", model="One", lights=["A", "D65", "FL2"]
    )
    field = profile["spectral_sensitivities"]
    assert field["wavelengths"] == WAVELENGTHS.tolist()
    assert np.array(field["R"])[WAVELENGTHS > 720].max() == 0.0
    assert np.array(field["B"])[WAVELENGTHS < 400].max() == 0.0
    source = profile["sources"]["spectral_sensitivities"]
    assert source == (
        "short.csv; rows of 10 nm, a monotone curve through them; 0 outside 400 to "
        "720 nm, not measured"
    )
    near = np.array(field["G"]) - three_lobes().rgb[:, 1]
    assert np.abs(near).max() < 0.01


def edited(edit):
    document = camera_json(three_lobes().rgb)
    rows = document["spectral_data"]["data"]["main"]
    edit(document["spectral_data"], rows)
    return document


def swapped(data, rows):
    data["data"]["main"] = dict(reversed(rows.items()))


BAD = {
    "no JSON": ("{", "is no JSON"),
    "no data": ({"header": {}}, "spectral_data.index.main is missing"),
    "no row": (edited(lambda d, r: r.clear()), "holds no row"),
    "falling": (edited(swapped), "wavelength 775 nm comes after 780 nm"),
    "gap": (edited(lambda d, r: r.pop("550")), "a gap from 545 to 555 nm"),
    "short": (
        edited(lambda d, r: [r.pop(f"{w}") for w in range(600, 781, 5)]),
        "wavelengths 380 to 595 nm must cover 400 to 690",
    ),
    "channel": (
        edited(lambda d, r: d["index"].update(main=["R", "G", "X"])),
        "must name the channel B once",
    ),
    "twice": (
        edited(lambda d, r: d["index"].update(main=["R", "R", "B"])),
        "must name the channel R once",
    ),
    "two values": (edited(lambda d, r: r["500"].pop()), "'500' must be a list of 3"),
    "text": (
        edited(lambda d, r: r["500"].__setitem__(1, "x")),
        "'500' 'x' must be a finite number",
    ),
    "nan": (
        edited(lambda d, r: r["500"].__setitem__(1, float("nan"))),
        "'500' nan must be a finite number",
    ),
    "wavelength": (edited(lambda d, r: r.update(x=r["500"])), "wavelength 'x' must be"),
    "negative": (
        edited(lambda d, r: r["700"].__setitem__(2, -0.05)),
        "B at 700 nm is -0.05; noise may reach -0.007",
    ),
    "blind": (
        edited(lambda d, r: [row.__setitem__(0, 0.0) for row in r.values()]),
        "R is nowhere above 0",
    ),
    "huge": (
        edited(lambda d, r: r["500"].__setitem__(1, 10**400)),
        "'500' 1000.* must be a finite number",
    ),
    "deep": ('{"a":' * 100000, "is no JSON"),
    "wide": ("4" * 200000 + ",1,2,3", "is no CSV"),
    "repeated": ('{"a": 1, "a": 2}', "'a' stands there twice"),
    "columns": (
        "400,1,2\n405,1,2\n",
        ":1: has 3 cells, and a table without names has 4",
    ),
    "header": ("nm,R,G\n400,1,2\n", "line 1 .* must name the channel B once"),
    "empty": ("", "holds no row"),
}


def test_wavelengths_from_400_to_690_nm_are_enough(written):
    rows = zip(WAVELENGTHS.tolist(), three_lobes().rgb, strict=True)
    lines = [f"{w},{r},{g},{b}" for w, (r, g, b) in rows if 400 <= w <= 690]
    found = read_sensitivities(written("\n".join(lines), "just.csv"))
    assert found.measured().wavelengths[[0, -1]].tolist() == [400, 690]
    for cut, ends in ((lines[1:], "405 to 690"), (lines[:-1], "400 to 685")):
        with pytest.raises(ValueError, match=f"{ends} nm must cover 400 to 690 nm"):
            read_sensitivities(written("\n".join(cut), "cut.csv"))


@pytest.mark.parametrize("case", BAD)
def test_a_bad_file_is_refused_in_one_line(written, case):
    content, message = BAD[case]
    path = written(content)
    with pytest.raises(ValueError, match=message) as caught:
        read_sensitivities(path)
    assert str(caught.value).startswith(f"{path}:")
    assert "\n" not in str(caught.value)


def test_a_file_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(ValueError, match="none.json: No such file"):
        read_sensitivities(tmp_path / "none.json")


MONO = {**SENSOR, "cfa": "mono", "make": "Acme", "model": "Mono"}


@pytest.mark.parametrize("head", ["nm,QE", "nm,mono", "wavelength,R,mono"])
def test_a_sensor_without_filters_has_one_curve(written, head):
    """Named, or the only column; its profile has no matrices and no neutrals."""
    curve = three_lobes().rgb.max(axis=1)
    others = ["0.5"] * (head.count(",") - 1)
    rows = [
        ",".join([f"{w:g}", *others, repr(value)])
        for w, value in zip(WAVELENGTHS, curve.tolist(), strict=True)
    ]
    profile = profile_from_ssf(written("\n".join([head, *rows]), "qe.csv"), **MONO)
    field = profile["spectral_sensitivities"]
    assert set(field) == {"unit", "scale", "wavelengths", "mono"}
    assert field["mono"] == pytest.approx(curve / curve.max(), abs=1e-6)
    assert not [name for name in profile if "matrix" in name or name == "illuminants"]
    assert set(profile["sources"]) <= set(profile)
    assert profile["black_level"] == [1024]


def test_a_mono_sensor_has_no_matrix_of_a_lamp(written):
    path = written("nm,QE\n" + "\n".join(f"{w:g},0.5" for w in WAVELENGTHS), "qe.csv")
    with pytest.raises(ValueError, match="no matrix that light 'FL2' could have"):
        profile_from_ssf(path, **MONO, lamps=["FL2"])


@pytest.mark.parametrize("step", [2, slow(1)])
def test_quantum_efficiencies_are_the_same_camera(written, step):
    """A photon of twice the wavelength has half the energy."""
    rgb = three_lobes().rgb[::step]
    photons = rgb / WAVELENGTHS[::step, None]
    found = []
    for curves, unit in ((rgb, "energy"), (photons, "photon")):
        rows = [
            f"{w:g},{r!r},{g!r},{b!r}"
            for w, (r, g, b) in zip(WAVELENGTHS[::step], curves.tolist(), strict=True)
        ]
        path = written("\n".join(rows), f"{unit}.csv")
        profile = profile_from_ssf(
            path, **SENSOR, make="Acme", model="One", lights=["A"], unit=unit
        )
        assert profile["spectral_sensitivities"]["unit"] == unit
        sensor = cg2raw.Sensor.from_json(json.dumps(profile))
        seen = _core.seen_by_sensitivities(sensor.profile, "A").split(":")[1:]
        stated = profile["illuminants"]["neutrals"][0]
        assert [float(word) for word in seen] == pytest.approx(stated, rel=2e-4)
        found.append([*profile["color_matrix_1"], *stated])
    assert found[1] == pytest.approx(found[0], abs=2e-3)
    with pytest.raises(ValueError, match="unit 'watt' must be one of energy, photon"):
        read_sensitivities(path, unit="watt")
