# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What the numbers of a file mean: its curve, and its alpha."""

import numpy as np
import pytest

from cg2raw import _core
from core.facts import facts, picture, picture_layer

# Remedies
WORDS = _core.Dialect(lambda *_: "LINEARIZE", lambda _: True, "CONVERT", "LINEAR")
STATED = {
    "icc_profile": "ICCProfile:profile_description",
    "transfer": "dpx:Transfer",
    "gamma": "oiio:Gamma",
}


def encoded(space, samples="uint8", undo="stated", channels="RGB", **said):
    """Return what is decided of an image's numbers."""
    stated = {STATED[n]: (v,) if n == "gamma" else v for n, v in said.items()}
    stated |= {
        "oiio:ColorSpace": space,
        "oiio:UnassociatedAlpha": (channels == "RGBa",),
    }
    image = facts([("", channels.upper())], stated, samples)
    return picture(image, undo, WORDS)


def curve(*arguments, **said):
    """Return the name of the curve of an image."""
    return encoded(*arguments, **said).undone


SRGB, LINEAR = "srgb_rec709_scene", "lin_rec709_scene"
CURVES = [  # space, samples, undo, others: name
    *[(("", samples, undo, {}), "") for samples in ("half", "float", "double")
      for undo in ("none", "stated", "stated-or-srgb")],
    *[(("", samples, undo, {}), "srgb") for samples in ("uint8", "uint16")
      for undo in ("srgb", "stated-or-srgb")],
    *[((LINEAR, samples, undo, {}), "") for samples in ("uint8", "uint32", "half")
      for undo in ("none", "stated", "stated-or-srgb")],
    *[((SRGB, samples, undo, {}), "srgb") for samples in ("uint8", "uint16", "float")
      for undo in ("srgb", "stated", "stated-or-srgb")],
    (("sRGB", "uint8", "srgb", {"icc_profile": "sRGB IEC61966-2.1"}), "srgb"),
    (("", "uint8", "stated", {"icc_profile": "sRGB IEC61966-2.1"}), "srgb"),
    (("", "uint16", "srgb", {"transfer": "Undefined"}), "srgb"),
    (("g22_rec709_scene", "uint8", "stated", {"gamma": 2.2}), "g2.2"),
    ((LINEAR, "uint8", "none", {"icc_profile": "Adobe RGB (1998)"}), ""),
]  # fmt: skip


@pytest.mark.parametrize(("said", "name"), CURVES)
def test_the_curve_is_the_one_that_is_stated_or_asked_for(said, name):
    space, samples, undo, others = said
    assert curve(space, samples, undo, **others) == name


REFUSED = [  # space, samples, undo, others, words of the message
    *[("", samples, undo, {}, "LINEARIZE if sRGB.* LINEAR .* CONVERT")
      for samples in ("uint8", "uint16") for undo in ("none", "stated")],
    *[("", "uint32", undo, {}, "needs 8 or 16 bits.* LINEAR")
      for undo in ("none", "srgb", "stated")],
    (SRGB, "uint8", "none", {}, "LINEARIZE, or LINEAR .* CONVERT"),
    (SRGB, "float", "none", {}, "LINEARIZE"),
    # What is asked for is never ignored.
    ("", "float", "srgb", {}, "LINEARIZE: its floats state no colour space"),
    (LINEAR, "half", "srgb", {}, "LINEARIZE: .* no curve to undo"),
    ("ACEScg", "half", "srgb", {}, "LINEARIZE: .*ACEScg.* nor sRGB"),
    # Other curves are not sRGB's.
    ("g22_rec709_scene", "uint8", "srgb", {"gamma": 2.2}, "g22_rec709_scene"),
    ("Rec709", "uint8", "stated", {}, "Rec709"),
    ("KodakLog", "uint16", "srgb", {}, "KodakLog"),
    (SRGB, "uint8", "srgb", {"icc_profile": "Display P3"}, "Display P3"),
    ("", "uint16", "srgb", {"icc_profile": "Adobe RGB (1998)"}, "Adobe RGB"),
    ("", "uint16", "srgb", {"transfer": "Printing density"}, "Printing density"),
    (SRGB, "uint16", "stated", {"transfer": "ITU-R 709-4"}, "ITU-R 709-4"),
    ("srgb_p3d65_scene", "uint8", "stated", {}, "srgb_p3d65_scene"),
    (SRGB, "uint32", "srgb", {}, "needs 8 or 16 bits"),
]  # fmt: skip


@pytest.mark.parametrize(("space", "samples", "undo", "others", "words"), REFUSED)
def test_what_is_no_light_is_refused_with_the_remedy(
    space, samples, undo, others, words
):
    with pytest.raises(ValueError, match=rf"\A[^\n]*{words}[^\n]*\Z"):
        curve(space, samples, undo, **others)


def srgb_of_specification(code):
    """Return light of sRGB values 0..1. Source: IEC 61966-2-1."""
    code = np.float64(code)
    power = ((np.maximum(code, 0) + 0.055) / 1.055) ** 2.4
    return np.where(code <= 0.04045, code / 12.92, power)


def decoded(pixels, alpha="none", levels=0, name="srgb"):
    """Return the light of (N, 3 or 4) numbers behind a curve."""
    spaces = {"srgb": SRGB, "": LINEAR, "g1.8": "g18_rec709", "g2.2": "g22_rec709"}
    said = {"gamma": float(name[1:])} if name[:1] == "g" else {}
    samples = {0: "float", 256: "uint8", 65536: "uint16"}[levels]
    channels = {"none": "RGB", "associated": "RGBA", "unassociated": "RGBa"}[alpha]
    decoder = encoded(spaces[name], samples, "stated", channels, **said).decoder
    return decoder.decode(np.array(pixels, np.float32)[None])[0]


@pytest.mark.parametrize("levels", [256, 65536])
@pytest.mark.parametrize("name", ["", "srgb", "g1.8", "g2.2"])
def test_codes_are_the_curves_in_float32(name, levels):
    code = np.arange(levels) / (levels - 1)
    light = (
        srgb_of_specification(code) if name == "srgb" else code ** float(name[1:] or 1)
    )
    # As hosts make floats of them: divided, or times the rounded reciprocal.
    for numbers in (
        code.astype(np.float32),
        np.arange(levels, dtype=np.float32) * np.float32(1 / (levels - 1)),
    ):
        found = decoded(np.stack([numbers] * 3, -1), "none", levels, name)[:, 1]
        assert found[0] == 0 and found[-1] == 1
        # half a unit in the last place of float32, and float64's own error
        off = np.abs(found / np.maximum(light, 1e-30) - 1)[1:]
        assert off.max() <= 2**-24 + 1e-15


def test_floats_have_the_curve_in_float32_to_the_bit():
    """Polynomials stand for the power of the curve, from 2^-5 to 2."""
    first, last = np.array([0.03, 2.1], np.float32).view(np.uint32)
    code = np.arange(first, last, 257, dtype=np.uint32)[:199998].view(np.float32)
    assert code[-1] > 2
    found = decoded(code.reshape(-1, 3)).ravel()
    light = srgb_of_specification(code.astype(np.float64)).astype(np.float32)
    np.testing.assert_array_equal(found, light)


def test_floats_have_the_curve_too():
    code = np.array([-0.5, 0, 0.04, 0.0405, 0.3, 1, 7.5], np.float32)
    found = decoded(np.stack([code] * 3, -1))[:, 2]
    np.testing.assert_allclose(found, srgb_of_specification(code), rtol=1e-6)
    wild = decoded([[np.nan, np.inf, -np.inf]])[0]
    assert np.isnan(wild[0]) and wild[1] == np.inf and wild[2] < 0


@pytest.mark.parametrize("name", ["", "srgb"])
def test_the_curve_is_undone_before_alpha_is_multiplied_in(name):
    pixels = [[0.8, 0.5, 0.2, alpha] for alpha in (0, 0.25, 1)]
    light = np.array(pixels)[:, :3]
    light = srgb_of_specification(light) if name else light
    over_black = light * np.array([[0], [0.25], [1]])
    found = decoded(pixels, "unassociated", 0, name)
    np.testing.assert_allclose(found, over_black, rtol=1e-6)


def test_an_associated_alpha_is_not_multiplied_twice():
    straight = np.array([[0.8, 0.5, 0.2]])
    associated = np.concatenate([straight * 0.25, [[0.25]]], axis=1)
    found = decoded(associated, "associated")
    np.testing.assert_allclose(found, srgb_of_specification(straight) / 4, rtol=1e-6)
    decoder = encoded("", "half", "none", "RGBA").decoder  # an OpenEXR file
    assert decoder.is_identity and not decoder.needs_alpha
    # What shines through without covering: colour under an associated alpha of 0.
    glow = decoded([[0.5, 0.5, 0.5, 0]], "associated")
    np.testing.assert_allclose(glow, srgb_of_specification(glow * 0 + 0.5), rtol=1e-6)


@pytest.mark.parametrize("color", [np.nan, np.inf, -np.inf, 1e30])
@pytest.mark.parametrize("alpha", [0.0, -0.0, np.nan])
def test_what_is_transparent_is_black_whatever_its_colour(color, alpha):
    for name in ("", "srgb"):
        found = decoded([[color, color, color, alpha]], "unassociated", 0, name)
        assert (found == 0).all()


@pytest.mark.parametrize("levels", [256, 65536])
def test_alpha_of_whole_numbers_is_their_share_of_the_largest(levels):
    top = levels - 1
    codes = np.array([[top, top, top, code] for code in range(levels)], np.float32)
    found = decoded(codes * np.float32(1 / top), "unassociated", levels)[:, 0]
    assert np.array_equal(found, codes[:, 3] / np.float32(top))


def test_arguments_are_checked():
    with pytest.raises(ValueError, match="none, srgb, stated"):
        curve(SRGB, undo="gamma")
    with pytest.raises(ValueError, match="R, G, B and alpha"):
        decoded([[1, 1, 1]], "unassociated")


def test_alpha_is_the_one_of_its_layer():
    names = ["A", "beauty.B", "beauty.a", "beauty.G", "beauty.R", "B", "G", "R"]
    assert picture_layer([("", names)]).alpha == 0
    assert picture_layer([("", names)], "beauty").alpha == 2
    assert picture_layer([("", ["Alpha", "R", "G", "B"])]).alpha == 0
    assert picture_layer([("", ["R", "G", "B", "Z"])]).alpha == -1
    assert picture_layer([("", ["", "", "", ""])]).alpha == 3
