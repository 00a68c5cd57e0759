# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The layout's rules: includes point backwards along the flow, files stay short."""

import re
import shutil
import statistics
import subprocess
from pathlib import Path

import pytest

# The way of the data. A file includes only what stands before it, and its own header.
FLOW = (
    "types",
    "parallel",
    "random",
    "scene_file",
    "color",
    "profile",
    "illuminant",
    "transform",
    "mosaic",
    "demosaic",
    "effect",
    "run",
    "signal",
    "simulation",
    "camera_frame",
    "frame",
    "prediction",
    "dng",
    "plugin",
)
# Libraries and the folders that may include them.
LIBRARIES = {
    r"OpenImageIO/": {"dng.imageio"},
    r"tiff(io|vers|conf)?\.h": {"dng"},
    r"(pybind11/|Python\.h)": set(),
    r"OpenColorIO/": set(),
    r"nlohmann/": {"core"},
}
MOST_LINES, MEDIAN_LINES = 500, 150

PLUGINS = Path(__file__).resolve().parent.parent / "plugins"
HEADERS = sorted((PLUGINS / "include" / "cg2raw").glob("*.h"))
SOURCES = sorted(
    path
    for folder in ("core", "effects", "dng", "dng.imageio")
    for path in (PLUGINS / folder).glob("*")
    if path.suffix in (".cpp", ".h")
)


def stage_of_header(name):
    """Return the place of a public header in FLOW."""
    return FLOW.index("dng" if name.startswith("dng_") else name)


def public_includes(path):
    """Return the names of the public headers that @path includes."""
    return re.findall(r'#include ["<]cg2raw/(\w+)\.h[">]', path.read_text())


def stage_of_source(path):
    """Return the last place in FLOW that @path may include.

    A source of core carries the name of the header that it implements or serves, then
    perhaps more words; what carries none serves effects and what stands before them.
    """
    folder = path.parent.name
    if folder != "core":
        return FLOW.index(
            {"effects": "effect", "dng.imageio": "plugin"}.get(folder, folder)
        )
    served = [name for name in FLOW if serves(path, name)]
    return FLOW.index(max(served, key=len, default="effect"))


def serves(source, header):
    """Return whether @source carries the name of @header."""
    return f"{source.stem}_".startswith(f"{header}_")


@pytest.mark.parametrize("header", HEADERS, ids=lambda path: path.name)
def test_a_header_includes_only_what_stands_before_it(header):
    own = stage_of_header(header.stem)
    for name in public_includes(header):
        before = stage_of_header(name) < own
        assert before or (FLOW[own] == "dng" and stage_of_header(name) == own), name


@pytest.mark.parametrize("source", SOURCES, ids=lambda path: path.name)
def test_a_source_includes_nothing_that_stands_behind_it(source):
    last = stage_of_source(source)
    late = [name for name in public_includes(source) if stage_of_header(name) > last]
    assert not late


@pytest.mark.parametrize("header", HEADERS, ids=lambda path: path.name)
def test_a_header_leads_to_its_sources(header):
    assert any(serves(source, header.stem) for source in SOURCES)


@pytest.mark.parametrize("path", HEADERS + SOURCES, ids=lambda path: path.name)
def test_a_library_has_one_user(path):
    included = re.findall(r'#include [<"]([^>"]+)[>"]', path.read_text())
    for pattern, folders in LIBRARIES.items():
        if path.parent.name not in folders:
            assert not [name for name in included if re.match(pattern, name)]


def test_json_is_private_to_the_profile():
    users = [
        path.name
        for path in HEADERS + SOURCES
        if "nlohmann/" in path.read_text() and not path.name.startswith("profile")
    ]
    assert users == []


def source_files(repository):
    """Return all sources under version control, or about to be."""
    if shutil.which("git") is None:
        pytest.skip("git is not installed")
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard"],
        cwd=repository,
        capture_output=True,
        text=True,
        check=False,
    )
    if listed.returncode:
        pytest.skip("not a git checkout")
    files = [repository / line for line in listed.stdout.splitlines()]
    suffixes = (".cpp", ".h", ".py", ".cmake")
    return [
        path
        for path in files
        if path.is_file()
        and (
            path.suffix in suffixes
            or path.name == "CMakeLists.txt"
            or path.parent.name in ("scripts", ".ci")
        )
    ]


def test_budgets_of_length(repository):
    lines = {
        path: len(path.read_text().splitlines()) for path in source_files(repository)
    }
    assert [str(path) for path, count in lines.items() if count > MOST_LINES] == []
    assert statistics.median(lines.values()) <= MEDIAN_LINES


def test_every_source_names_its_licence(repository):
    def has_licence(path):
        head = path.read_text()[:400]
        return (
            "SPDX-License-Identifier: Apache-2.0" in head
            and "Copyright Contributors to the cg2raw Project." in head
        )

    assert [
        str(path) for path in source_files(repository) if not has_licence(path)
    ] == []


def test_sources_are_ascii(repository):
    assert [
        str(path)
        for path in source_files(repository)
        if not path.read_bytes().isascii()
    ] == []
