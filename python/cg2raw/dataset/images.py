# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The images of a data set, in the order of the manifest."""

import os
from collections.abc import Iterable, Iterator, Sequence

ENDINGS = (".exr", ".png", ".tif", ".tiff", ".hdr")


def folder_of(image: str) -> str:
    """Return the folder that an image's files have in a data set: its name without the
    ending of an image file, as file managers and globs know folders."""
    stem, ending = os.path.splitext(image)
    return stem if ending.lower() in ENDINGS and os.path.basename(stem) else image


class Images:
    """The images of one folder, or of files: iterated as (name, path), always anew.

    paths : one folder, searched through, or files. skip : a folder that is left out, as
    the data set's own may lie inside. Nothing is kept in memory but a folder's names.
    Raises ValueError for paths that are not there, or that would have one folder in the
    data set, as a.exr and a.tif."""

    def __init__(self, paths: Sequence[str], skip: str) -> None:
        self.skip = os.path.realpath(skip)
        self.folder = paths[0] if len(paths) == 1 and os.path.isdir(paths[0]) else None
        self.files: dict[str, str] = {}  # by their names
        if self.folder is None:
            for path in paths:
                self.add(path)
            check_apart(self.files)

    def add(self, path: str) -> None:
        """Take one file in."""
        if os.path.isdir(path):
            raise ValueError(f"{path}: is a folder; give one folder alone, or files")
        if not os.path.exists(path):
            raise ValueError(f"{path}: there is no such file or folder")
        name = os.path.basename(path)
        if name in self.files:
            raise ValueError(
                f"{path}: has the name of {self.files[name]}; the data set tells them "
                "by it: rename one, or give their common folder"
            )
        self.files[name] = path

    def __iter__(self) -> Iterator[tuple[str, str]]:
        if self.folder is not None:
            yield from self.walk(self.folder, "")
        else:
            yield from sorted(self.files.items())

    def walk(self, folder: str, prefix: str) -> Iterator[tuple[str, str]]:
        """Yield the images of a folder and those below it."""
        names = sorted(os.listdir(folder))
        check_apart(
            f"{prefix}{name}"
            for name in names
            if is_image(name) and not os.path.isdir(os.path.join(folder, name))
        )
        for name in names:
            path = os.path.join(folder, name)
            if name.startswith(".") or os.path.realpath(path) == self.skip:
                continue
            if os.path.isdir(path) and not os.path.islink(path):
                yield from self.walk(path, f"{prefix}{name}/")
            elif is_image(name) and not os.path.isdir(path):
                yield f"{prefix}{name}", path

    def has(self, name: str) -> bool:
        """Return whether an image of this name is there."""
        if self.folder is not None:
            return os.path.exists(os.path.join(self.folder, name))
        return name in self.files


def is_image(name: str) -> bool:
    """Return whether a name is that of an image file that is not hidden."""
    return name.lower().endswith(ENDINGS) and not name.startswith(".")


def check_apart(images: Iterable[str], folds_case: bool = False) -> None:
    """Raise ValueError if two images would have one folder.

    folds_case : A.exr and a.exr would, too."""
    first: dict[str, str] = {}
    for image in images:
        folder = folder_of(image)
        other = first.setdefault(folder.casefold() if folds_case else folder, image)
        if other != image:
            raise ValueError(
                f"{other} and {image}: would both be {folder_of(image)}/ in the data "
                "set; rename one of them"
            )
