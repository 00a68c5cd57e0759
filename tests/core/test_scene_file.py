# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Which channels of a render are its picture, and which frame of a shot it is."""

import pytest

from cg2raw import _core
from core.facts import facts, picture, picture_layer

RGBA = ["R", "G", "B", "A"]


def layer(name, channels="RGBA"):
    """Return the channels of a layer."""
    return [f"{name}.{channel}" for channel in channels]


# Channels as OpenImageIO lists them; the layer, and where its R, G and B stand.
PICTURES = {
    "plain": ([("", RGBA)], "", (0, 0, 1, 2)),
    "lower case": ([("", ["r", "g", "b"])], "", (0, 0, 1, 2)),
    "words": ([("", ["red", "green", "blue", "alpha"])], "", (0, 0, 1, 2)),
    "another order": ([("", ["B", "G", "R"])], "", (0, 2, 1, 0)),
    "without names": ([("", ["channel0", "channel1", "channel2"])], "", (0, 0, 1, 2)),
    "empty names": ([("", ["", "", "", ""])], "", (0, 0, 1, 2)),
    # Arnold, V-Ray, Redshift, Unreal: the picture is unnamed, AOVs are layers
    "AOVs": ([("", RGBA + layer("diffuse", "RGB") + ["Z"])], "", (0, 0, 1, 2)),
    "AOVs first": ([("", layer("albedo", "RGB") + RGBA)], "", (0, 3, 4, 5)),
    "V-Ray": (
        [("", RGBA + ["diffuse.red", "diffuse.green", "diffuse.blue"])],
        "",
        (0, 0, 1, 2),
    ),
    # Arnold with layer names kept
    "Arnold": (
        [("", layer("RGBA") + layer("N", "XYZ") + layer("sss"))],
        "RGBA",
        (0, 0, 1, 2),
    ),
    "Blender": (
        [
            (
                "",
                layer("ViewLayer.Combined")
                + ["ViewLayer.Depth.Z"]
                + layer("ViewLayer.DiffCol", "RGB"),
            )
        ],
        "ViewLayer.Combined",
        (0, 0, 1, 2),
    ),
    "Cycles": (
        [("", layer("Combined") + layer("Emit", "RGB"))],
        "Combined",
        (0, 0, 1, 2),
    ),
    "Mantra": ([("", layer("C", "rgb") + layer("direct", "rgb"))], "C", (0, 0, 1, 2)),
    "RenderMan": (
        [("", layer("Ci", "rgb") + layer("albedo", "rgb"))],
        "Ci",
        (0, 0, 1, 2),
    ),
    "beauty": ([("", layer("beauty") + layer("diffuse"))], "beauty", (0, 0, 1, 2)),
    "one layer alone": ([("", layer("diffuse", "RGB"))], "diffuse", (0, 0, 1, 2)),
    "its lights": (
        [("", layer("beauty", "RGB") + layer("key.beauty", "RGB"))],
        "beauty",
        (0, 0, 1, 2),
    ),
    # Multi-part files of Nuke, Arnold, Karma: parts have the names
    "Nuke": ([("depth", ["Z"]), ("rgba", RGBA), ("n", RGBA)], "rgba", (1, 0, 1, 2)),
    "parts repeated": (
        [("diffuse", layer("diffuse")), ("beauty", layer("beauty"))],
        "beauty",
        (1, 0, 1, 2),
    ),
    "Karma": ([("C", layer("C")), ("albedo", layer("albedo"))], "C", (0, 0, 1, 2)),
    "Blender's parts": (
        [("ViewLayer.Combined", RGBA), ("ViewLayer.Emit", RGBA)],
        "ViewLayer.Combined",
        (0, 0, 1, 2),
    ),
}


@pytest.mark.parametrize("name", PICTURES)
def test_the_picture_by_convention(name):
    parts, expected, places = PICTURES[name]
    found = picture_layer(parts)
    assert found.name == expected
    assert (found.part, *found.channels) == places


ASKED = [
    ([("", RGBA + layer("diffuse", "RGB"))], "diffuse", (0, 4, 5, 6)),
    ([("", RGBA + layer("diffuse", "RGB"))], "DIFFUSE", (0, 4, 5, 6)),
    ([("", RGBA + layer("diffuse", "RGB"))], "rgba", (0, 0, 1, 2)),
    ([("", layer("VL.Combined") + layer("VL.Emit"))], "Emit", (0, 4, 5, 6)),
    ([("", layer("VL.Combined") + layer("VL.Emit"))], "vl.emit", (0, 4, 5, 6)),
    ([("a", RGBA), ("b", RGBA)], "b", (1, 0, 1, 2)),
    ([("", RGBA), ("", RGBA)], "1", (1, 0, 1, 2)),  # pages of a TIFF have no names
    ([("a", layer("x") + layer("y")), ("b", RGBA)], "a.y", (0, 4, 5, 6)),
    ([("", layer("N", "XYZ") + RGBA)], "N", (0, 0, 1, 2)),
    ([("", layer("C", "021") + ["Z"])], "c", (0, 0, 2, 1)),
    ([("", ["", "", "", "", ""])], "diffuse", (0, 0, 1, 2)),  # a host's black frame
    # taken out of its file, a part keeps its name
    ([("diffuse", RGBA)], "diffuse", (0, 0, 1, 2)),
]


@pytest.mark.parametrize(("parts", "asked", "places"), ASKED, ids=str)
def test_the_layer_that_is_asked_for(parts, asked, places):
    found = picture_layer(parts, asked)
    assert (found.part, *found.channels) == places


REFUSED = [
    ([("", ["Y"])], "", "R, G and B of one layer, has the channels Y"),
    ([("", ["X", "Y", "Z"])], "", "has the channels X, Y, Z .*--chnames R,G,B"),
    ([("", layer("N", "XYZ") + ["Z"])], "", "data by .*N.X, N.Y, N.Z, Z; data: N$"),
    ([("", layer("N", "RGB"))], "", "its layers are data by their names"),
    (
        [("", layer("C", "xyz") + layer("N", "xyz"))],
        "",
        "Then add --layer C .or oiiotool --ch C.x,C.y,C.z --chnames R,G,B.; .*data: N$",
    ),
    ([("", layer("a b", "012") + ["Z"])], "", '--ch "a b.0,a b.1,a b.2" --chn'),
    (
        [("", layer("CryptoAsset00") + layer("key") + layer("rim"))],
        "",
        "Add --layer key, or another of key, rim; .*data: CryptoAsset00$",
    ),
    ([("", ["", ""])], "", "has the channels .no name., .no name. "),
    ([("", ["R", "G"])], "", "has the channels R, G"),
    ([("", ["a.R", "b.G", "c.B"])], "", "has the channels a.R, b.G, c.B"),
    (
        [("", layer("diffuse") + layer("spec"))],
        "",
        "which .* Add --layer diffuse, or another of diffuse, spec; .*diffuse.R, ",
    ),
    ([("", layer("left.C") + layer("right.C"))], "", "another of left.C, right.C"),
    ([("", layer("A.Combined") + layer("B.Combined"))], "", "--layer A.Combined"),
    ([("", layer("View Layer.x") + layer("b"))], "", '--layer "View Layer.x"'),
    ([("", layer("diffuse", "RGB") + ["Z", "id"])], "", "the picture. Then add"),
    ([("", RGBA), ("", RGBA)], "", "--layer 0, or another of 0, 1"),
    ([("", [])], "", "has no channels"),
    ([("", RGBA)], "diffuse", "--layer diffuse: no layer of .* rgba have"),
    ([("", ["Z"])], "rgba", "--layer rgba: no layer .* none has"),
    ([("", layer("N", "XY") + RGBA)], "N", "--layer N: no layer of that name"),
]


@pytest.mark.parametrize(("parts", "asked", "said"), REFUSED, ids=str)
def test_files_without_one_picture_get_one_line(parts, asked, said):
    with pytest.raises(ValueError, match=said) as error:
        picture_layer(parts, asked)
    assert "\n" not in str(error.value)


DATA = ["Pn", "vl.UV", "Denoising Normal", "worldPosition", "motionVector", "id_2"]
LIGHT = ["spec", "composition", "ViewLayer.Env", "pink", "nebula", "zinc", "idle"]


@pytest.mark.parametrize("name", [*DATA, *LIGHT])
def test_layers_of_data_are_not_suggested(name):
    with pytest.raises(ValueError, match="--layer") as error:
        picture_layer([("", layer(name) + layer("a") + layer("b"))])
    assert ("data: " in str(error.value)) == (name in DATA)


def test_a_cryptomatte_is_known_by_the_name_that_the_file_states():
    parts = [("", layer("asset00") + layer("key") + ["Z"])]
    with pytest.raises(ValueError, match=r"Then add --layer key.*data: asset00$"):
        picture_layer(parts, stated={"cryptomatte/1/name": "Asset"})


def test_many_channels_are_counted_not_listed():
    names = [name for i in range(5000) for name in layer(f"l{i}", "RGB")]
    with pytest.raises(ValueError, match="and 14960 more$") as error:
        picture_layer([("", names)])
    assert len(str(error.value)) < 2000
    assert picture_layer([("", names)], "l4999").channels[0] == 3 * 4999


FRAMES = {
    "shot.0007.exr": 7,
    "/frames.0001/shot.0007.exr": 7,
    "shot_0012.dng": 12,
    "shot-3.exr": 3,
    "shot 4.exr": 4,
    "0005.png": 5,
    "render0042.exr": 42,
    "sh010_comp_v003.1001.exr": 1001,
    "shot.0007.beauty.exr": 7,
    "shot.1001.left.exr": 1001,
    "shot.0000.exr": 0,
    "sh010.exr": 10,
    "shot.100000000000000000.exr": 10**17,
    "shot.-0007.exr": -7,
    "a/-0007.exr": -7,
    "shot_-3.beauty.exr": -3,
    "shot--3.exr": -3,
    "shot.-0000.exr": 0,
    "shot.0001-0003.exr": 3,
    "interior.exr": None,
    "comp_v002.exr": None,
    "v002.exr": None,
    "curve2.exr": 2,
    "1920x1080_view.exr": None,
    "shot.12345678901234567890.exr": None,
    "": None,
    ".exr": None,
    "folder7/": None,
}


@pytest.mark.parametrize("name", FRAMES)
def test_frame_numbers_in_names(name):
    found = _core.frame_name(name)
    assert (found and found.number) == FRAMES[name]
    if found:
        digits = name.removeprefix(found.before).removesuffix(found.after)
        assert int(digits) == found.number


TIME_CODES = {
    "01:02:03:04": 1020304,
    "23:59:59;29": 23595929,
    "00:00:00:00": 0,
    "": None,
    "1:2:3:4": None,
    "01:02:03:0x": None,
    "0102030405:": None,
    "01:02:03:04:05": None,
}


@pytest.mark.parametrize("text", TIME_CODES)
def test_time_codes_are_frame_numbers(text):
    image = facts([("", "RGB")], {"smpte:TimeCode": text})
    assert picture(image).run["frame"] == (TIME_CODES[text] or 0)


ACESCG = (0.713, 0.293, 0.165, 0.83, 0.128, 0.044, 0.32168, 0.33767)
REC709 = (0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329)


def check_primaries(primaries, space, version):
    """Raise ValueError for an image of other primaries whose space nobody stated."""
    stated = {"chromaticities": primaries, "oiio:ColorSpace": space}
    picture(facts([("", "RGB")], stated, version=version))


@pytest.mark.parametrize(
    ("space", "version", "believed"),
    [
        # what OpenImageIO's reader of OpenEXR says of every file states nothing
        ("", 20407, False),
        ("Linear", 20407, False),
        ("lin_rec709", 30021, False),
        ("", 30119, False),
        ("", 30202, False),
        # what --tocolorspace leaves does
        ("linear", 20407, True),
        ("lin_rec709", 20407, True),
        ("Linear Rec.709 (sRGB)", 20407, True),
        ("Linear Rec.709 (sRGB)", 30021, True),
        ("lin_rec709", 30202, True),
        ("lin_rec709_scene", 30202, True),
    ],
)
def test_a_stated_space_outweighs_leftover_primaries(space, version, believed):
    check_primaries(REC709, space, version)
    if believed:
        check_primaries(ACESCG, space, version)
        return
    with pytest.raises(ValueError, match="ACEScg.*--iscolorspace ACEScg --tocolorsp"):
        check_primaries(ACESCG, space, version)


def test_unknown_primaries_are_not_named():
    other = (0.7, 0.3, 0.2, 0.8, 0.1, 0.1, 0.31, 0.33)
    with pytest.raises(ValueError, match="are unknown.*--iscolorspace NAME"):
        check_primaries(other, "", 30202)
    with pytest.raises(ValueError, match="--eraseattrib chromaticities"):
        check_primaries(ACESCG, "lin_rec709", 30021)
