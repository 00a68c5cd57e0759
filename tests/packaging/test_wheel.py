# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""scripts/wheel leaves a wheel that a bare Python installs and uses, by the README's
lines."""

import os
import re
import shutil
import subprocess
import zipfile
from pathlib import Path

import pytest

from readme import install

pytestmark = pytest.mark.slow

# What every Linux has that can run a wheel of that tag: PEP 600.
SYSTEM = r"(libc|libm|libdl|libpthread|libgcc_s|libstdc\+\+|ld-linux-x86-64)\.so\.\d+"


def run(*command, **keywords):
    """Run a command; return the finished process."""
    words = [str(word) for word in command]
    return subprocess.run(words, capture_output=True, text=True, **keywords)


@pytest.fixture(scope="module")
def wheel(repository):
    """Return the wheel that scripts/wheel makes of this tree."""
    done = run(repository / "scripts/wheel")
    if "No matching distribution found" in done.stderr:
        pytest.skip("no package index to take the build's programs from")
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    found = [*(repository / "build/wheels/raw").glob("*.whl")]
    assert len(found) == 1
    start = found[0].name.rpartition("-linux")[0]
    [wheel] = (repository / "out/wheels").glob(f"{start}-manylinux*.whl")
    return wheel


@pytest.fixture(scope="module")
def unpacked(wheel, tmp_path_factory):
    """Return a folder with the files of the wheel."""
    folder = tmp_path_factory.mktemp("unpacked")
    zipfile.ZipFile(wheel).extractall(folder)
    return folder


@pytest.fixture(scope="module")
def environment(wheel, tmp_path_factory):
    """Return the folder of programs of a bare Python with what the README installs:
    that wheel, from out/wheels, and others from the package index."""
    first, pip, _ = install()[1].splitlines()
    assert first == "./scripts/wheel"  # which made the wheel
    clone = tmp_path_factory.mktemp("clone")
    (clone / "out/wheels").mkdir(parents=True)
    shutil.copy(wheel, clone / "out/wheels")
    folder = tmp_path_factory.mktemp("bare")
    made = run("/usr/bin/python3", "-m", "venv", folder)
    assert made.returncode == 0, made.stderr
    done = run("sh", "-ec", pip, cwd=clone, env={**os.environ, **clean(folder / "bin")})
    if "No matching distribution found" in done.stderr:
        pytest.skip("no package index to take the dependencies from")
    assert done.returncode == 0, done.stderr
    return folder / "bin"


def clean(environment):
    """Return an environment without anything that helps."""
    return {"PATH": f"{environment}:/usr/bin:/bin", "HOME": os.environ.get("HOME", "/")}


def test_imagebuf_oiiotool_and_write_dng_write_what_rawpy_reads(
    environment, repository, tmp_path
):
    check = repository / "scripts/wheel_check.py"
    second = [] if not Path("/usr/bin/oiiotool").exists() else ["/usr/bin/oiiotool"]
    done = run(
        environment / "python", check, *second, cwd=tmp_path, env=clean(environment)
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert str(environment.parent) in done.stdout.splitlines()[0]
    assert done.stdout.count(": the same pixels\n") == 2 + len(second)


def test_openimageio_alone_finds_the_plugin_by_what_env_prints(environment, tmp_path):
    """Also where the library is a module's own: Python keeps its symbols to itself."""
    code = """
import OpenImageIO
image = OpenImageIO.ImageBuf(OpenImageIO.ImageSpec(64, 48, 3, "float"))
image.specmod().attribute("dng:sensor", "nikon-d40")
image.specmod().attribute("dng:illuminant", "D65")
print(image.write("shot.dng"), image.geterror())
"""
    (tmp_path / "write.py").write_text(code)
    script = install()[1].splitlines()[2] + "\npython write.py"
    done = run("sh", "-c", script, cwd=tmp_path, env=clean(environment))
    assert done.stdout.split() == ["True"], done.stdout + done.stderr
    assert (tmp_path / "shot.dng").read_bytes()[:4] == b"II*\0"


def test_doctor_works_once_the_variables_are_set(environment, tmp_path):
    script = 'cg2raw doctor; eval "$(cg2raw env)" && cg2raw doctor'
    done = run("sh", "-c", script, cwd=tmp_path, env=clean(environment))
    tool = environment / "oiiotool"
    before, after = done.stdout.split(f"{tool}: ")[1:3]
    assert 'eval "$(cg2raw env)"' in before and "works" not in before.split("\n\n")[0]
    assert "a 16x16 DNG: works" in after.split("\n\n")[0]


def test_nothing_but_c_and_cpp_comes_from_the_system(unpacked):
    programs = sorted(unpacked.rglob("*.so*"))
    assert len(programs) >= 5  # the module, and loader and plugin for two APIs
    for program in programs:
        found = run("readelf", "-d", program).stdout
        needed = re.findall(r"\(NEEDED\).*\[(.*)\]", found)
        assert needed and all(re.fullmatch(SYSTEM, name) for name in needed), program
        assert "RUNPATH" not in found and "RPATH" not in found


def exports(program):
    """Return the names that a shared library defines for others."""
    listed = run("nm", "-D", "--defined-only", program).stdout
    return {line.split()[-1] for line in listed.splitlines()}


def test_a_loader_exports_what_its_plugin_exports(unpacked):
    folders = sorted(unpacked.glob("cg2raw/lib/cg2raw/oiio-*"))
    assert [f.name for f in folders][-2:] == ["oiio-3.0", "oiio-3.1"]
    for folder in folders:
        names = exports(folder / "libcg2raw_dng_imageio.so")
        assert exports(folder / "dng.imageio.so") == names
        assert {"dng_imageio_version", "dng_output_imageio_create"} <= names


def test_a_loader_without_its_plugin_is_refused_and_said(environment, tmp_path):
    found = run(environment / "cg2raw", "env", "--json", env=clean(environment))
    folder = re.search(r'"(/[^:"]*/oiio-3.1)', found.stdout)[1]
    shutil.copy(f"{folder}/dng.imageio.so", tmp_path)
    words = [
        environment / "oiiotool",
        "--pattern",
        "black",
        "16x16",
        "3",
        "-o",
        "x.dng",
    ]
    variables = {"OPENIMAGEIO_PLUGIN_PATH": str(tmp_path), "OPENIMAGEIO_DEBUG": "1"}
    done = run(*words, cwd=tmp_path, env={**clean(environment), **variables})
    assert done.returncode != 0 and not (tmp_path / "x.dng").exists()
    assert f"cg2raw: {tmp_path}/libcg2raw_dng_imageio.so: cannot open" in done.stderr


def test_the_wheel_has_licences_and_says_which_it_is(unpacked):
    [metadata] = unpacked.glob("cg2raw-*.dist-info/METADATA")
    text = metadata.read_text()
    assert "\nRequires-Python: >=3.10\n" in text and "\nName: cg2raw\n" in text
    [licences] = unpacked.glob("cg2raw-*.dist-info/licenses/**/wheel-licenses.md")
    assert "Sam Leffler" in licences.read_text()


def test_a_python_that_is_none_is_one_line(repository):
    done = run(repository / "scripts/wheel", "/usr/bin/false")
    assert done.returncode == 1
    assert done.stderr.splitlines() == ["wheel: /usr/bin/false is no Python"]
