# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Make an OpenImageIO SDK (headers, libraries, CMake package) out of the PyPI wheel.

    python scripts/oiio_wheel_sdk.py FOLDER

The wheel that is installed beside this interpreter has the shared libraries and no
headers; the sdist of the same version has the headers. FOLDER then works as any SDK
does: cmake -DCMAKE_PREFIX_PATH=FOLDER. A folder that already fits is left alone.
"""

import importlib.metadata
import importlib.util
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

# OpenImageIO's headers ask for their own copy of fmt, which the sdist does not hold.
# The plugin formats its messages by itself, so any fmt that compiles will do.
FMT_HEADERS = ("format.h", "ostream.h", "printf.h")

CONFIG = """\
# Made by scripts/oiio_wheel_sdk.py from the PyPI wheel of OpenImageIO {version}.
include(CMakeFindDependencyMacro)
find_dependency(Imath)
get_filename_component(_sdk "${{CMAKE_CURRENT_LIST_DIR}}/../../.." ABSOLUTE)
foreach(_name OpenImageIO_Util OpenImageIO)
  if(NOT TARGET OpenImageIO::${{_name}})
    add_library(OpenImageIO::${{_name}} SHARED IMPORTED)
    set_target_properties(OpenImageIO::${{_name}} PROPERTIES
      IMPORTED_LOCATION "${{_sdk}}/lib/lib${{_name}}.so.{soversion}"
      IMPORTED_SONAME "lib${{_name}}.so.{soversion}"
      INTERFACE_COMPILE_FEATURES cxx_std_17
      INTERFACE_INCLUDE_DIRECTORIES "${{_sdk}}/include"
      INTERFACE_LINK_LIBRARIES Imath::Imath)
  endif()
endforeach()
set_property(TARGET OpenImageIO::OpenImageIO APPEND PROPERTY
  INTERFACE_LINK_LIBRARIES OpenImageIO::OpenImageIO_Util)
"""

CONFIG_VERSION = """\
set(PACKAGE_VERSION "{version}")
if(PACKAGE_VERSION VERSION_LESS PACKAGE_FIND_VERSION)
  set(PACKAGE_VERSION_COMPATIBLE FALSE)
else()
  set(PACKAGE_VERSION_COMPATIBLE TRUE)
endif()
"""


def main(folder):
    """Build the SDK in @folder, or leave it if it already is the installed wheel's."""
    version = importlib.metadata.version("OpenImageIO")
    package = Path(importlib.util.find_spec("OpenImageIO").origin).parent
    stamp = folder / "stamp"
    text = f"{version} {package} {Path(__file__).stat().st_mtime}"
    if stamp.is_file() and stamp.read_text() == text:
        return
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    soversion = link_libraries(package / "lib", folder / "lib")
    with tempfile.TemporaryDirectory() as download:
        unpack_headers(sdist(version, Path(download)), folder / "include")
    include = folder / "include" / "OpenImageIO"
    write_version_header(include, version)
    forward_fmt(include / "detail" / "fmt")
    write_config(folder / "lib" / "cmake" / "OpenImageIO", version, soversion)
    stamp.write_text(text)
    print(f"OpenImageIO {version}: SDK in {folder}")


def link_libraries(wheel, target):
    """Link the wheel's libraries into @target; return the version of their names."""
    target.mkdir()
    libraries = sorted(wheel.glob("libOpenImageIO*.so.*"))
    if len(libraries) != 2:
        sys.exit(
            f"{wheel}: expected libOpenImageIO and libOpenImageIO_Util, found "
            f"{[path.name for path in libraries]}"
        )
    for library in libraries:
        (target / library.name).symlink_to(library)
    return libraries[0].name.split(".so.")[1]


def sdist(version, folder):
    """Download the source archive of @version into @folder; return its path."""
    # pip asks the archive for its metadata, for which it fetches the build backend into
    # an isolated environment; nothing is compiled.
    subprocess.run(
        [
            sys.executable,
            "-m",
            "pip",
            "download",
            "--quiet",
            "--no-deps",
            "--disable-pip-version-check",
            "--no-binary",
            "OpenImageIO",
            "--dest",
            folder,
            f"OpenImageIO=={version}",
        ],
        check=True,
    )
    return next(folder.glob("*.tar.gz"))


def unpack_headers(archive, target):
    """Copy the files of src/include/OpenImageIO out of @archive."""
    with tarfile.open(archive) as tar:
        for member in tar:
            path = member.name.partition("/src/include/")[2]
            if member.isfile() and path.startswith("OpenImageIO/") and ".." not in path:
                file = target / path
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_bytes(tar.extractfile(member).read())


def write_version_header(include, version):
    """Fill oiioversion.h.in in as OpenImageIO's own CMake does for a release."""
    major, minor, patch, tweak = [*version.split("."), "0"][:4]
    values = {
        "PROJECT_VERSION_MAJOR": major,
        "PROJECT_VERSION_MINOR": minor,
        "PROJECT_VERSION_PATCH": patch,
        "PROJECT_VERSION_TWEAK": tweak,
        "PROJECT_VERSION_RELEASE_TYPE": "",
        "OIIO_USE_COMPILED_FMT_VALUE": "0",
        "PROJ_NAME": "OIIO",
        "PROJ_NAMESPACE": "OpenImageIO",
        "PROJ_NAMESPACE_V": f"OpenImageIO_v{major}_{minor}",
        "PROJ_VERSION_NAMESPACE": f"v{major}_{minor}",
        "CMAKE_CXX_STANDARD": "17",
        "Imath_VERSION_MAJOR": "3",
        "Imath_VERSION_MINOR": "1",
    }
    text = (include / "oiioversion.h.in").read_text()
    text = text.replace("#cmakedefine01 OIIO_TBB", "#define OIIO_TBB 0")
    text = re.sub(r"@(\w+)@", lambda match: values[match[1]], text)
    (include / "oiioversion.h").write_text(text)


def forward_fmt(folder):
    """Forward OpenImageIO/detail/fmt/*.h to the fmt that the system has."""
    folder.mkdir(parents=True, exist_ok=True)
    for name in FMT_HEADERS:
        (folder / name).write_text(f"#include <fmt/{name}>\n")


def write_config(folder, version, soversion):
    """Write the CMake package."""
    folder.mkdir(parents=True)
    (folder / "OpenImageIOConfig.cmake").write_text(
        CONFIG.format(version=version, soversion=soversion)
    )
    (folder / "OpenImageIOConfigVersion.cmake").write_text(
        CONFIG_VERSION.format(version=version)
    )


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(Path(sys.argv[1]).absolute())
