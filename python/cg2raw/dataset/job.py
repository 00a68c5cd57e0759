# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Job: all files for one image, read once, made in order; finished ones are kept."""

import contextlib
import hashlib
import json
import os
import uuid
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from cg2raw import RawFrame, __version__, _core, write_dng
from cg2raw.arrays import FloatImage
from cg2raw.dataset import journal, manifest, packed
from cg2raw.dataset.journal import Row
from cg2raw.dataset.methods import METHODS, Camera
from cg2raw.dataset.plan import Plan, Variant
from cg2raw.dataset.source import Source, read_source
from cg2raw.dataset.truth import noise_of, truth
from cg2raw.system import Folder

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


def make(job: Job, say: Callable[[Row], None] = lambda row: None) -> Row:
    """Make all files of one image that are not there yet.

    say : called with {"image", "files"}, how many are finished, for each.
    Returns {"image", "made", "kept", "reason"}: reason says in one line why the image
    cannot be used, None if it can. Raises OSError or ValueError if the data set cannot
    be written: no other image could be either."""
    plan = plan_at(job.out, job.plan_sha256)
    target = Target(job, plan)
    try:
        header = target.header()
        todo = target.open_variants()
        if todo:
            make_variants(target, header, todo, say)
        elif target.has_strange_rows:
            journal.start(target.journal, header, target.rows.values())
    except BadImage as bad:
        return give_up(job, str(bad))
    made, kept = len(todo), len(target.rows)
    return {"image": job.image, "made": made, "kept": kept, "reason": None}


def give_up(job: Job, reason: str) -> Row:
    """Remember why an image cannot be used; nothing of it stays. Returns the result."""
    target = Target(job, plan_at(job.out, job.plan_sha256))
    target.remove_files()
    journal.start(target.journal, {"image": job.image, "reason": reason})
    return {"image": job.image, "made": 0, "kept": 0, "reason": reason}


class BadImage(Exception):
    """An image that cannot be used; the data set goes on without it."""


@lru_cache(maxsize=2)
def plan_at(out: str, plan_sha256: str) -> Plan:
    """Return the Plan of a folder. Raises ValueError if it is not the one expected."""
    path = os.path.join(out, "dataset.json")
    try:
        with open(path, "rb") as stream:
            data = stream.read()
    except FileNotFoundError:
        raise ValueError(
            f"{path}: a worker does not see it: OUT must be a path that all machines "
            "share"
        ) from None
    if hashlib.sha256(data).hexdigest() != plan_sha256:
        raise ValueError(f"{path}: has changed while the data set was being made")
    version = json.loads(data)["cg2raw"]
    if version != __version__:
        raise ValueError(
            f"{path}: is of cg2raw {version}, and a worker has {__version__}: install "
            "the same on all machines"
        )
    return Plan.from_json(data)


class Target:
    """One image's files and their journal."""

    def __init__(self, job: Job, plan: Plan) -> None:
        self.job, self.plan = job, plan
        self.journal = journal.path_of(job.out, job.image)
        self.rows: dict[str, Row] = {}  # finished files, {path: row}
        self.has_strange_rows = False  # in the journal, of files that nobody asked for

    def header(self) -> Row:
        """Return what is known of the image file, and find the rows that still hold."""
        old, rows = journal.read(self.journal)
        old = old if old and "sha256" in old else None  # else it was given up
        if not is_utf8(self.job.image):
            raise BadImage("its name is no UTF-8; rename the file")
        try:
            status = os.stat(self.job.path)
            header = {
                "image": self.job.image,
                "bytes": status.st_size,
                "modified": status.st_mtime_ns,
            }
            if old and all(old.get(name) == header[name] for name in header):
                header["sha256"] = old["sha256"]
            else:
                header["sha256"] = file_sha256(self.job.path)
        except OSError as error:
            raise BadImage(error.strerror) from None
        if old and old["sha256"] == header["sha256"]:
            self.rows = {
                variant.path: rows[variant.path]
                for order, variant in self.variants()
                if variant.path in rows
                and self.holds(rows[variant.path], expected(header, order, variant))
            }
        elif old:
            self.remove_files()
        self.has_strange_rows = rows.keys() != self.rows.keys()
        return header

    def variants(self) -> Iterator[tuple[int, Variant]]:
        """Return (order, Variant) of all files of the image."""
        return enumerate(self.plan.variants(self.job.image, self.job.index))

    def holds(self, row: Row, expected: Row) -> bool:
        """Return whether a row is of the file that is asked for, and that is there."""
        if not row.keys() >= manifest.NAMES | expected.keys():
            return False
        if any(row[name] != value for name, value in expected.items()):
            return False
        below, name = os.path.split(row["path"])
        try:
            with Folder(self.job.out, below) as folder:
                size, sha256 = size_and_sha256(folder, name, self.job.verify == "hash")
        except OSError:
            return False
        return size == row["bytes"] and sha256 in (None, row["sha256"])

    def open_variants(self) -> list[tuple[int, Variant]]:
        """Return [(order, Variant)] of what is to be made."""
        return [pair for pair in self.variants() if pair[1].path not in self.rows]

    def remove_files(self) -> None:
        """Remove what was made of another image of this name."""
        for _, variant in self.variants():
            below, name = os.path.split(variant.path)
            with (
                contextlib.suppress(FileNotFoundError),
                Folder(self.job.out, below) as folder,
            ):
                folder.remove(name)

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
                write(parts.path_of(part))
                row["bytes"], row["sha256"] = size_and_sha256(parts, part)
                parts.replace(part, place, name)
            except BaseException:
                with contextlib.suppress(FileNotFoundError):
                    parts.remove(part)
                raise
        journal.append(self.journal, row)


def is_utf8(name: str) -> bool:
    """Return whether a file's name is UTF-8; the core and Parquet take no other."""
    return name == name.encode(errors="replace").decode()


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


def make_variants(
    target: Target,
    header: Row,
    todo: list[tuple[int, Variant]],
    say: Callable[[Row], None],
) -> None:
    """Read the image once and make the files of @todo."""
    path, plan = target.job.path, target.plan
    try:
        source = read_source(path, plan)
        height, width = source.image.pixels.shape[:2]
        crops = [
            plan.crop_at(target.job.image, patch, width, height)
            for patch in range(plan.patches)
        ]
        shot = _core.Shot(**source.image.shot)
        seconds = plan.seconds(shot.exposure_time)
    except (ValueError, OSError, MemoryError) as error:
        reason = str(error) or "needs more memory than there is"
        raise BadImage(reason.removeprefix(f"{path}: ")) from None
    journal.start(target.journal, header, target.rows.values())
    of_image = source.row() | {"exposure_time": seconds}
    for count, (order, variant) in enumerate(todo, len(target.rows)):
        say({"image": target.job.image, "files": count})
        box = crops[variant.patch]
        about = expected(header, order, variant) | {"crop": list(box)}
        make_variant(target, variant, source, about, of_image)


def make_variant(
    target: Target, variant: Variant, source: Source, about: Row, of_image: Row
) -> None:
    """Make one file; its pixels are gone before the next one's are there.

    about, of_image : what the manifest says of the file, and of its image."""
    plan = target.plan
    camera = METHODS[plan.method](
        plan.cameras[variant.sensor], variant.scene, plan.seed
    )
    x, y, columns, rows = about["crop"]
    try:
        seen = source.seen((x, y, columns, rows), camera.sensor, camera.illuminant)
    except ValueError as error:
        raise BadImage(str(error)) from None
    write, row = simulated(plan, variant, camera, seen, of_image["exposure_time"])
    target.publish(write, variant, {**about, **row, **of_image})


def simulated(
    plan: Plan,
    variant: Variant,
    camera: Camera,
    seen: tuple[FloatImage, dict[str, Any]],
    seconds: float | None,
) -> tuple[Write, Row]:
    """Return (write(path), what the manifest says of the simulation).

    seen : pixels, and the fields of a Run that they decide."""
    sensor, gain = camera.sensor, camera.digital_gain
    scene, of_pixels = seen
    run = plan.run(camera, variant.iso, seconds) | of_pixels
    raw = sensor.simulate(scene, threads=1, frame=variant.frame, **run)
    shape = raw.shape
    if plan.format == "dng":
        write = dng_writer(plan, raw, seconds)
    else:
        planes = packed.packed(
            raw, sensor.cfa, sensor.black_level, sensor.white_level, plan.element_type
        )
        shape = planes.shape[1:]
        write_planes = getattr(packed, f"write_{plan.format}")

        def write(path: str) -> None:
            write_planes(path, planes)

    drawn = {"illuminant": camera.illuminant, "method_seed": camera.seed}
    simulation = raw.simulation
    assert simulation is not None  # of what Sensor.simulate returns
    drawn["spectrum"] = simulation.spectrum or None
    light, convention = simulation.illuminant, run["convention"]
    row = truth(sensor, light, convention, gain, shape)
    return write, drawn | row | noise_of(sensor, variant.iso, plan.noise)


def dng_writer(plan: Plan, raw: RawFrame, seconds: float | None) -> Write:
    """Return write(path) of a DNG, whose Exif says the exposure time if it is known."""
    shot = None if seconds is None else {"exposure_time": seconds}
    # A file that a loss of power leaves partial is known by its hash, and made again.
    how: dict[str, Any] = {"compression": plan.compression, "preview": False}
    how |= {"threads": 1, "sync": False}

    def write(path: str) -> None:
        write_dng(path, raw, shot=shot, **how)

    return write


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
