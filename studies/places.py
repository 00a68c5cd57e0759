# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Where the studies' data lie, luxpy's files and the camera data of the tests, and what
files hold."""

import hashlib
import importlib.util
import os
from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LUXPY_VARIABLE, DATA_VARIABLE = "CG2RAW_LUXPY_DATA", "CG2RAW_TEST_DATA"


def luxpy_folder(given: str | Path | None = None) -> Path | None:
    """Return luxpy's folder of data files, None if there is none.

    given : the folder, or the one that holds it; by default the environment variable
        CG2RAW_LUXPY_DATA, or else the installed luxpy, which is not imported.
    Raises ValueError for a folder that is named and lacks the files."""
    named = given or os.environ.get(LUXPY_VARIABLE)
    if named:
        found = [Path(named), Path(named) / "data", Path(named) / "luxpy" / "data"]
    else:
        package = importlib.util.find_spec("luxpy")
        places = package.submodule_search_locations if package else None
        found = [Path(place) / "data" for place in places or ()]
    for folder in found:
        if (folder / "rfls").is_dir() and (folder / "spds").is_dir():
            return folder
    if named:
        raise ValueError(f"{named}: holds no folders rfls and spds of luxpy's data")
    return None


def data_folder(given: str | Path | None = None) -> Path:
    """Return the folder of camera data. Raises ValueError if it is not there."""
    default = ROOT.parent / "shared" / "data"
    folder = Path(given or os.environ.get(DATA_VARIABLE) or default)
    if not (folder / "tables").is_dir():
        raise ValueError(
            f"{folder}: holds no camera data (tables); --data or {DATA_VARIABLE} "
            "names the folder"
        )
    return folder


def files_hash(paths: Iterable[Path]) -> str:
    """Return the hash of files' names and bytes, in their order."""
    digest = hashlib.sha256()
    for path in paths:
        digest.update(path.name.encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]
