# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What a study's numbers depend on, and nothing else: results of two are never mixed.

Code is what a study's modules import, of the studies and of cg2raw, without comments,
docstrings and layout; settings are those tables of protocol.toml that it is given. So
neither a page's words nor another study sets results aside. Files are read once in a
process: edits during a run are no part of what it ran."""

import ast
import hashlib
import inspect
from collections.abc import Callable, Iterable, Iterator
from dataclasses import asdict, fields, replace
from functools import cache
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import cg2raw
from cg2raw import Sensor, _core
from studies.places import files_hash
from studies.protocol import Protocol
from studies.world.shots import World

REQUIREMENTS = Path(__file__).with_name("requirements-evidence.txt")
OWN = ("cg2raw", "studies")
HASHED_AS_VALUES = ("cg2raw", "studies.protocol")  # no code: public names, settings
WORLD_TABLES = (
    "scene",
    "materials",
    "day",
    "night",
    "lights",
    "exposure",
    "training",
    "seeds",
)
OF_ALL = ("cameras", "draws")  # how much there is of a result, not what it is
MadeBy = dict[str, Any]


def made_by(
    world: World,
    mode: str,
    tables: Iterable[str],
    modules: Iterable[str],
    functions: Iterable[Callable[..., Any]] = (),
) -> MadeBy:
    """Return what the numbers of one study depend on.

    mode : quick or full. tables : of protocol.toml, beside those of the world.
    modules, functions : its code; modules count with all that they import."""
    protocol = world.protocol
    world_settings = {name: asdict(getattr(protocol, name)) for name in WORLD_TABLES}
    settings = {name: of_mode(getattr(protocol, name), mode) for name in tables}
    lenders = {table["noise_of"] for table in settings.values() if "noise_of" in table}
    noise = [Sensor(name).to_json() for name in sorted(lenders)]
    return {
        "cg2raw": cg2raw.__version__,
        "code": code_hash(modules, functions),
        "core": core_hash(),
        "mode": mode,
        "packages": ", ".join(
            f"{name} {version}" for name, version in installed().items() if version
        ),
        "seeds": ", ".join(f"{k} {v}" for k, v in asdict(protocol.seeds).items()),
        "settings": settings,
        "world": hashed(repr((world_settings, noise))),
        **world.hashes(),
    }


@cache
def core_hash() -> str:
    """Return the hash of cg2raw's compiled module."""
    return files_hash([Path(_core.__file__)])


def limited(world: World, tables: Iterable[str]) -> World:
    """Return the World with those tables of its protocol alone beside the world's own:
    a study cannot read a setting that made_by() of the same tables lacks."""
    kept = {*WORLD_TABLES, *tables}
    others = {f.name: None for f in fields(Protocol) if f.name not in kept}
    return replace(world, protocol=replace(world.protocol, **others))  # type: ignore[arg-type]


def of_mode(table: Any, mode: str) -> dict[str, Any]:
    """Return the settings of a table that a result in a mode depends on."""
    found = {name: v for name, v in asdict(table).items() if name not in OF_ALL}
    return {
        name: value[mode] if isinstance(value, dict) and mode in value else value
        for name, value in found.items()
    }


def code_hash(
    modules: Iterable[str], functions: Iterable[Callable[..., Any]] = ()
) -> str:
    """Return the hash of modules with all that they import, and of functions."""
    parts = [code_of(function) for function in functions]
    return hashed("".join([*parts, *(code(name) for name in imported(modules))]))


def imported(modules: Iterable[str]) -> list[str]:
    """Return modules and all of OWN that they import, by functions too, sorted."""
    found: set[str] = set()
    left = list(modules)
    while left:
        name = left.pop()
        if name not in found and name not in HASHED_AS_VALUES:
            found.add(name)
            left += imports(name)
    return sorted(found)


@cache
def tree_of(module: str) -> ast.Module:
    """Return the tree of a module, an empty one of the core, which is hashed itself."""
    spec = find_spec(module)
    assert spec is not None and spec.origin is not None, module
    is_python = spec.origin.endswith(".py")
    return ast.parse(Path(spec.origin).read_text() if is_python else "")


@cache
def code(module: str) -> str:
    """Return what a module does, whatever its comments, docstrings and layout."""
    return ast.dump(without_docstrings(tree_of(module)))


@cache
def code_of(function: Callable[..., Any]) -> str:
    """Return the same of a function."""
    return ast.dump(without_docstrings(ast.parse(inspect.getsource(function))))


@cache
def imports(module: str) -> list[str]:
    """Return the modules of OWN that a module imports."""
    return list(named_in(tree_of(module)))


def named_in(tree: ast.Module) -> Iterator[str]:
    """Yield the modules of OWN that a module names, of cg2raw's public names theirs."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (a.name for a in node.names if a.name.partition(".")[0] in OWN)
        elif isinstance(node, ast.ImportFrom) and node.module:
            if node.module.partition(".")[0] in OWN:
                yield from (named(node.module, a.name) for a in node.names)
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            if node.value.id == "cg2raw":
                yield named("cg2raw", node.attr)


def named(package: str, name: str) -> str:
    """Return the module that a name of a package is of, or is."""
    if package == "cg2raw" and not name.startswith("__"):
        found = getattr(cg2raw, name, None)
        if found is not None and not inspect.ismodule(found):
            return str(found.__module__)
    try:
        is_module = find_spec(f"{package}.{name}") is not None
    except ModuleNotFoundError:  # the package is a module
        is_module = False
    return f"{package}.{name}" if is_module else package


def without_docstrings(tree: ast.Module) -> ast.Module:
    """Return a tree whose modules, classes and functions have no docstrings."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef):
            if ast.get_docstring(node, clean=False) is not None:
                node.body = node.body[1:]
    return tree


def hashed(text: str) -> str:
    """Return the first digits of a text's SHA-256."""
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def pinned() -> dict[str, str]:
    """Return the version of each package that the studies are run with."""
    lines = REQUIREMENTS.read_text().splitlines()
    pairs = (line.split("==") for line in lines if not line.startswith("#"))
    return {name.strip(): version.strip() for name, version in pairs}


def installed() -> dict[str, str | None]:
    """Return the installed version of each of pinned(), None of what is missing."""
    found: dict[str, str | None] = {}
    for name in pinned():
        try:
            found[name] = metadata.version(name).partition("+")[0]
        except metadata.PackageNotFoundError:
            found[name] = None
    return found


def need_pinned() -> None:
    """Raise ValueError for a package of another version than pinned()."""
    versions = installed()
    for name, version in pinned().items():
        if versions[name] not in (version, None):
            raise ValueError(
                f"{name} {versions[name]} is installed, and numbers are of {version} "
                f"(studies/{REQUIREMENTS.name}): ./scripts/evidence installs it"
            )


def torch_version() -> str | None:
    """Return PyTorch's version, None without it: then some sources are missing."""
    return installed()["torch"]
