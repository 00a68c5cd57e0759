# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The recipes of packaging/ say what pyproject.toml and CMakeLists.txt say."""

import ast
import re
import sys

import pytest
import yaml

if sys.version_info < (3, 11):
    pytest.skip("tomllib came with Python 3.11", allow_module_level=True)
import tomllib

RECIPE = "conda-forge/recipe.yaml"
REZ = "rez/package.py"
SPACK = "spack/packages/cg2raw/package.py"
# Names there -> names on PyPI.
NAMES = {
    "matplotlib-base": "matplotlib",
    "nlohmann-json": "nlohmann_json",
    "scikit_build_core": "scikit-build-core",
}


@pytest.fixture(scope="module")
def project(repository):
    """Return pyproject.toml."""
    return tomllib.loads((repository / "pyproject.toml").read_text())


@pytest.fixture(scope="module")
def version(repository):
    """Return the version in CMakeLists.txt."""
    text = (repository / "CMakeLists.txt").read_text()
    return re.search(r"project\(cg2raw VERSION ([0-9.]+)", text)[1]


@pytest.fixture(scope="module")
def minima(project):
    """Return {library: least version} of pyproject.toml and the CMake files."""
    words = project["project"]["dependencies"] + project["build-system"]["requires"]
    found = dict(word.lower().split(">=") for word in words)
    return {**found, "libtiff": "4.5", "nlohmann_json": "3.9"}


def packaged(repository, name):
    """Return the text of a file of packaging/."""
    return (repository / "packaging" / name).read_text()


def recipe_minima(text):
    """Return {library: least version} of the recipe of conda-forge."""
    requirements = yaml.safe_load(text)["requirements"]
    words = [word for part in requirements.values() for word in part if ">=" in word]
    return dict(word.split(" >=") for word in words)


def rez_minima(text):
    """Return {library: least version} of rez's package."""
    values = {
        node.targets[0].id: node.value
        for node in ast.parse(text).body
        if isinstance(node, ast.Assign)
    }
    lists = (values["requires"], values["private_build_requires"])
    words = [word for value in lists for word in ast.literal_eval(value)]
    return dict(word.removesuffix("+").split("-") for word in words if "-" in word)


def spack_minima(text):
    """Return {library: least version} of spack's package."""
    found = re.findall(r'(?:depends_on|extends)\("(?:py-)?([\w-]+)@([\d.]+):"', text)
    return dict(found)


@pytest.mark.parametrize(
    ("file", "minima_of"),
    [(RECIPE, recipe_minima), (REZ, rez_minima), (SPACK, spack_minima)],
)
def test_a_recipe_asks_for_the_libraries_that_we_ask_for(
    repository, minima, file, minima_of
):
    found = minima_of(packaged(repository, file))
    found = {NAMES.get(name, name): least for name, least in found.items()}

    def numbers(text):
        """Return "3.0" as (3,): recipes leave out zeros at the end."""
        return tuple(map(int, re.sub(r"(\.0)+$", "", text).split(".")))

    for name, least in minima.items():
        assert numbers(found.pop(name)) == numbers(least), name
    assert set(found) <= {"cmake", "python", "openimageio", "py-openimageio"}


def test_the_versions_agree(repository, version):
    assert yaml.safe_load(packaged(repository, RECIPE))["context"]["version"] == version
    assert f'\nversion = "{version}"\n' in packaged(repository, REZ)


def test_all_of_python_that_we_support_gets_a_wheel(repository, project):
    settings = project["tool"]["cibuildwheel"]["linux"]
    minors = re.search(r"cp3\{([\d,]+)\}", settings["build"])[1].split(",")
    least = project["project"]["requires-python"].removeprefix(">=3.")
    assert minors == [str(minor) for minor in range(int(least), 15)]
    assert settings["manylinux-x86_64-image"] == "manylinux_2_28"


def test_cibuildwheel_builds_against_the_headers_that_are_made_for_it(
    repository, project
):
    environment = project["tool"]["cibuildwheel"]["linux"]["environment"]
    script = (repository / "scripts/wheel_prefix.py").read_text()
    versions = ast.literal_eval(re.search(r"OPENIMAGEIOS = (\(.*\))", script)[1])
    prefix = environment["CMAKE_PREFIX_PATH"]
    folders = [f"{prefix}/oiio-{version}" for version in versions]
    assert environment["CG2RAW_OIIO_HEADERS"].split(";") == folders
    assert project["tool"]["cibuildwheel"]["linux"]["before-all"].endswith(prefix)


def test_the_image_has_all_that_the_build_reads(repository, project):
    """What the .dockerignore lets in is every folder that the wheel is made of."""
    text = packaged(repository, "Dockerfile.dockerignore")
    let_in = {line[1:] for line in text.splitlines() if line.startswith("!")}
    settings = project["tool"]["scikit-build"]
    wheel = settings["wheel"]
    read = [*wheel["packages"], *wheel["license-files"], project["project"]["readme"]]
    read += [settings["metadata"]["version"]["input"], "plugins/CMakeLists.txt"]
    read += ["python/bindings/CMakeLists.txt", "ocio/CMakeLists.txt", "scripts/wheel"]
    for name in read:
        assert (repository / name).exists()
        assert any(f"{name}/".startswith(f"{entry}/") for entry in let_in), name


def test_the_image_names_the_newest_plugin(repository):
    script = (repository / "scripts/wheel_prefix.py").read_text()
    newest = re.search(r'OPENIMAGEIOS = \(.*"(\d+\.\d+)[\d.]*"\)', script)[1]
    found = re.findall(r"/oiio-([\d.]+)", packaged(repository, "Dockerfile"))
    assert found == [newest]
