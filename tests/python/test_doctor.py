# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""cg2raw doctor: it names the plugin that works, and why another does not."""

import json
import os
import platform
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import OpenImageIO
import pytest

from cg2raw import _core
from cg2raw.cli import doctor as cli_doctor
from cg2raw.oiio import hosts, registration
from cg2raw.oiio.elf import Library
from cg2raw.oiio.plugin_file import misfit, plugin_api_of
from conftest import OIIOTOOLS
from python.commands import run, write_dng
from tiers import slow

SYSTEM_TOOL = "/usr/bin/oiiotool"
SEARCHED = ("OIIO_LIBRARY_PATH", "OPENIMAGEIO_PLUGIN_PATH", "LD_LIBRARY_PATH")


def doctor(*options, **environment):
    """Run cg2raw doctor with nothing but @environment to find plugins by."""
    inherited = {
        name: value for name, value in os.environ.items() if name not in SEARCHED
    }
    inherited["PATH"] = "/usr/bin:/bin"
    return subprocess.run(
        [sys.executable, "-m", "cg2raw", "doctor", *options],
        env={**inherited, **environment},
        text=True,
        capture_output=True,
    )


@pytest.mark.parametrize(
    ("version", "api"),
    [
        *(("2.2.9", None), ("2.3.0.1", 25), ("2.5.18", 25), ("2.6.0", 26)),
        *(("3.0.4", 26), ("3.1.0", 27), ("3.2.2.0", 27), ("3.3.0", None)),
    ],
)
def test_plugin_apis_are_those_of_openimageio_s_oiioversion_h(version, api):
    assert plugin_api_of(version) == api


@pytest.fixture(scope="module")
def version():
    """Return the version of the system's OpenImageIO."""
    return next(host.version for host in hosts.find_hosts() if host.path == SYSTEM_TOOL)


@pytest.fixture
def examine(plugin, version, monkeypatch):
    """Return examine(**environment): doctor's report on the system's oiiotool, which
    finds plugins by nothing else. One start of it, where a doctor makes ten."""

    def examined(**environment):
        for name in SEARCHED:
            monkeypatch.delenv(name, raising=False)
        for name, value in environment.items():
            monkeypatch.setenv(name, str(value))
        host = hosts.Host("oiiotool", SYSTEM_TOOL, version)
        return cli_doctor.examine_host(host, _core.installed_profiles()[:1], "")

    return examined


@pytest.fixture(scope="module")
def plugin(build_folder):
    """Return the plugin that is built for the system's OpenImageIO."""
    path = build_folder / "lib/cg2raw/oiio/dng.imageio.so"
    if not path.exists() or not Path(SYSTEM_TOOL).exists():
        pytest.skip("no plugin for the system's oiiotool in this build")
    return path


@pytest.fixture
def altered(plugin, tmp_path):
    """Return alter(old, new): a folder with a plugin in which bytes are replaced."""

    def alter(old, new):
        data = plugin.read_bytes()
        assert old in data
        (tmp_path / "dng.imageio.so").write_bytes(data.replace(old, new, 1))
        return tmp_path

    return alter


@pytest.mark.parametrize("is_alone", [True, slow(False)])
def test_a_fitting_plugin_works(plugin, monkeypatch, is_alone):
    for name in SEARCHED:
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("OIIO_LIBRARY_PATH", str(plugin.parent))
    if is_alone:  # no other program is run
        monkeypatch.setattr(hosts, "programs", lambda name: [f"/usr/bin/{name}"])
        monkeypatch.setattr(hosts, "ASK_PYTHON", "raise SystemExit(1)")
    done = run("doctor", "--json")
    assert (done.code, done.err) == (0, "")
    [host] = [h for h in json.loads(done.out)["hosts"] if h["path"] == SYSTEM_TOOL]
    assert host["kind"] == "oiiotool" and host["works"]
    assert host["plugin_api"] == 25 or not host["version"].startswith("2.4")
    assert [found["path"] for found in host["plugins"]] == [str(plugin)]
    assert host["plugins"][0]["loads"] and host["plugins"][0]["reason"] == ""
    assert host["reader"] == "raw"


def test_nothing_on_the_path_exits_1(plugin, version, monkeypatch):
    for name in SEARCHED:
        monkeypatch.delenv(name, raising=False)
    found = [
        hosts.Host("oiiotool", SYSTEM_TOOL, version),
        hosts.Host("python", sys.executable, OpenImageIO.VERSION_STRING),
    ]
    monkeypatch.setattr(hosts, "find_hosts", lambda: found)
    done = run("doctor")
    assert (done.code, done.err) == (1, "")
    assert f"{SYSTEM_TOOL}: OpenImageIO " in done.out
    assert "reads     only the 8-bit preview of a DNG, without a word" in done.out


def test_nothing_on_the_path_names_the_remedy(plugin, examine):
    host = examine()
    assert not host["works"] and host["plugins"] == [] and host["search"] == []
    folder = host["remedy"].removeprefix("export OIIO_LIBRARY_PATH=").split()[0]
    assert Path(folder).samefile(plugin.parent)


def test_a_folder_that_does_not_exist_is_said(examine):
    assert examine(OIIO_LIBRARY_PATH="/nowhere")["search"] == [
        {"variable": "OIIO_LIBRARY_PATH", "folder": "/nowhere", "exists": False}
    ]


def test_a_plugin_of_another_abi_is_named(repository, plugin, examine):
    wheel = repository / "build/wheel/lib/cg2raw/oiio"
    if not (wheel / plugin.name).exists():
        pytest.skip("no plugin for the wheel's OpenImageIO: run scripts/setup")
    host = examine(OIIO_LIBRARY_PATH=f"{wheel}:{plugin.parent}")
    wrong, right = host["plugins"]
    assert wrong["plugin_api"] == 27 and not wrong["loads"]
    assert "plugin API 27" in wrong["reason"] and "wants 25" in wrong["reason"]
    assert right["loads"] and host["works"]


def test_a_second_plugin_that_fits_is_said_to_come_after(plugin, altered, examine):
    folder = altered(b"\x7fELF", b"\x7fELF")
    host = examine(OIIO_LIBRARY_PATH=f"{plugin.parent}:{folder}")
    assert [found["loads"] for found in host["plugins"]] == [True, False]
    assert host["plugins"][1]["reason"] == f"comes after {plugin}"


def test_a_plugin_that_cannot_load_says_why(altered, examine):
    host = examine(OIIO_LIBRARY_PATH=altered(b"libtiff.so", b"libnone.so"))
    assert "libnone.so.6 is not found" in host["plugins"][0]["reason"]
    assert not host["works"]
    assert host["message"] and host["remedy"]


@pytest.mark.parametrize(
    ("old", "new", "reason"),
    [
        (
            b"dng_imageio_version\0",
            b"dng_imageio_nothing\0",
            "is no OpenImageIO plugin",
        ),
        (b"\x7fELF", b"\x7fELM", "is not a shared library"),
        (b"\x7fELF\x02", b"\x7fELF\x01", "is not a 64-bit"),
        (b"\x03\x00\x3e\x00", b"\x03\x00\xb7\x00", "is for aarch64, this machine is"),
    ],
)
def test_what_is_wrong_is_read_from_the_file(
    altered, version, monkeypatch, old, new, reason
):
    monkeypatch.setenv("OIIO_LIBRARY_PATH", str(altered(old, new)))
    host = hosts.Host("oiiotool", SYSTEM_TOOL, version)
    plugin, *_ = cli_doctor.plugins_of(host, hosts.Trial(False, "", ""))
    assert reason in plugin.reason


def test_a_truncated_plugin_is_damaged(plugin, version, monkeypatch, tmp_path):
    (tmp_path / plugin.name).write_bytes(plugin.read_bytes()[:5000])
    monkeypatch.setenv("OIIO_LIBRARY_PATH", str(tmp_path))
    host = hosts.Host("oiiotool", SYSTEM_TOOL, version)
    found, *_ = cli_doctor.plugins_of(host, hosts.Trial(False, "", ""))
    assert "is damaged" in found.reason


# Lines of LD_DEBUG=files.
PLUGIN = "/p/dng.imageio.so"
OPENED = (
    f"7: file={PLUGIN} [0];  dynamically loaded by /usr/lib/libOpenImageIO.so [0]\n"
)
NEEDS = f"7: file=libtiff.so.6 [0];  needed by {PLUGIN} [0]\n"
FOUND = "7: file=libtiff.so.6 [0];  generating link map\n"


@pytest.mark.parametrize(
    ("log", "reason"),
    [
        ("", ""),  # of another system's loader nothing is known
        (f"{OPENED}{NEEDS}{FOUND}7: calling init: {PLUGIN}\n", ""),
        (
            "7: calling init: /other.so\n",
            "was not opened, although it lies on the sear",
        ),
        (
            OPENED + NEEDS,
            f"does not load: libtiff.so.6 is not found, needed by {PLUGIN}",
        ),
        (
            f"{OPENED}7: {PLUGIN}: error: symbol lookup error: no _Z3f (fatal)\n",
            "does not load: symbol lookup error: no _Z3f",
        ),
        (OPENED + NEEDS + FOUND, "does not load: the dynamic loader refuses it"),
        (
            OPENED + OPENED.replace(PLUGIN, "/q.so") + NEEDS,  # those of another file
            "does not load: the dynamic loader refuses it",
        ),
    ],
)
def test_what_the_loader_had_against_a_plugin(log, reason):
    found = cli_doctor.loader_reason(PLUGIN, log)
    assert found.startswith(reason) and bool(found) == bool(reason)


@pytest.mark.parametrize(
    ("library", "version", "folder", "reason"),
    [
        (("here", 27), "3.2.2.0", "oiio", ""),
        (("here", 25), "2.4.7", "oiio-2.4", ""),
        (("here", 99), "9.0", "oiio", ""),  # what is not known is left to OpenImageIO
        (("m68k", 27), "3.2.2.0", "oiio", "is for m68k, this machine is here"),
        (("here", None), "3.2.2.0", "oiio", "is no OpenImageIO plugin for dng"),
        (
            ("here", 25),
            "3.2.2.0",
            "oiio",
            "is built for plugin API 25 (OpenImageIO 2.3 to 2.5); OpenImageIO 3.2.2.0 "
            "wants 27",
        ),
        (("here", 25), "2.5.1", "oiio-2.4", "is built for OpenImageIO 2.4, not 2.5.1"),
        (("here", 27), "3.2.0", "oiio-3.1", ""),  # one namespace since 3
    ],
)
def test_a_plugin_that_does_not_fit_is_told_by_its_file(
    monkeypatch, library, version, folder, reason
):
    monkeypatch.setattr(platform, "machine", lambda: "here")
    found = misfit(Library(*library), version, f"/lib/cg2raw/{folder}/dng.imageio.so")
    assert found.startswith(reason) and bool(found) == bool(reason)


@pytest.mark.parametrize(
    ("version", "names", "told"),
    [
        ("2.4.7", ("OIIO_LIBRARY_PATH", "LD_LIBRARY_PATH"), "OIIO_LIBRARY_PATH"),
        ("2.5.18", ("OIIO_LIBRARY_PATH", "LD_LIBRARY_PATH"), "OIIO_LIBRARY_PATH"),
        *(
            (
                version,
                ("OIIO_LIBRARY_PATH", "OPENIMAGEIO_PLUGIN_PATH"),
                "OPENIMAGEIO_PLUGIN_PATH",
            )
            for version in ("2.6.0", "3.2.2")
        ),
    ],
)
def test_a_host_searches_by_the_variables_of_its_version(
    monkeypatch, version, names, told
):
    for name in SEARCHED:
        monkeypatch.setenv(name, f"/{name}/a::/{name}/b")
    host = hosts.Host("oiiotool", "/x/oiiotool", version)
    assert host.search == [(n, f"/{n}/{end}") for n in names for end in "ab"]
    assert host.variable == told


def test_programs_are_the_executable_ones_once(monkeypatch, tmp_path):
    for name, mode in (("a", 0o755), ("b", 0o644), ("c", 0o755)):
        (tmp_path / name).mkdir()
        (tmp_path / name / "made-up").touch(mode=mode)
    (tmp_path / "link").symlink_to("a")
    places = [str(tmp_path / name) for name in ("link", "b", "c", "a")]
    monkeypatch.setenv("PATH", os.pathsep.join(places))
    found = [str(tmp_path / name / "made-up") for name in ("a", "c")]
    assert hosts.programs("made-up") == found
    assert hosts.ask([found[0]]) is None and hosts.ask(["/none"]) is None


def test_a_plugin_is_registered_with_the_openimageio_of_this_python_alone():
    beside = os.path.join(os.path.realpath(os.path.dirname(sys.executable)), "python")
    given = [("python", beside), ("oiiotool", beside), ("python", "/nowhere/python")]
    each = [SimpleNamespace(kind=k, path=p, version="3.1.6") for k, p in given]
    found = [cli_doctor.plugin_to_register(host) for host in each]
    assert found == [registration.plugin_for("3.1.6"), None, None]


def test_it_lists_the_folders_and_ids_of_sensors(monkeypatch, tmp_path):
    monkeypatch.setenv("CG2RAW_PROFILE_PATH", str(tmp_path))
    monkeypatch.setattr(hosts, "find_hosts", list)
    sensors = cli_doctor.examine()["sensors"]
    assert sensors["folders"][0] == str(tmp_path)
    assert {"nikon-d40", "samsung-s20fe"} <= set(sensors["ids"])


def test_the_text_report_is_for_people(plugin, examine):
    host = {**examine(OIIO_LIBRARY_PATH=plugin.parent), "reader": "raw"}
    text = cli_doctor.as_text(
        {"works": True, "hosts": [host], "sensors": {"folders": [], "ids": ["a"]}}
    )
    assert f"{SYSTEM_TOOL}: OpenImageIO " in text
    assert f"plugin    {plugin} loads" in text
    assert "a 16x16 DNG: works" in text and "by LibRaw, which develops" in text
    assert "sensors: 1 (a)" in text


def test_it_says_who_reads_a_dng(monkeypatch, tmp_path):
    """Where there is no LibRaw, ours saves from the preview."""
    tool, plugins = OIIOTOOLS["oiio-wheel"]
    if not tool.exists() or not (plugins / "dng.imageio.so").exists():
        pytest.skip("no wheel's oiiotool with its plugin: run scripts/setup")
    shot = str(write_dng(tmp_path / "shot.dng"))
    for folder, reader in (("", "tiff"), (plugins, "dng")):
        monkeypatch.setenv("OIIO_LIBRARY_PATH", str(folder))
        monkeypatch.delenv("OPENIMAGEIO_PLUGIN_PATH", raising=False)
        host = hosts.Host("oiiotool", str(tool), "3.2.2")
        assert hosts.reader_of(host, shot) == reader


def test_a_wrong_option_exits_2():
    done = doctor("--jsn")
    assert done.returncode == 2 and "usage: cg2raw" in done.stderr


def test_a_host_that_does_not_run_has_written_nothing(tmp_path):
    host = hosts.Host("oiiotool", str(tmp_path / "oiiotool"), "2.4.7")
    trial = hosts.try_to_write(host, "canon-70d")
    assert (trial.wrote, trial.message) == (False, "does not run, or not within 60 s")


def test_a_host_that_searches_nowhere_is_said_to():
    host = {
        **{"path": "oiiotool", "version": "2.4.7", "plugin_api": 24, "search": []},
        **{"plugins": [], "register_oiio_plugin": None, "works": True},
        **{"reader": None, "remedy": ""},
    }
    assert cli_doctor.host_lines(host)[1].endswith(
        "nothing: neither OIIO_LIBRARY_PATH nor OPENIMAGEIO_PLUGIN_PATH names a folder"
    )
