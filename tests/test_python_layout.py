# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The layout's rules for Python: imports point to rooms before, and never in a circle.

All import statements count, also those inside functions and under TYPE_CHECKING."""

import ast
from pathlib import Path

import pytest

# A room is a module, or a package with all that is in it. Its modules import from it
# and from rooms before it. "cg2raw" is the package's __init__.py: the public names.
ROOMS = (
    "cg2raw.interrupts",
    "cg2raw.blas_threads",
    "cg2raw._core",
    "cg2raw.system",
    "cg2raw.near_words",
    "cg2raw.short_messages",
    "cg2raw.core_arguments",
    "cg2raw.argument_types",
    "cg2raw.arrays",
    "cg2raw.normal",
    "cg2raw.raw_frame",
    "cg2raw.cfa",
    "cg2raw.exposure",
    "cg2raw.sensor",
    "cg2raw.spectra",
    "cg2raw.dng",
    "cg2raw.upi",
    "cg2raw.oiio",
    "cg2raw._public",
    "cg2raw",
    "cg2raw.io",
    "cg2raw.profile",
    "cg2raw.conversion",
    "cg2raw.quick_look",
    "cg2raw.dataset",
    "cg2raw.statistics",
    "cg2raw.model",
    "cg2raw.calibration",
    "cg2raw.diagnose",
    "cg2raw.synthetic",
    "cg2raw.match",
    "cg2raw_ocio",
    "cg2raw.cli",
    "cg2raw.__main__",
)
# Libraries and the rooms that may import them.
LIBRARIES = {
    "OpenImageIO": {"cg2raw.oiio"},
    "PyOpenColorIO": {"cg2raw_ocio", "cg2raw.cli"},
    "pyarrow": {"cg2raw.dataset"},
    "distributed": {"cg2raw.dataset"},
}
# The rooms inside cg2raw.diagnose, likewise. Its __init__.py has the public names.
DIAGNOSE = (
    "cg2raw.diagnose.diagnosis",
    "cg2raw.diagnose.captures",
    "cg2raw.diagnose.frames",
    "cg2raw.diagnose.effects",
    "cg2raw.diagnose.stated_shapes",
    "cg2raw.diagnose.uniform_frames",
    "cg2raw.diagnose.levels_of_flats",
    "cg2raw.diagnose.darks_and_flats",
    "cg2raw.diagnose.workers",
    "cg2raw.diagnose.scenes",
    "cg2raw.diagnose.verdict",
    "cg2raw.diagnose.report",
    "cg2raw.diagnose.pipeline",
)

ROOT = Path(__file__).resolve().parent.parent


def modules():
    """Return {dotted name: path} of both packages; the compiled one's is its stub."""
    found = {}
    for folder in (ROOT / "python", ROOT / "ocio"):
        for path in sorted(folder.glob("cg2raw*/**/*.py*")):
            if path.suffix in (".py", ".pyi"):
                parts = path.relative_to(folder).with_suffix("").parts
                name = ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
                found[name] = path
    return found


MODULES = modules()


def room_of(module, rooms=ROOMS):
    """Return the room that a module is in, None if it is in none."""
    if module == "cg2raw":
        return module
    around = [
        room
        for room in rooms
        if room != "cg2raw" and f"{module}.".startswith(f"{room}.")
    ]
    return around[0] if around else None


def imports_in(name, path):
    """Yield each module that a source's import statements name."""
    package = name if path.stem == "__init__" else name.rpartition(".")[0]
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                above = package.split(".")[: len(package.split(".")) - node.level + 1]
                base = ".".join([*above, *filter(None, [node.module])])
            for alias in node.names:
                inner = f"{base}.{alias.name}"
                yield inner if inner in MODULES else base


IMPORTS = {name: set(imports_in(name, path)) for name, path in MODULES.items()}


def circle(names):
    """Return the modules of one circle among @names, an empty list if there is none."""
    done = set()

    def walk(name, way):
        if name in way:
            return [*way[way.index(name) :], name]
        if name not in done:
            for other in sorted(IMPORTS[name] & names):
                if found := walk(other, [*way, name]):
                    return found
            done.add(name)
        return []

    return next(filter(None, (walk(name, []) for name in sorted(names))), [])


def test_modules_are_found():
    assert {"cg2raw", "cg2raw._core", "cg2raw.io.image_file"} <= set(MODULES)
    assert "cg2raw_ocio.chain" in MODULES and len(MODULES) > 100
    assert "cg2raw_ocio.config" in IMPORTS["cg2raw.cli.ocio"]  # inside a function
    assert "cg2raw_ocio.chain" in IMPORTS["cg2raw_ocio.config"]  # from .


@pytest.mark.parametrize("name", MODULES)
def test_a_module_imports_from_its_room_and_those_before(name):
    assert room_of(name), f"{name} is in no room: give it one in ROOMS"
    last = ROOMS.index(room_of(name))
    ours = [other for other in IMPORTS[name] if other.partition(".")[0] in MODULES]
    late = [other for other in ours if ROOMS.index(room_of(other)) > last]
    assert not late


@pytest.mark.parametrize(
    "name", [n for n in MODULES if n.startswith("cg2raw.diagnose.")]
)
def test_a_module_of_the_diagnosis_likewise(name):
    assert room_of(name, DIAGNOSE), f"{name} is in no room: give it one in DIAGNOSE"
    last = DIAGNOSE.index(room_of(name, DIAGNOSE))
    ours = [n for n in IMPORTS[name] if room_of(n) == "cg2raw.diagnose"]
    assert "cg2raw.diagnose" not in ours  # what is public is imported from its home
    late = [n for n in ours if DIAGNOSE.index(room_of(n, DIAGNOSE)) > last]
    assert not late


@pytest.mark.parametrize("room", ROOMS)
def test_no_circle_in_a_room(room):
    assert circle({name for name in MODULES if room_of(name) == room}) == []


@pytest.mark.parametrize("name", MODULES)
def test_a_library_has_one_user(name):
    libraries = {other.partition(".")[0] for other in IMPORTS[name]}
    for library in libraries & set(LIBRARIES):
        assert room_of(name) in LIBRARIES[library], library


def tree_of(path):
    return ast.parse(path.read_text())


def test_a_constant_of_the_diagnosis_has_one_home():
    """One name has one meaning: a threshold is imported, and not written twice."""
    homes = {}
    for path in (ROOT / "python" / "cg2raw" / "diagnose").rglob("*.py"):
        for node in tree_of(path).body:
            for target in node.targets if isinstance(node, ast.Assign) else ():
                names = target.elts if isinstance(target, ast.Tuple) else [target]
                for name in names:
                    if name.id.isupper() and name.id not in ("EFFECT", "MISSING"):
                        homes.setdefault(name.id, []).append(path.name)
    assert {name: files for name, files in homes.items() if len(files) > 1} == {}
