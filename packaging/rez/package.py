# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""rez package: the OpenImageIO plugin, the Python package and the command cg2raw.

    cd packaging/rez && rez build --install
    rez env cg2raw openimageio -- oiiotool shot.exr --attrib dng:sensor nikon-d40 ...

Package names are those of the VFX Reference Platform; a studio that calls its libraries
otherwise changes them here.
"""

name = "cg2raw"
version = "0.1.0"
description = "A computer-graphics image becomes the RAW file of a chosen sensor"
authors = ["Contributors to the cg2raw Project"]
tools = ["cg2raw"]

requires = [
    "exifread-3+",
    "libtiff-4.5+",
    "matplotlib-3.8+",
    "numpy-1.26+",
    "rawpy-0.22+",
    "rich-13+",
]
private_build_requires = [
    "cmake-3.20+",
    "fmt",
    "imath",
    "ninja",
    "nlohmann_json-3.9+",
    "pybind11-2.12+",
    "scikit_build_core-0.10+",
]
# A plugin fits one plugin API of OpenImageIO: 25 in 2.4 and 2.5, 27 in 3.1 and 3.2.
variants = [
    ["platform-linux", "python-3.11", "openimageio-3.1+<3.3"],
    ["platform-linux", "python-3.11", "openimageio-2.5"],
]

# {root} is this folder; the sources are two above it.
build_command = """
set -e
cmake -S {root}/../.. -B cmake -G Ninja -DCMAKE_INSTALL_LIBDIR=lib
cmake --build cmake
if [ {install} ]; then
    cmake --install cmake --prefix $REZ_BUILD_INSTALL_PATH
    python -m pip install {root}/../.. --no-deps --no-build-isolation \
        --target $REZ_BUILD_INSTALL_PATH/lib/python
fi
"""


def commands():
    """Set what cg2raw, Python, OpenImageIO and OpenColorIO look for."""
    env.PATH.prepend("{root}/lib/python/bin")
    env.PYTHONPATH.prepend("{root}/lib/python")
    env.OIIO_LIBRARY_PATH.prepend("{root}/lib/cg2raw/oiio")
    if "openimageio" in resolve and resolve.openimageio.version >= "3":
        env.OPENIMAGEIO_PLUGIN_PATH.prepend("{root}/lib/cg2raw/oiio")
    if undefined("OCIO"):
        env.OCIO = "{root}/share/cg2raw/ocio/sensors.ocio"
