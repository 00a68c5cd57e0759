# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""cg2raw ocio --merge: a studio's config with RAW spaces, and nothing of it lost."""

import numpy as np
import PyOpenColorIO as ocio
import pytest

from cg2raw_ocio import names
from ocio.conversion import (
    SCENE,
    camera,
    converted,
    difference,
    pixels,
    system_python,
)
from python.commands import fails, run
from tiers import slow

PAIRS = [("samsung-s20fe", "A"), ("nikon-d40", "sample:0")]
ASKED = ("--sensors", "samsung-s20fe,nikon-d40", "--illuminants", "A,sample:0")
BUILT_IN = [entry[0] for entry in ocio.BuiltinConfigRegistry().getBuiltinConfigs()]
V21 = "ocio://studio-config-v1.0.0_aces-v1.3_ocio-v2.1"

# Everything that a config may hold; its reference is ACEScg, not ACES2065-1.
STUDIO = """\
ocio_profile_version: 2.1
environment: {SHOT: "010"}
search_path: luts
strictparsing: false
family_separator: "|"
luma: [0.3, 0.6, 0.1]
description: a show
name: show-42
roles: {aces_interchange: ap0, scene_linear: ACEScg, default: data, \
cie_xyz_d65_interchange: xyz}
file_rules:
  - !<Rule> {name: plates, colorspace: ap0, pattern: "*plate*", extension: exr}
  - !<Rule> {name: ColorSpaceNamePathSearch}
  - !<Rule> {name: Default, colorspace: ACEScg}
viewing_rules:
  - !<Rule> {name: lin, colorspaces: ACEScg}
shared_views:
  - !<View> {name: plain, view_transform: vt, display_colorspace: monitor}
displays:
  monitor:
    - !<View> {name: show, view_transform: vt, display_colorspace: monitor, looks: warm}
    - !<View> {name: raw, colorspace: data}
    - !<Views> [plain]
active_displays: [monitor]
active_views: [show, plain]
inactive_colorspaces: [old]
looks:
  - !<Look>
    name: warm
    process_space: ACEScg
    transform: !<CDLTransform> {slope: [1.1, 1, 0.9]}
default_view_transform: vt
view_transforms:
  - !<ViewTransform>
    name: vt
    from_scene_reference: !<MatrixTransform> {matrix: [0.9, 0, 0, 0, 0, 1, 0, 0, 0, 0, \
1, 0, 0, 0, 0, 1]}
display_colorspaces:
  - !<ColorSpace> {name: xyz}
  - !<ColorSpace>
    name: monitor
    from_display_reference: !<ExponentTransform> {value: 2.2, direction: inverse}
colorspaces:
  - !<ColorSpace> {name: ACEScg, family: work|linear, encoding: scene-linear}
  - !<ColorSpace>
    name: ap0
    from_scene_reference: !<BuiltinTransform> {style: ACEScg_to_ACES2065-1}
  - !<ColorSpace>
    name: graded
    aliases: [lin_ap0]
    from_scene_reference: !<FileTransform> {src: "grade_${SHOT}.cube"}
  - !<ColorSpace> {name: old}
  - !<ColorSpace> {name: data, isdata: true}
named_transforms:
  - !<NamedTransform>
    name: curve
    transform: !<ExponentTransform> {value: 2.4}
"""


@pytest.fixture
def studio(tmp_path):
    """Return the path of a studio's config."""
    path = tmp_path / "studio.ocio"
    path.write_text(STUDIO)
    return path


def merge(source, output):
    """Return the config that cg2raw makes of another one."""
    done = run("ocio", *ASKED, "--merge", source, "-o", output)
    assert done.code == 0, done.err
    return ocio.Config.CreateFromFile(str(output))


def without_raw(config, inactive):
    """Return the text of a config less its RAW spaces, with that inactive list."""
    names = [s.getName() for s in config.getColorSpaces(
        ocio.SEARCH_REFERENCE_SPACE_ALL, ocio.COLORSPACE_ALL
    )]  # fmt: skip
    ours = [name for name in names if name.startswith("RAW ")]
    assert len(ours) == 8
    for name in ours:
        config.removeColorSpace(name)
    config.setInactiveColorSpaces(inactive)
    return config.serialize()


@pytest.mark.parametrize("name", BUILT_IN)
def test_of_a_built_in_config_nothing_is_lost(tmp_path, name):
    base = ocio.Config.CreateFromBuiltinConfig(name)
    merged = merge(f"ocio://{name}", tmp_path / "merged.ocio")
    listed = merged.getInactiveColorSpaces()
    assert listed.startswith(f"{base.getInactiveColorSpaces()}, raw_unbounded_")
    assert without_raw(merged, base.getInactiveColorSpaces()) == base.serialize()


def test_of_a_studios_config_nothing_is_lost(tmp_path, studio, monkeypatch):
    # What the environment says today is no part of the config.
    monkeypatch.setenv("SHOT", "099")
    monkeypatch.setenv("OCIO_INACTIVE_COLORSPACES", "ap0")
    base = ocio.Config.CreateFromFile(str(studio))
    merged = merge(studio, tmp_path / "merged.ocio")
    assert merged.getInactiveColorSpaces() == (
        "old, raw_unbounded_samsung_s20fe_a, raw_unbounded_samsung_s20fe_sample_0, "
        "raw_unbounded_nikon_d40_a, raw_unbounded_nikon_d40_sample_0"
    )
    assert without_raw(merged, "old") == base.serialize()
    assert "SHOT: 010\n" in (tmp_path / "merged.ocio").read_text()


def reach(config, rgb, space):
    """Return linear Rec.709 pixels as another space of a built-in config."""
    return rgb if space == SCENE else converted(config, SCENE, space, rgb)


@pytest.mark.parametrize("space", [SCENE, "ACEScg", "ACES2065-1"])
@pytest.mark.parametrize(
    "name", ["default", *map(slow, (*BUILT_IN, "studio-config-latest"))]
)
def test_the_bridge_between_the_references_is_right(tmp_path, name, space):
    merged = merge(f"ocio://{name}", tmp_path / "merged.ocio")
    rgb = pixels()
    for sensor, light in PAIRS:
        found = converted(
            merged, space, f"RAW - {sensor} - {light}", reach(merged, rgb, space)
        )
        assert difference(found, camera(sensor, light, rgb)) <= 0.3


@pytest.mark.parametrize("sensor_light", PAIRS, ids="-".join)
def test_the_way_back_and_the_unbounded_twin(tmp_path, sensor_light):
    name = " - ".join(sensor_light)
    run("ocio", *ASKED, "-o", tmp_path / "plain.ocio")
    plain = ocio.Config.CreateFromFile(str(tmp_path / "plain.ocio"))
    merged = merge("ocio://default", tmp_path / "merged.ocio")
    for source, target in (
        (f"RAW - {name}", SCENE),
        (SCENE, f"RAW unbounded - {name}"),
        (f"RAW unbounded - {name}", SCENE),
    ):
        expected = converted(plain, source, target, pixels())
        found = converted(merged, source, target, pixels())
        assert np.abs(expected - pixels()).max() > 0.05
        assert difference(found, expected) <= 0.3


def test_the_bridge_from_a_reference_that_is_not_aces(tmp_path, studio):
    merged = merge(studio, tmp_path / "merged.ocio")
    aces = ocio.Config.CreateFromBuiltinConfig(BUILT_IN[0])
    acescg = converted(aces, SCENE, "ACEScg", pixels())
    for sensor, light in PAIRS:
        found = converted(merged, "ACEScg", f"RAW - {sensor} - {light}", acescg)
        assert difference(found, camera(sensor, light, pixels())) <= 0.3


def test_the_family_is_in_the_studios_words(tmp_path, studio):
    merged = merge(studio, tmp_path / "merged.ocio")
    assert merged.getColorSpace("raw_nikon_d40_a").getFamily() == "RAW|Nikon"


def test_spaces_keep_their_interop_ids(tmp_path, studio):
    """By which a file in one of them is known again."""
    merged = merge(studio, tmp_path / "merged.ocio")
    for sensor, light in PAIRS:
        for name, _, interop_id in (
            names.raw_space(sensor, light),
            names.unbounded_space(sensor, light),
        ):
            assert merged.getColorSpace(name).getInteropID() == interop_id
            assert merged.getColorSpace(interop_id).getName() == name


def test_into_a_config_of_our_own(tmp_path):
    one = ("--sensors", "sony-a57", "--illuminants", "D50")
    run("ocio", *one, "-o", tmp_path / "own.ocio")
    merged = merge(tmp_path / "own.ocio", tmp_path / "merged.ocio")
    for sensor, light in (*PAIRS, ("sony-a57", "D50")):
        found = converted(merged, SCENE, f"RAW - {sensor} - {light}", pixels())
        assert difference(found, camera(sensor, light, pixels())) <= 0.3


def test_the_newest_is_pinned_to_a_profile_of_today(tmp_path):
    for name in ("default", "cg-config-latest", "studio-config-latest"):
        merged = merge(f"ocio://{name}", tmp_path / "merged.ocio")
        assert (merged.getMajorVersion(), merged.getMinorVersion()) == (2, 4)


CONVERT = """
import sys
import numpy as np
import PyOpenColorIO as ocio
config = ocio.Config.CreateFromFile(sys.argv[1])
config.validate()
image = np.load(sys.argv[2])
cpu = config.getProcessor("ACEScg", "raw_nikon_d40_sample_0").getDefaultCPUProcessor()
cpu.apply(ocio.PackedImageDesc(image, len(image), 1, 4))
np.save(sys.argv[2], image)
"""


def test_profile_2_1_loads_in_the_systems_opencolorio(tmp_path, build_folder):
    merged = merge(V21, tmp_path / "merged.ocio")
    image = np.ones((20000, 4), np.float32)
    image[:, :3] = converted(merged, SCENE, "ACEScg", pixels())
    np.save(tmp_path / "x.npy", image)
    arguments = (tmp_path / "merged.ocio", tmp_path / "x.npy")
    system_python(build_folder, "-c", CONVERT, *arguments)
    found = np.load(tmp_path / "x.npy")[:, :3]
    assert difference(found, camera("nikon-d40", "sample:0", pixels())) <= 0.3


def test_without_merging_the_remedy(build_folder):
    command = ("-m", "cg2raw", "ocio", *ASKED, "--merge", V21)
    done = system_python(build_folder, *command, check=False)
    assert done.returncode == 1 and done.stdout == ""
    assert "pip install 'opencolorio>=2.5'" in done.stderr
    assert done.stderr.count("\n") == 1


def test_a_name_that_the_studio_has_is_an_error(tmp_path):
    merge(V21, tmp_path / "merged.ocio")
    line = fails("ocio", *ASKED, "--merge", tmp_path / "merged.ocio")
    assert "'RAW - samsung-s20fe - A' already" in line


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("aces_interchange: ap0, ", "", "has no role aces_interchange; add it"),
        ("colorspaces:\n", "colourspaces: [\n", "studio.ocio: "),
        ("ocio_profile_version: 2.1", "ocio_profile_version: 2.99", "studio.ocio: "),
    ],
)
def test_a_config_that_cannot_be_merged_with(studio, old, new, words):
    studio.write_text(studio.read_text().replace(old, new))
    assert words in fails("ocio", *ASKED, "--merge", studio)


def test_a_config_of_version_1_cannot_be_merged_with(tmp_path):
    path = tmp_path / "old.ocio"
    ocio1 = ocio.Config.CreateRaw()
    ocio1.setMajorVersion(1)
    ocio1.setRole("aces_interchange", "raw")
    ocio1.setFileRules(ocio.FileRules())
    path.write_text(ocio1.serialize())
    assert "must be 2.0 or newer" in fails("ocio", *ASKED, "--merge", path)


def test_a_way_between_the_references_that_cannot_be_found(studio):
    builtin = "!<BuiltinTransform> {style: ACEScg_to_ACES2065-1}"
    text = studio.read_text()
    assert builtin in text
    studio.write_text(text.replace(builtin, "!<FileTransform> {src: gone.cube}"))
    line = fails("ocio", *ASKED, "--merge", studio)
    assert "gone.cube" in line


@pytest.mark.parametrize(
    ("source", "words"),
    [
        ("nowhere.ocio", "--merge nowhere.ocio: no such file"),
        ("ocio://nothing", "it has default, cg-config-latest, "),
    ],
)
def test_a_source_that_is_not_there(source, words):
    assert words in fails("ocio", *ASKED, "--merge", source)


def test_an_archive_is_to_be_taken_apart(tmp_path):
    path = tmp_path / "show.ocioz"
    path.write_bytes(b"PK")
    line = fails("ocio", *ASKED, "--merge", path)
    assert "ocioarchive --extract" in line


def test_the_studios_file_is_not_overwritten(studio):
    text = studio.read_text()
    assert "is the file to be read" in fails(
        "ocio", *ASKED, "--merge", studio, "-o", studio
    )
    assert studio.read_text() == text


def test_a_config_in_another_folder_than_the_studios_luts_warns(
    tmp_path, studio, capfd
):
    (tmp_path / "else").mkdir()
    for folder, warns in (("else", True), (".", False)):
        output = tmp_path / folder / "merged.ocio"
        done = run("ocio", *ASKED, "--merge", studio, "-o", output)
        assert ("looks for files in luts" in done.err) == warns and done.code == 0
    assert "not merged" not in capfd.readouterr().err  # of what is the studio's
