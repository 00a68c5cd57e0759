# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What a study's numbers depend on: all of it, and nothing else."""

import importlib
import linecache
from dataclasses import replace
from types import SimpleNamespace

import pytest

from studies import fingerprint
from studies.draws import LEARNED, Run, made_by_of
from studies.fingerprint import (
    code,
    code_hash,
    imported,
    installed,
    limited,
    made_by,
    need_pinned,
)


def changed(world, table, **settings):
    """Return the world with other settings of one table."""
    protocol = world.protocol
    other = replace(getattr(protocol, table), **settings)
    return replace(world, protocol=replace(protocol, **{table: other}))


def test_code_is_what_a_study_imports_and_no_page_or_other_study():
    found = set(imported(["studies.tasks.isp", "studies.sources.exposures"]))
    assert found >= {
        "cg2raw.match.comparison",  # by studies.sources.exposures
        "cg2raw.sensor",  # from cg2raw import Sensor
        "cg2raw.profile.neutral_mixture",  # by studies.cameras, which sources import
        "studies.learners.least_squares",
        "studies.world.night",
    }
    assert not [
        name
        for name in found
        if name.startswith(("cg2raw.diagnose", "cg2raw.cli", "studies.tables"))
        or name in ("studies.docs_page", "studies.tasks.illuminant")
    ]
    learned = imported(["studies.tasks.illuminant"])
    assert "studies.learners.convolutional_mean" in learned  # imported in a function


@pytest.mark.parametrize(
    ("after", "same"),
    [
        ('"""Other words."""\nimport os  # why\n\n\nX = (1,\n     2)\n', True),
        ('"""Words."""\nimport os\nX = (1, 3)\n', False),
    ],
)
def test_words_and_layout_are_no_code(after, same, tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(tmp_path))
    for name, text in (
        ("one", '"""Words."""\nimport os\nX = (1, 2)\n'),
        ("two", after),
    ):
        (tmp_path / f"planted_{name}_{same}.py").write_text(text)
    one, two = (code(f"planted_{name}_{same}") for name in ("one", "two"))
    assert (one == two) is same


def test_edits_during_a_run_are_no_part_of_what_it_ran(tmp_path, monkeypatch):
    monkeypatch.syspath_prepend(str(tmp_path))
    path = tmp_path / "planted_during_a_run.py"
    path.write_text("def run():\n    return 1\n")
    run = importlib.import_module(path.stem).run
    before = code_hash([path.stem], [run])
    path.write_text("def run():\n    return 2\n")
    linecache.checkcache()
    assert code_hash([path.stem], [run]) == before


def test_settings_of_the_study_count_and_those_of_others_do_not(world, monkeypatch):
    monkeypatch.setattr(type(world), "hashes", lambda _: {})  # of spectra: seconds
    monkeypatch.setattr(fingerprint, "code_hash", lambda *_: "")
    monkeypatch.setattr(fingerprint, "installed", lambda: {})

    def of(study, world, mode="full"):
        made = made_by_of(Run(world, mode, {}, None, print), study, study)
        return made["settings"], made["world"], made["seeds"]

    before = {study: of(study, world) for study in LEARNED}
    isp, unet = world.protocol.isp, world.protocol.isp_unet
    tests = {**isp.tests, "full": 7}
    for other, studies in (
        (changed(world, "isp", tests=tests), {"isp", "isp_unet", "content"}),
        (changed(world, "isp_unet", width=unet.width + 1), {"isp_unet"}),
        (changed(world, "isp", draws={"quick": 1, "full": 9}), set()),
        (changed(world, "isp", tests={**isp.tests, "quick": 7}), set()),
        (changed(world, "seeds", real=7), set(LEARNED)),
        (changed(world, "night", lights=(9, 9)), set(LEARNED)),
    ):
        differ = {study for study in LEARNED if of(study, other) != before[study]}
        assert differ == studies


def test_a_study_is_given_no_setting_that_is_not_counted(world):
    own = limited(world, LEARNED["isp"].tables("isp")).protocol
    assert own.isp == world.protocol.isp and own.scene == world.protocol.scene
    assert own.denoising is None and own.isp_unet is None


def test_noise_of_a_lender_counts(world, monkeypatch):
    def found():
        return made_by(world, "full", ["denoising"], [])["world"]

    before = found()
    other = SimpleNamespace(to_json=lambda: "of another profile")
    monkeypatch.setattr(fingerprint, "Sensor", lambda _: other)
    assert found() != before


def test_folders_count_for_entries_that_are_made_of_them(world):
    run = Run(world, "full", {}, None, print, folders={"night renders": "a"})
    of = {n: made_by_of(run, "isp", n) for n in ("isp", "isp, night renders")}
    assert of["isp"]["folders"] == {}
    assert of["isp, night renders"]["folders"] == {"night renders": "a"}


def test_a_package_of_another_version_is_refused_in_one_line(monkeypatch):
    if installed()["scipy"] is None:
        pytest.skip("scipy is not installed")
    other = {**installed(), "scipy": "1.0.0"}
    monkeypatch.setattr(fingerprint, "installed", lambda: other)
    with pytest.raises(
        ValueError, match=r"scipy 1\.0\.0 .* ./scripts/evidence"
    ) as said:
        need_pinned()
    assert "\n" not in str(said.value)
