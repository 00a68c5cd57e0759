# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""spack package: core, DNG writer and OpenImageIO plugin; +python adds the package."""

import os

from spack.package import *


class Cg2raw(CMakePackage):
    """A computer-graphics image becomes the RAW file of a chosen sensor: an OpenImageIO
    plugin that writes DNG, a C++ core and Python bindings."""

    license("Apache-2.0")

    # The tree that this file is part of: spack dev-build cg2raw@main, or a url and
    # version("0.1.0", sha256=...) of a release.
    git = "file://" + os.path.realpath(
        os.path.join(os.path.dirname(__file__), "../../../..")
    )
    version("main", branch="main")

    variant(
        "python", default=True, description="Install the Python package and command"
    )

    depends_on("cxx", type="build")
    depends_on("cmake@3.20:", type="build")
    depends_on("fmt", type="build")
    depends_on("nlohmann-json@3.9:", type="build")
    depends_on("libtiff@4.5:")
    depends_on("openimageio@2.4:")

    with when("+python"):
        extends("python@3.10:")
        depends_on("py-pip", type="build")
        depends_on("py-pybind11@2.12:", type="build")
        depends_on("py-scikit-build-core@0.10:", type="build")
        depends_on("py-exifread@3:", type="run")
        depends_on("py-matplotlib@3.8:", type="run")
        depends_on("py-numpy@1.26:", type="run")
        depends_on("py-rawpy@0.22:", type="run")
        depends_on("py-rich@13:", type="run")

    def cmake_args(self):
        """Return the options of CMake; the plugin's folder is lib, also where libraries
        go to lib64."""
        return [self.define("CMAKE_INSTALL_LIBDIR", "lib")]

    @run_after("install")
    def install_python(self):
        """Install the Python package into the prefix, by pip and scikit-build-core."""
        if self.spec.satisfies("+python"):
            words = ["-m", "pip", "install", "--no-deps", "--no-build-isolation"]
            python = self.spec["python"].command
            python(*words, f"--prefix={self.prefix}", self.stage.source_path)

    def setup_run_environment(self, env):
        """Let OpenImageIO find the plugin, by the variable that all versions read."""
        env.prepend_path("OIIO_LIBRARY_PATH", self.prefix.lib.cg2raw.oiio)
