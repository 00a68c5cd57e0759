# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Bins that state their responses, what is unseen, and the light of an image itself."""

import numpy as np
import pytest

import cg2raw
from cg2raw import _core
from cg2raw.spectra import STATISTICS, camera_from_spectra, simulate_spectra
from core.facts import spectral_bins

CENTRES = np.arange(400.0, 701.0, 20.0)
NAMES = [f"S0.{nm:.0f}nm" for nm in CENTRES]
SENSOR = cg2raw.Sensor("canon-600d")


def text_of(rows):
    return "".join(f"{nm!r}nm:{value!r};" for nm, value in rows)


def per_bin(responses=None, names=NAMES):
    """Camera RGB of a radiance of 1 in each bin, by stated responses or by boxes."""
    bins = spectral_bins(names, {}, responses or {})
    light = SENSOR.illuminant("D65")
    return _core.SpectralResponse(SENSOR.profile, light, bins, 100.0)


def boxes(width=20.0):
    """Responses of 0.7 that are boxes but for a millionth of a nanometre."""
    half, edge = width / 2, 1e-6
    return {
        name: text_of(
            [(nm - half, 0.0), (nm - half + edge, 0.7), (nm + half, 0.7)]
            + [(nm + half + edge, 0.0)]
        )
        for name, nm in zip(NAMES, CENTRES.tolist(), strict=True)
    }


def triangles(width=20.0):
    return {
        name: text_of([(nm - width, 0.0), (nm, 3.0), (nm + width, 0.0)])
        for name, nm in zip(NAMES, CENTRES.tolist(), strict=True)
    }


def test_responses_that_are_boxes_are_boxes():
    assert per_bin(boxes()).per_bin == pytest.approx(per_bin().per_bin, rel=1e-6)


def test_triangles_join_the_bins_by_straight_lines():
    """Between centres; beyond the last ones, all is the last bin's."""
    found = per_bin(triangles()).per_bin
    rng = np.random.default_rng(2)
    values = rng.random(len(CENTRES))
    fine = np.arange(380.0, 720.0001, 0.01)
    spectrum = np.interp(fine, CENTRES, values)
    table = SENSOR.spectral_sensitivities
    seen = np.stack([np.interp(fine, table["wavelengths"], c) for c in table["rgb"].T])
    wanted = np.trapezoid(seen * spectrum, fine, axis=1)
    ratio = (values @ found) / wanted
    assert ratio == pytest.approx(ratio[0], rel=1e-6)


def test_what_bins_state_shares_out_all_wavelengths():
    """A spectrum of 1 is one by any responses that leave no gap."""
    flat = per_bin(triangles()).per_bin.sum(axis=0)
    shifted = {
        name: text_of([(nm - 25, 0.1), (nm, 0.2 + i % 3), (nm + 25, 0.1)])
        for i, (name, nm) in enumerate(zip(NAMES, CENTRES.tolist(), strict=True))
    }
    found = per_bin(shifted)
    lower, upper = CENTRES[0] - 25, CENTRES[-1] + 25
    assert found.widths.sum(axis=0)[0] == pytest.approx(upper - lower)
    assert found.per_bin.sum(axis=0) == pytest.approx(flat, rel=2e-3)


def test_all_bins_state_a_response_or_none():
    some = dict(list(triangles().items())[1:])
    with pytest.raises(ValueError, match="channel S0.400nm states no response"):
        per_bin(some)
    wrong = triangles() | {"S0.500nm": "high"}
    with pytest.raises(ValueError, match="attribute S0.500nm, the response of that"):
        per_bin(wrong)


def test_endless_responses_are_refused():
    wild = {
        name: text_of([(380 + 1e-6 * i + 1e-4 * k, 1.0) for k in range(1500)])
        for i, name in enumerate(NAMES)
    }
    with pytest.raises(ValueError, match="more than 20000 wavelengths in all"):
        per_bin(wild)


def test_widths_tell_what_is_unseen():
    names = ["S0.300nm", "S0.400nm", "S0.500nm", "S0.1000nm"]
    assert per_bin(names=names).widths == pytest.approx(
        np.array([[100.0, 0.0], [100.0, 70.0], [300.0, 300.0], [500.0, 30.0]])
    )


def spectra(seed=5):
    return np.random.default_rng(seed).random((12, 16, len(CENTRES))).astype(np.float32)


def test_a_grey_world_is_grey():
    image = spectra()
    asked = {"illuminant": "estimate:mean", "white": 1000.0}
    camera = camera_from_spectra(SENSOR, image, CENTRES, **asked)
    frame = simulate_spectra(SENSOR, image, CENTRES, **asked)
    neutral = frame.simulation.illuminant.neutral
    mean = camera.reshape(-1, 3).mean(axis=0)
    assert mean / mean[1] == pytest.approx(neutral, rel=2e-6)


def test_the_brightest_is_each_bins_largest():
    image = spectra() * 0.1
    light = np.linspace(1.0, 2.0, len(CENTRES), dtype=np.float32)
    image[3, 4] = light
    image[0, 0, 2] = np.nan
    image[0, 1, 3] = -5.0
    asked = {"illuminant": "ESTIMATE:Max", "white": 1000.0}
    camera = camera_from_spectra(SENSOR, image, CENTRES, **asked)
    neutral = simulate_spectra(
        SENSOR, image, CENTRES, **asked
    ).simulation.illuminant.neutral
    assert camera[3, 4] / camera[3, 4, 1] == pytest.approx(neutral, rel=2e-6)


@pytest.mark.parametrize("name", STATISTICS)
def test_what_is_no_light_counts_as_none(name):
    """Of an image that is read in parts, the last of them smaller."""
    image = spectra() * 0.1
    image[3, 4, 1], image[5, 6, 2], image[7, 8, 3] = np.nan, np.inf, -5.0
    legal = image.copy()
    legal[3, 4, 1] = legal[5, 6, 2] = legal[7, 8, 3] = 0.0
    light = {"mean": legal.sum(axis=(0, 1)), "max": legal.max(axis=(0, 1))}[name]
    found = STATISTICS[name].of([image[:5], image[5:10], image[10:]])
    assert found == pytest.approx(light, rel=1e-6)  # of float32


@pytest.mark.parametrize(
    ("word", "message"),
    [
        ("estimate", "states no light's spectrum .* or estimate:mean"),
        ("estimate:median", "estimate as the image states, estimate:mean .grey world"),
        ("estimated", "unknown illuminant estimated"),
    ],
)
def test_other_estimates_are_refused(word, message):
    with pytest.raises(ValueError, match=message):
        camera_from_spectra(SENSOR, spectra(), CENTRES, illuminant=word, white=1.0)


def test_a_black_image_has_no_light():
    black = np.zeros((4, 4, len(CENTRES)), np.float32)
    with pytest.raises(ValueError, match="the image is black; name the light"):
        camera_from_spectra(
            SENSOR, black, CENTRES, illuminant="estimate:mean", white=1.0
        )
