# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The layout's rules: includes point backwards along the flow."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

# The way of the data. A file includes only what stands before it, and its own header.
FLOW = (
    "types",
    "parallel",
    "frame_parts",
    "frame_statistics",
    "random",
    "scene_file",
    "time_code",
    "color",
    "encoding",
    "spectrum",
    "profile",
    "illuminant",
    "spectral_image",
    "transform",
    "mosaic",
    "demosaic",
    "glare_context",
    "effect",
    "run",
    "exposure",
    "signal",
    "simulation",
    "camera_frame",
    "frame",
    "light_meter",
    "prediction",
    "dng",
    "export",
    "plugin",
)
# Libraries and the folders that may include them.
LIBRARIES = {
    r"OpenImageIO/": {"dng.imageio"},
    r"tiff(io|vers|conf)?\.h": {"dng/tiff"},
    r"(pybind11/|Python\.h)": set(),
    r"OpenColorIO/": set(),
    r"nlohmann/": {"core"},
    # What one operating system has and another lacks.
    r"(unistd|fcntl|dlfcn|dirent|sched|signal|windows|io|x?locale)\.h|sys/": {
        "platform",
        "dng.imageio/portable",  # the loader in wheels, by dlopen
    },
}
# The parts of dng, and what each may include of them and of dng's public headers; the
# writer also the formulas of effects that it undoes.
PARTS_OF_DNG = {
    "dng": {"dng_description"},
    "dng/tiff": {"tiff", "platform"},
    "dng/jpeg": {"jpeg"},
    "dng/reader": {
        "reader",
        "tiff",
        "jpeg",
        "effects",
        "platform",
        "dng_reader",
        "dng_mosaic",
        "dng_description",
    },
    "dng/writer": {
        "writer",
        "tiff",
        "jpeg",
        "effects",
        "dng_writer",
        "dng_description",
    },
}
# Of dng's public headers, those that another may include.
BEFORE_IN_DNG = {"dng_mosaic": {"dng_reader"}}
# Folders and files of the top level that are in the repository.
TOP = {
    ".ci", ".clang-format", ".clang-tidy", ".github", ".gitignore",
    ".pre-commit-config.yaml", "CHANGES.md", "CITATION.cff", "CMakeLists.txt",
    "CMakePresets.json", "CONTRIBUTING.md", "LICENSE", "README.md", "SECURITY.md",
    "THIRD-PARTY.md", "docs", "ocio", "packaging", "plugins", "pyproject.toml",
    "python", "scripts", "studies", "tests",
}  # fmt: skip

PLUGINS = Path(__file__).resolve().parent.parent / "plugins"
HEADERS = sorted((PLUGINS / "include" / "cg2raw").glob("*.h"))
SOURCES = sorted(
    path
    for folder in ("platform", "core", "effects", "dng", "export", "dng.imageio")
    for path in (PLUGINS / folder).rglob("*")
    if path.suffix in (".cpp", ".h")
)


def folder_of(path):
    """Return the folder of a source, as seen from plugins."""
    return path.parent.relative_to(PLUGINS).as_posix()


def name_of(path):
    """Return the name of a source, as seen from plugins."""
    return path.relative_to(PLUGINS).as_posix()


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
    folder = folder_of(path).partition("/")[0]
    if folder != "core":
        return FLOW.index(
            {
                "platform": "types",
                "effects": "effect",
                "dng.imageio": "plugin",
            }.get(folder, folder)
        )
    served = [name for name in FLOW if serves(path, name)]
    return FLOW.index(max(served, key=len, default="effect"))


def serves(source, header):
    """Return whether @source carries the name of @header."""
    return f"{source.stem}_".startswith(f"{header}_")


@pytest.mark.parametrize("header", HEADERS, ids=name_of)
def test_a_header_includes_only_what_stands_before_it(header):
    own = stage_of_header(header.stem)
    for name in public_includes(header):
        before = stage_of_header(name) < own
        beside = {"dng_description", *BEFORE_IN_DNG.get(header.stem, ())}
        assert before or (FLOW[own] == "dng" and name in beside), name


@pytest.mark.parametrize("source", SOURCES, ids=name_of)
def test_a_source_includes_nothing_that_stands_behind_it(source):
    last = stage_of_source(source)
    late = [name for name in public_includes(source) if stage_of_header(name) > last]
    assert not late


@pytest.mark.parametrize("header", HEADERS, ids=name_of)
def test_a_header_leads_to_its_sources(header):
    assert any(serves(source, header.stem) for source in SOURCES)


@pytest.mark.parametrize("path", HEADERS + SOURCES, ids=name_of)
def test_a_library_has_one_user(path):
    included = re.findall(r'#include [<"]([^>"]+)[>"]', path.read_text())
    for pattern, folders in LIBRARIES.items():
        if folder_of(path) not in folders:
            assert not [name for name in included if re.match(pattern, name)]


@pytest.mark.parametrize(
    "source", [path for path in SOURCES if folder_of(path) in PARTS_OF_DNG], ids=name_of
)
def test_the_reader_of_dng_knows_nothing_of_the_writer(source):
    text = source.read_text()
    parts = re.findall(r'#include "(\w+)/', text)
    headers = [name for name in public_includes(source) if name.startswith("dng_")]
    included = {*parts, *headers} - {"cg2raw"}
    assert included <= PARTS_OF_DNG[folder_of(source)]
    assert '#include "../' not in text


def test_all_of_dng_is_in_its_parts():
    assert {folder_of(path) for path in (PLUGINS / "dng").rglob("*.[ch]*")} == set(
        PARTS_OF_DNG
    )


def test_json_is_private_to_the_profile():
    users = [
        name_of(path)
        for path in HEADERS + SOURCES
        if "nlohmann/" in path.read_text()
        and not name_of(path).startswith("core/profile")
    ]
    assert users == []


def versioned_files(repository, *more):
    """Return all files under version control, and @more that git ls-files lists."""
    if shutil.which("git") is None:
        pytest.skip("git is not installed")
    listed = subprocess.run(
        ["git", "ls-files", "--cached", *more],
        cwd=repository,
        capture_output=True,
        text=True,
        check=False,
    )
    if listed.returncode:
        pytest.skip("not a git checkout")
    files = [repository / line for line in listed.stdout.splitlines()]
    return [path for path in files if path.is_file()]


def source_files(repository):
    """Return all sources under version control, or about to be."""
    files = versioned_files(repository, "--others", "--exclude-standard")
    suffixes = (".cpp", ".h", ".py", ".cmake")
    return [
        path
        for path in files
        if (
            path.suffix in suffixes
            or path.name == "CMakeLists.txt"
            or path.parent.name in ("scripts", "studies", ".ci")
        )
    ]


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


def test_the_citation_is_of_this_version(repository):
    version = re.search(
        r"project\(cg2raw VERSION ([0-9.]+)",
        (repository / "CMakeLists.txt").read_text(),
    )
    citation = (repository / "CITATION.cff").read_text()
    assert version and f"\nversion: {version[1]}\n" in citation


def test_nothing_was_left_at_the_top(repository):
    files = versioned_files(repository)
    assert {path.relative_to(repository).parts[0] for path in files} == TOP
