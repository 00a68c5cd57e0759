# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""spectral_image.h: which channels are a spectrum, and what a sensor sees of it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import cg2raw
from cg2raw import _core
from cg2raw.profile.illuminant_spectra import illuminant_spectrum
from cg2raw.profile.spectral_file import WAVELENGTHS
from cg2raw.spectra import camera_from_spectra, simulate_spectra
from core.facts import spectral_bins
from oracles import cameras, spectral

NAMES = {
    "S0.550,0nm": 550.0,
    "S0.550nm": 550.0,
    "S0.405,000nm": 405.0,
    "S0.5,5e-7m": 550.0,
    "S0.5,5E-7m": 550.0,
    "S0.0,55um": 550.0,
    "S0.545,0772THz": 550.0,
    "S0.545077,2e9Hz": 550.0,
}


@pytest.mark.parametrize("name", NAMES)
def test_a_name_says_its_wavelength(name):
    found = spectral_bins(["S0.700,0nm", "R", name])
    assert found.channels == [2, 0]
    assert found.wavelengths == pytest.approx([NAMES[name], 700.0], rel=1e-6)


@pytest.mark.parametrize(
    "name",
    [
        *("S1.550nm", "S0", "S0.", "S0.nm", "S0.m", "S0.Hz", "S0.550", "S0.550,nmm"),
        *("s0.550nm", "S0.-550nm", "S0.5.5e2nm", "S0.1e99nm", "S0.0nm", "S0.nan nm"),
        *("S0.550nm.600nm", "X.550nm", "550nm", "S0.,nm", "S0.e5nm", "S00.550nm"),
        "S0." + "9" * 5000 + "nm",
    ],
)
def test_other_names_are_no_bins(name):
    assert spectral_bins(["R", "G", "B", name]) is None


def test_wavelengths_of_attributes_are_metres():
    stated = {"wl0": 7e-7, "wl1": 4.5e-7, "wl2": 5.5e-7}
    found = spectral_bins(["wl0", "A", "wl1", "wl2"], stated)
    assert found.channels == [2, 3, 0]
    assert found.wavelengths == pytest.approx([450.0, 550.0, 700.0])


WRONG = {
    "reflectance": (["R", "T.400nm", "T.500nm"], {}, "is a reflectance .* render it"),
    "one": (["S0.400nm", "R"], {}, "S0.400nm is the only bin"),
    "twice": (
        ["S0.400nm", "S0.400,0nm"],
        {},
        "S0.400nm and S0.400,0nm are of one wavelength",
    ),
    "nm for m": (["a", "b"], {"a": 400.0, "b": 500.0}, "channel a has a wavelength of"),
    "negative": (["a", "b"], {"a": -4e-7, "b": 5e-7}, "channel a has a wavelength of"),
}


@pytest.mark.parametrize("case", WRONG)
def test_wrong_channels_are_refused(case):
    names, stated, message = WRONG[case]
    with pytest.raises(ValueError, match=message):
        spectral_bins(names, stated)


TEXTS = {
    "550nm:0.3;560nm:0.4;": [(550.0, 0.3), (560.0, 0.4)],
    "560.0nm:0.4; 550nm:3e-1": [(550.0, 0.3), (560.0, 0.4)],
    "0.55um:1;5.6e-7m:0;": [(550.0, 1.0), (560.0, 0.0)],
    "\t550nm : 1 ;\n500THz:2;;": None,
    "500THz:2;550nm:1;": [(550.0, 1.0), (599.584916, 2.0)],
}


@pytest.mark.parametrize("text", TEXTS)
def test_a_text_says_a_spectrum(text):
    if TEXTS[text] is None:
        with pytest.raises(ValueError, match="must be pairs of wavelength and value"):
            _core.spectrum_from_text(text)
        return
    found = np.array(_core.spectrum_from_text(text))
    assert found == pytest.approx(np.array(TEXTS[text]))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "two or more wavelengths, and a value above 0"),
        ("550nm:1", "two or more wavelengths"),
        ("550nm:0;560nm:0", "a value above 0"),
        ("550nm:1;550,0nm:1", "must be pairs"),
        ("550nm:1;0.55um:2", "has 550 nm twice"),
        ("550nm:1;560nm:-1", "not negative, not -1 at 560 nm"),
        ("550nm:1;560nm:nan", "must be pairs"),
        ("550nm:1;560nm:inf", "finite"),
        ("D65", 'spectrum "D65" must be pairs'),
        ("550nm;560nm", "must be pairs"),
        ("x" * 5000, 'spectrum "' + "x" * 24 + ' ..." must be'),
    ],
)
def test_other_texts_are_none(text, message):
    with pytest.raises(ValueError, match=message):
        _core.spectrum_from_text(text)


@given(st.text(alphabet="0123456789.:;,eE+- nmuTHzkM\x00", max_size=60))
def test_any_text_is_a_spectrum_or_one_error(text):
    try:
        found = np.array(_core.spectrum_from_text(text))
    except ValueError as error:
        assert str(error)
        return
    assert (np.diff(found[:, 0]) > 0.0).all()
    assert (found[:, 1] >= 0.0).all() and found[:, 1].max() > 0.0


def simpson(nodes, function):
    """Integral of what is a parabola between nodes, exactly."""
    a, b = nodes[:-1], nodes[1:]
    middle = function((a + b) / 2)
    return ((b - a) / 6 * (function(a) + 4 * middle + function(b))).sum()


def curves(sensor):
    """The sensitivities of R, G and B as functions of nm."""
    table = sensor.spectral_sensitivities
    return [
        lambda at, c=c: np.interp(at, table["wavelengths"], c, 0.0, 0.0)
        for c in table["rgb"].T
    ]


def scale_of(sensor, light, white):
    """What makes 1 of the channel that sees most of white."""
    spectrum = sensor.spectrum(sensor.illuminant(light))
    nodes = spectrum["wavelengths"]

    def power(at):
        return np.interp(at, nodes, spectrum["power"])

    def luminosity(at):
        return np.interp(at, WAVELENGTHS, spectral.observer()[:, 1])

    lumens = 683.0 * simpson(nodes, lambda at: power(at) * luminosity(at))
    seen = [simpson(nodes, lambda at, c=c: power(at) * c(at)) for c in curves(sensor)]
    return lumens / white / max(seen)


SAMPLINGS = {
    "5 nm": np.arange(380.0, 781.0, 5.0),
    "10 nm": np.arange(400.0, 701.0, 10.0),
    "40 nm": np.arange(400.0, 681.0, 40.0),
    "irregular": np.array([395.0, 404.66, 435.83, 500.0, 546.07, 577.0, 611.6, 700.0]),
    "fine": np.linspace(380.5, 779.5, 400),
    "wide": np.arange(100.0, 2501.0, 12.5),
}


@pytest.mark.parametrize("sampling", SAMPLINGS)
@pytest.mark.parametrize("id", ["canon-600d", "nikon-d850"])
def test_bins_are_integrals_of_the_sensitivities(id, sampling):
    """Against float64: 2e-6 of full scale."""
    sensor, centres = cg2raw.Sensor(id), SAMPLINGS[sampling]
    middles = (centres[1:] + centres[:-1]) / 2
    ends = 1.5 * centres[[0, -1]] - 0.5 * centres[[1, -2]]
    edges = np.concatenate([ends[:1], middles, ends[1:]])
    table = sensor.spectral_sensitivities["wavelengths"]
    edges = np.clip(edges, table[0], table[-1])  # 0 outside, by a step
    nodes = np.union1d(edges, table)
    seen = [
        [simpson(nodes[(nodes >= a) & (nodes <= b)], curve) for curve in curves(sensor)]
        for a, b in zip(edges, edges[1:], strict=False)
    ]
    radiance = np.random.default_rng(2).random((6, 7, len(centres)), dtype=np.float32)
    relative = radiance.astype(np.float64) @ np.array(seen)
    white = scale_of(sensor, "D65", 1.0) * relative.max()  # the brightest pixel is 1
    expected = relative / relative.max()
    found = camera_from_spectra(
        sensor, radiance, centres, illuminant="D65", white=white
    )
    assert np.abs(found - expected).max() < 2e-6


@pytest.mark.parametrize("light", ["A", "D65", "FL2", "LED-B3", "3200K"])
def test_white_saturates_the_first_channel(light):
    sensor = cg2raw.Sensor("sony-a7s-ii")
    power = illuminant_spectrum(light)
    lumens = 683.0 * 5.0 * (power @ spectral.observer()[:, 1])
    radiance = (100.0 / lumens * power).astype(np.float32)[None, None]
    camera = camera_from_spectra(
        sensor, radiance, WAVELENGTHS, illuminant=light, white=100.0
    )[0, 0]
    assert camera.max() == pytest.approx(1.0, rel=6e-3)
    word = _core.seen_by_sensitivities(sensor.profile, light)
    neutral = np.array(sensor.illuminant(word).neutral)
    assert camera / camera.max() == pytest.approx(neutral / neutral.max(), rel=6e-3)


def test_words_that_are_neutrals_stay():
    sensor = cg2raw.Sensor("canon-600d").profile
    for word in ("neutral:0.5:0.6", "sample:3", "xy:0.3:0.3", "FL2"):
        assert _core.seen_by_sensitivities(sensor, word) == word
    assert _core.seen_by_sensitivities(sensor, "D65").startswith("neutral:0.421")


def test_frames_are_those_of_their_camera_rgb():
    sensor = cg2raw.Sensor("canon-5d-mark-iv")
    rng = np.random.default_rng(4)
    spectra = rng.random((20, 30, 8)) * 0.4
    spectra[3, 4] = -1.0
    spectra[5, 6, 2] = np.nan
    centres = np.linspace(420, 700, 8)
    asked = {"illuminant": "A", "white": 3000.0}
    raw = simulate_spectra(sensor, spectra, centres, **asked, iso=800, seed=3)
    camera = camera_from_spectra(sensor, spectra, centres, **asked)
    assert np.isnan(camera[5, 6]).all()
    word = _core.seen_by_sensitivities(sensor.profile, "A")
    run = {"camera_input": True, "convention": "sensor", "iso": 800, "seed": 3}
    assert np.array_equal(raw, sensor.simulate(camera, illuminant=word, **run))
    black = sensor.black_level[0]
    assert abs(float(raw[3, 4]) - black) < 60


def test_what_cannot_be_is_said():
    sensor = cg2raw.Sensor("canon-600d")
    spectra, centres = np.ones((2, 2, 3), np.float32), [400.0, 500.0, 600.0]
    asked = {"illuminant": "D65", "white": 1.0}
    for changes, message in (
        ({"white": 0.0}, "luminance of white 0 cd/m2 must be"),
        ({"white": float("nan")}, "luminance of white"),
        ({"wavelengths": [400.0, 600.0, 500.0]}, "numbers in nm that rise"),
        ({"wavelengths": [400.0, 500.0, 500.0]}, "numbers in nm that rise"),
        ({"wavelengths": [400.0]}, "two or more"),
        ({"wavelengths": [400.0, 500.0]}, r"shape \(height, width, 2\)"),
        ({"wavelengths": [1000.0, 1100.0, 1200.0]}, "sees nothing of 1000 to 1200 nm"),
        ({"spectra": np.ones((2, 2, 3), int)}, "spectra must be float"),
        ({"spectra": np.ones((2, 3))}, "shape"),
        ({"illuminant": "moon"}, "unknown illuminant moon"),
    ):
        words = {"spectra": spectra, "wavelengths": centres, **asked, **changes}
        with pytest.raises(ValueError, match=message):
            camera_from_spectra(
                sensor, words.pop("spectra"), words.pop("wavelengths"), **words
            )
    with pytest.raises(ValueError, match="nikon-d40 has no spectral_sensitivities"):
        camera_from_spectra(cg2raw.Sensor("nikon-d40"), spectra, centres, **asked)


def test_quantum_efficiencies_count_photons():
    """A flat one is a response to energy that rises with the wavelength."""
    peak = [float(300 <= w <= 860) for w in range(380, 781, 5)]
    field = {
        "unit": "photon",
        "wavelengths": list(range(380, 781, 5)),
        **{name: peak for name in "RGB"},
    }
    ramp = [w / 555 for w in range(380, 781, 5)]
    energy = {**field, "unit": "energy", **{name: ramp for name in "RGB"}}
    found = []
    for table in (field, energy):
        text = cameras.profile_text(spectral_sensitivities=table)
        sensor = cg2raw.Sensor.from_json(text)
        light = sensor.illuminant("D65")
        centres = [450.0, 550.0, 650.0]
        found.append(
            _core.SpectralResponse(sensor.profile, light, centres, 1.0).per_bin
        )
    assert found[0] == pytest.approx(found[1], rel=1e-9)


@given(
    st.lists(
        st.text(alphabet="S0123T.,eE+-nmkMGHzRwl \x00\u00e9", max_size=24)
        | st.text(max_size=12)
        | st.from_regex(
            r"S[0-3]\.[0-9]{0,6},?[0-9]{0,6}([eE][+-]?[0-9])?(n|u|T)?(m|Hz)"
        ),
        max_size=12,
    ),
    st.dictionaries(st.text(max_size=4), st.floats(), max_size=4),
)
def test_any_names_are_bins_none_or_one_error(names, stated):
    try:
        found = spectral_bins(names, stated)
    except (UnicodeEncodeError, TypeError):  # lone surrogates are no text of a file
        return
    except ValueError as error:
        assert str(error)
        return
    if found is not None:
        assert (np.diff(found.wavelengths) > 0.0).all()
        assert len(set(found.channels)) == len(found.channels) >= 2
        assert all(1.0 <= nm <= 1e6 for nm in found.wavelengths)
