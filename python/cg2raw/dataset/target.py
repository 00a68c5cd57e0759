# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Target: the files of one image, which of them still hold, and their journal."""

import contextlib
import hashlib
import os
import uuid
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

from cg2raw import __version__
from cg2raw.core_arguments import has_surrogates
from cg2raw.dataset import journal, manifest
from cg2raw.dataset.images import folder_of
from cg2raw.dataset.journal import Row
from cg2raw.dataset.plan import Plan, Variant
from cg2raw.system import Folder, check_regular

Write = Callable[[str], None]  # of the file at a path

PARTS = "parts"  # folder of files that are being written
BLOCK = 1 << 20  # bytes that are hashed at a time


@dataclass
class Job:
    """One image of a data set whose plan is out/dataset.json."""

    out: str
    plan_sha256: str
    image: str  # the name by which the data set knows it
    path: str
    index: int  # among the images
    verify: str = "hash"  # what must be as written for a file to be kept; or "size"


class BadImage(Exception):
    """An image that cannot be used; the data set goes on without it."""


class Target:
    """One image's files and their journal."""

    def __init__(self, job: Job, plan: Plan) -> None:
        self.job, self.plan = job, plan
        self.journal = journal.path_of(job.out, job.image)
        self.rows: dict[str, Row] = {}  # finished files, {path: row}
        self.journal_differs = False  # from what is to stand in it

    def header(self) -> Row:
        """Return what is known of the image file, and find the rows that still hold."""
        old, texts = journal.read_texts(self.journal)
        old = old if journal.names(old, "sha256") else None  # else it was given up
        if has_surrogates(self.job.image):
            raise BadImage("is not UTF-8; rename the file or folder")
        try:
            status = os.stat(self.job.path)
            check_regular(self.job.path, status.st_mode)  # a pipe would be waited for
            header = {
                "image": self.job.image,
                "columns": manifest.COLUMNS_DIGEST,
                "bytes": status.st_size,
                "modified": status.st_mtime_ns,
            }
            if old and is_of(old, status):
                header["sha256"] = old["sha256"]
            else:
                header["sha256"] = file_sha256(self.job.path)
        except OSError as error:
            raise BadImage(reason_of(error, self.job.path)) from None
        if old and old["sha256"] == header["sha256"]:
            self.rows = self.rows_that_hold(header, journal.by_path(texts))
        elif old:
            self.remove_files()
        self.journal_differs = (
            len(texts) != len(self.rows)
            or (old or {}).get("columns") != header["columns"]
        )
        return header

    @cached_property
    def variants(self) -> list[tuple[int, Variant]]:
        """Return [(order, Variant)] of all files of the image."""
        return list(enumerate(self.plan.variants(self.job.image, self.job.index)))

    def rows_that_hold(self, header: Row, rows: dict[str, Row]) -> dict[str, Row]:
        """Return those of a journal's rows, {path: row}, that are still true."""
        try:
            folder = Folder(self.job.out, folder_of(self.job.image))
        except OSError:
            return {}
        with folder:
            return {
                variant.path: row
                for order, variant in self.variants
                if (row := rows.get(variant.path))
                and self.holds(folder, row, expected(header, order, variant))
            }

    def holds(self, folder: Folder, row: Row, expected: Row) -> bool:
        """Return whether a row is of the file that is asked for, and that is there."""
        if not (manifest.is_whole(row) and row.items() >= expected.items()):
            return False
        name = os.path.basename(row["path"])
        try:
            size, sha256 = size_and_sha256(folder, name, self.job.verify == "hash")
        except OSError:
            return False
        return size == row["bytes"] and sha256 in (None, row["sha256"])

    def open_variants(self) -> list[tuple[int, Variant]]:
        """Return [(order, Variant)] of what is to be made."""
        return [pair for pair in self.variants if pair[1].path not in self.rows]

    def remove_files(self) -> None:
        """Remove what was made of another image of this name."""
        for _, variant in self.variants:
            below, name = os.path.split(variant.path)
            with (
                contextlib.suppress(FileNotFoundError),
                Folder(self.job.out, below) as folder,
            ):
                folder.remove(name)

    def start_journal(self, header: Row) -> None:
        """Begin the journal anew with the rows that hold. Raises OSError."""
        journal.start(self.journal, header, map(manifest.entry, self.rows.values()))

    def publish(self, write: Write, variant: Variant, row: Row) -> None:
        """Write a file, give it its name, and enter its row. Raises OSError, also if a
        folder of the data set is a link: what that leads to is not written."""
        out = self.job.out
        below, name = os.path.split(variant.path)
        part = f"{uuid.uuid4().hex}{os.path.splitext(name)[1]}"
        with (
            Folder(out, os.path.join(journal.FOLDER, PARTS), make=True) as parts,
            Folder(out, below, make=True) as place,
        ):
            try:
                with parts.path_for(part) as path:
                    write(path)
                row["bytes"], row["sha256"] = size_and_sha256(parts, part)
                parts.replace(part, place, name)
            except BaseException:
                with contextlib.suppress(FileNotFoundError):
                    parts.remove(part)
                raise
        journal.append(self.journal, manifest.entry(row))


def reason_of(error: Exception, path: str) -> str:
    """Return what an error says of a file, without its path."""
    return getattr(error, "strerror", None) or str(error).removeprefix(f"{path}: ")


def is_of(header: Row, status: os.stat_result) -> bool:
    """Return whether a header was written of an image file as it is."""
    size, modified = header.get("bytes"), header.get("modified")
    return size == status.st_size and modified == status.st_mtime_ns


def file_sha256(file: str | int) -> str:
    """Return the SHA-256 of a file, in hexadecimal.

    file : path, or a descriptor, which is closed."""
    digest = hashlib.sha256()
    with open(file, "rb", buffering=0) as stream:
        while block := stream.read(BLOCK):
            digest.update(block)
    return digest.hexdigest()


def size_and_sha256(
    folder: Folder, name: str, hashed: bool = True
) -> tuple[int, str | None]:
    """Return (bytes, SHA-256) of a file in a Folder; None for that of one that is not
    @hashed. Raises OSError, also for a link."""
    handle = folder.open(name, os.O_RDONLY)
    size = os.fstat(handle).st_size
    if hashed:
        return size, file_sha256(handle)
    os.close(handle)
    return size, None


def expected(header: Row, order: int, variant: Variant) -> Row:
    """Return what a file's row says that the plan and the image's hash decide."""
    plan = variant.plan
    return {
        "order": order,
        "path": variant.path,
        "clean_path": variant.clean_path,
        "input": variant.image,
        "input_sha256": header["sha256"],
        "sensor": variant.sensor,
        "profile_sha256": plan.profile_sha256[variant.sensor],
        "illuminant_index": variant.illuminant_index,
        "digital_gain_drawn": variant.asked_gain == "sample",
        "iso": variant.iso,
        "noise": plan.noise if variant.iso is not None else None,
        "seed": plan.seed,
        "frame": variant.frame,
        "patch": variant.patch,
        "method": plan.method,
        "convention": plan.convention,
        "format": plan.format,
        "element_type": "uint16" if plan.format == "dng" else plan.element_type,
        "compression": plan.compression if plan.format == "dng" else None,
        "cg2raw": __version__,
    }
