# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Make the prefix that wheels are built against: a static libtiff, and the headers of
the oldest OpenImageIO wheel of each plugin API.

    python scripts/wheel_prefix.py PREFIX          # libtiff, the system's other headers
    python scripts/wheel_prefix.py --all PREFIX    # also nlohmann/json, fmt and Imath

scripts/wheel runs the first, on Debian; cibuildwheel the second, in its container. What
is there already stays. libtiff comes without codecs: the DNG writer compresses itself,
and the reader reads tags.
"""

import argparse
import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
import urllib.request
from pathlib import Path

from oiio_wheel_sdk import forward_fmt, sdist, unpack_headers, write_version_header

# The oldest wheel of each C++ namespace: later ones only add to it.
OPENIMAGEIOS = ("3.0.3.1", "3.1.7.0")
# Debian 12's and 13's have no wheel; their headers are taken where they are installed.
SYSTEMS = ("2.4", "2.5")
APT = "/usr/lib/apt/apt-helper"
GITHUB, DEBIAN = "https://github.com", "http://deb.debian.org/debian/pool/main"

# {name: ((address, SHA-256), ...)}
ARCHIVES = {
    "tiff-4.7.0": (
        (
            "https://download.osgeo.org/libtiff/tiff-4.7.0.tar.gz",
            "67160e3457365ab96c5b3286a0903aa6e78bdc44c4bc737d2e486bcecb6ba976",
        ),
        (
            f"{DEBIAN}/t/tiff/tiff_4.7.0.orig.tar.bz2",
            "2b8b5c4e79cb2a4651796602e45d6179b7f18bc283feab417b8e881ef7e81862",
        ),
    ),
    "json-3.11.3": (
        (
            f"{GITHUB}/nlohmann/json/archive/refs/tags/v3.11.3.tar.gz",
            "0d8ef5af7f9794e3263480193c491549b2ba6cc74bb018906202ada498a79406",
        ),
    ),
    "fmt-10.2.1": (
        (
            f"{GITHUB}/fmtlib/fmt/archive/10.2.1.tar.gz",
            "1250e4cc58bf06ee631567523f48848dc4596133e163f02615c97f78bab6c811",
        ),
    ),
    "Imath-3.1.12": (
        (
            f"{GITHUB}/AcademySoftwareFoundation/Imath/archive/refs/tags/v3.1.12.tar.gz",
            "8a1bc258f3149b5729c2f4f8ffd337c0e57f09096e4ba9784329f40c4a9035da",
        ),
    ),
}
OFF = {
    "tiff-4.7.0": "cxx tiff-tools tiff-tests tiff-contrib tiff-docs jpeg old-jpeg zlib "
    "libdeflate pixarlog jbig lerc lzma zstd webp ccitt packbits lzw thunder next "
    "logluv mdi",
    "json-3.11.3": "JSON_BuildTests",
    "fmt-10.2.1": "FMT_TEST FMT_DOC",
    "Imath-3.1.12": "BUILD_TESTING",
}


def main():
    """Make what is missing; print the lines that a shell needs to build against it."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("prefix", type=lambda text: Path(text).absolute())
    parser.add_argument("--all", action="store_true", help="the system has no headers")
    arguments = parser.parse_args()
    prefix = arguments.prefix
    for name in ARCHIVES if arguments.all else list(ARCHIVES)[:1]:
        if not (prefix / "share/cg2raw" / name).exists():
            build(name, prefix)
    headers = [openimageio_headers(version, prefix) for version in OPENIMAGEIOS]
    if not arguments.all:
        headers += system_headers(prefix)
    print(f"export CMAKE_PREFIX_PATH='{prefix}'")
    print(f"export CG2RAW_OIIO_HEADERS='{';'.join(map(str, headers))}'")


def build(name, prefix):
    """Build and install the archive called @name into @prefix."""
    with tempfile.TemporaryDirectory() as folder:
        shutil.unpack_archive(fetch(name, Path(folder)), Path(folder, "unpacked"))
        [source] = Path(folder, "unpacked").iterdir()
        cmake = ["cmake", "-S", source, "-B", Path(folder, "build")]
        cmake += [f"-D{option}=OFF" for option in OFF[name].split()]
        cmake += ["-DBUILD_SHARED_LIBS=OFF", "-DCMAKE_POSITION_INDEPENDENT_CODE=ON"]
        cmake += ["-DCMAKE_BUILD_TYPE=Release", f"-DCMAKE_INSTALL_PREFIX={prefix}"]
        cmake += ["-DCMAKE_INSTALL_LIBDIR=lib", "-DCMAKE_POLICY_VERSION_MINIMUM=3.5"]
        cmake += ["-G", "Ninja"] if shutil.which("ninja") else []  # else make, if there
        jobs = str(os.cpu_count() or 1)
        quiet = {"check": True, "stdout": sys.stderr}
        subprocess.run(cmake, **quiet)
        subprocess.run(["cmake", "--build", cmake[4], "-j", jobs], **quiet)
        subprocess.run(["cmake", "--install", cmake[4]], **quiet)
        # libtiff's own package names a target of its build (CMath) that it does not
        # install; CMake's FindTIFF, which asks it first from 3.26 on, needs none.
        shutil.rmtree(prefix / "lib/cmake/tiff", ignore_errors=True)
        licences = prefix / "share/cg2raw" / name
        licences.mkdir(parents=True)
        for licence in source.glob("LICENSE*"):
            if licence.is_file():
                shutil.copy(licence, licences)


def fetch(name, folder):
    """Download the archive called @name into @folder from the first place that has it;
    return its path."""
    complaints = []
    for url, digest in ARCHIVES[name]:
        target = folder / url.rpartition("/")[2]
        try:
            if url.startswith(DEBIAN) and os.access(APT, os.X_OK):
                words = [APT, "download-file", url, str(target), f"SHA256:{digest}"]
                subprocess.run(words, check=True, stdout=sys.stderr)
            else:
                with urllib.request.urlopen(url, timeout=60) as answer:
                    target.write_bytes(answer.read())
        except (OSError, subprocess.CalledProcessError) as error:
            complaints.append(f"{url}: {error}")
            continue
        if hashlib.sha256(target.read_bytes()).hexdigest() == digest:
            return target
        complaints.append(f"{url}: its SHA-256 is not {digest}")
    sys.exit(f"wheel_prefix: no {name}: {'; '.join(complaints)}")


def openimageio_headers(version, prefix):
    """Return the folder with the headers of the wheel's @version, made if need be."""
    folder = prefix / f"oiio-{version}"
    if not (folder / "OpenImageIO/oiioversion.h").is_file():
        shutil.rmtree(folder, ignore_errors=True)
        with tempfile.TemporaryDirectory() as download:
            unpack_headers(sdist(version, Path(download)), folder)
        forward_fmt(folder / "OpenImageIO/detail/fmt")
        write_version_header(folder / "OpenImageIO", version)
    return folder


def system_headers(prefix):
    """Return the folders of the system's headers, if they are of one of SYSTEMS."""
    installed = Path("/usr/include/OpenImageIO")
    version = installed / "oiioversion.h"
    text = version.read_text() if version.is_file() else ""
    folders = []
    for name in SYSTEMS:
        folder = prefix / f"oiio-{name}"
        if f'"OpenImageIO_v{name.replace(".", "_")}"' in text:
            folder.mkdir(parents=True, exist_ok=True)
            if not (folder / "OpenImageIO").exists():
                (folder / "OpenImageIO").symlink_to(installed)
            folders.append(folder)
    return folders


if __name__ == "__main__":
    main()
