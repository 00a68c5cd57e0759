# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""All files of one image: read once, made in order, those that are finished kept."""

import hashlib
import json
import os
import uuid
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from cg2raw import __version__, _core, write_dng
from cg2raw.dataset import journal, packed
from cg2raw.dataset.methods import METHODS
from cg2raw.dataset.plan import Plan

PARTS = "parts"  # folder of files that are being written
BLOCK = 1 << 20  # bytes that are hashed at a time


@dataclass
class Job:
    """One image of a data set whose plan is out/dataset.json."""

    out: str
    plan_sha256: str
    image: str  # the name by which the data set knows it
    path: str


def make(job):
    """Make all files of one image that are not there yet.

    Returns {"image", "made", "kept", "reason"}: reason says in one line why the image
    cannot be used, None if it can. Raises OSError or ValueError if the data set cannot
    be written: no other image could be either."""
    plan = plan_at(job.out, job.plan_sha256)
    target = Target(job, plan)
    try:
        header = target.header()
        todo = target.open_variants()
        if todo:
            make_variants(target, header, todo)
    except BadImage as bad:
        return give_up(job, str(bad))
    made, kept = len(todo), len(target.rows)
    return {"image": job.image, "made": made, "kept": kept, "reason": None}


def give_up(job, reason):
    """Remember why an image cannot be used; nothing of it stays. Returns the result."""
    target = Target(job, plan_at(job.out, job.plan_sha256))
    target.remove_files()
    journal.start(target.journal, {"image": job.image, "reason": reason})
    return {"image": job.image, "made": 0, "kept": 0, "reason": reason}


class BadImage(Exception):
    """An image that cannot be used; the data set goes on without it."""


@lru_cache(maxsize=2)
def plan_at(out, plan_sha256):
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

    def __init__(self, job, plan):
        self.job, self.plan = job, plan
        self.journal = journal.path_of(job.out, job.image)
        self.rows = {}  # finished files, {path: row}

    def header(self):
        """Return what is known of the image file, and find the rows that still hold."""
        old, rows = journal.read(self.journal)
        if not is_utf8(self.job.image):
            raise BadImage("its name is no UTF-8; rename the file")
        try:
            status = os.stat(self.job.path)
            header = {
                "image": self.job.image,
                "bytes": status.st_size,
                "modified": status.st_mtime_ns,
            }
            if old and all(old.get(name) == value for name, value in header.items()):
                header["sha256"] = old.get("sha256") or file_sha256(self.job.path)
            else:
                header["sha256"] = file_sha256(self.job.path)
        except OSError as error:
            raise BadImage(error.strerror) from None
        if old and old.get("sha256") == header["sha256"]:
            self.rows = {path: row for path, row in rows.items() if self.holds(row)}
        elif old:
            self.remove_files()
        return header

    def holds(self, row):
        """Return whether a finished file is there as it was written."""
        path = os.path.join(self.job.out, row["path"])
        try:
            return os.stat(path).st_size == row["bytes"]
        except OSError:
            return False

    def open_variants(self):
        """Return [(order, Variant)] of what is to be made."""
        variants = enumerate(self.plan.variants(self.job.image))
        return [pair for pair in variants if pair[1].path not in self.rows]

    def remove_files(self):
        """Remove what was made of another image of this name."""
        for variant in self.plan.variants(self.job.image):
            try:
                os.unlink(os.path.join(self.job.out, variant.path))
            except FileNotFoundError:
                pass

    def publish(self, write, variant, row):
        """Write a file, give it its name, and enter its row."""
        parts = os.path.join(self.job.out, journal.FOLDER, PARTS)
        os.makedirs(parts, exist_ok=True)
        ending = os.path.splitext(variant.path)[1]
        part = os.path.join(parts, f"{uuid.uuid4().hex}{ending}")
        final = os.path.join(self.job.out, variant.path)
        try:
            write(part)
            row["bytes"] = os.stat(part).st_size
            row["sha256"] = file_sha256(part)
            os.makedirs(os.path.dirname(final), exist_ok=True)
            os.replace(part, final)
        except BaseException:
            if os.path.exists(part):
                os.unlink(part)
            raise
        journal.append(self.journal, row)


def is_utf8(name):
    """Return whether a file's name is UTF-8; the core and Parquet take no other."""
    return name == name.encode(errors="replace").decode()


def file_sha256(path):
    """Return the SHA-256 of a file, in hexadecimal."""
    digest = hashlib.sha256()
    with open(path, "rb", buffering=0) as stream:
        while block := stream.read(BLOCK):
            digest.update(block)
    return digest.hexdigest()


def make_variants(target, header, todo):
    """Read the image once and make the files of @todo."""
    from cg2raw.dataset.image_file import read_image

    try:
        image = read_image(target.job.path)
        height, width = image.rgb.shape[:2]
        crops = [
            target.plan.crop_at(target.job.image, patch, width, height)
            for patch in range(target.plan.patches)
        ]
        seconds = target.plan.seconds(image.exposure_time)
    except (ValueError, MemoryError) as error:
        raise BadImage(str(error) or "needs more memory than there is") from None
    journal.start(target.journal, header, target.rows.values())
    header = {**header, "transfer": image.transfer, "exposure_time": seconds}
    patch, scene = -1, image.rgb
    for order, variant in todo:
        if variant.patch != patch:
            patch = variant.patch
            x, y, columns, rows = crops[patch]
            scene = np.ascontiguousarray(image.rgb[y : y + rows, x : x + columns])
        about = described(header, target.plan, variant, crops[patch])
        make_variant(target, variant, scene, {"order": order, **about})


def make_variant(target, variant, scene, about):
    """Make one file; its pixels are gone before the next one's are there."""
    write, row = simulated(target.plan, variant, scene, about["exposure_time"])
    target.publish(write, variant, {**about, **row})


def simulated(plan, variant, scene, seconds):
    """Return (write(path), what the manifest says of the simulation)."""
    camera = METHODS[plan.method](
        plan.cameras[variant.sensor], variant.scene, plan.seed
    )
    sensor, gain = camera.sensor, camera.digital_gain
    raw = sensor.simulate(
        scene,
        threads=1,
        illuminant=camera.illuminant,
        iso=variant.iso,
        noise=plan.noise if variant.iso is not None else None,
        seed=plan.seed,
        frame=variant.frame,
        digital_gain=gain,
        convention=plan.convention,
        exposure_time=seconds,
    )
    shape = raw.shape
    if plan.format == "dng":
        write = dng_writer(plan, raw, seconds)
    else:
        planes = packed.packed(
            raw, sensor.cfa, sensor.black_level, sensor.white_level, plan.element_type
        )
        shape = planes.shape[1:]
        write_planes = getattr(packed, f"write_{plan.format}")

        def write(path):
            write_planes(path, planes)

    drawn = {"illuminant": camera.illuminant, "method_seed": camera.seed}
    return write, drawn | truth(plan, sensor, raw.simulation.illuminant, gain, shape)


def dng_writer(plan, raw, seconds):
    """Return write(path) of a DNG, whose Exif says the exposure time if it is known."""
    shot = None if seconds is None else {"exposure_time": seconds}
    how = {"compression": plan.compression, "preview": False, "threads": 1}

    def write(path):
        write_dng(path, raw, shot=shot, **how)

    return write


def truth(plan, sensor, illuminant, gain, shape):
    """Return what is known of the light and of the file's numbers."""
    transform = _core.camera_from_scene(
        sensor._profile, illuminant, plan.convention, gain
    )
    return {
        "width": shape[1],
        "height": shape[0],
        "black_level": list(map(float, sensor.black_level)),
        "white_level": float(sensor.white_level),
        "cfa": sensor.cfa,
        "digital_gain": gain,
        "neutral": list(illuminant.neutral),
        "xy": list(illuminant.xy),
        "cct": illuminant.cct,
        "duv": illuminant.duv,
        "camera_from_xyz": sensor.camera_from_xyz(illuminant.xy).ravel().tolist(),
        "transform_first": transform.first.ravel().tolist(),
        "transform_second": transform.second.ravel().tolist(),
        "transform_gains": list(transform.gains),
    }


def described(header, plan, variant, crop):
    """Return what the manifest says of a file before it is made."""
    return {
        "path": variant.path,
        "clean_path": variant.clean_path,
        "input": variant.image,
        "input_sha256": header["sha256"],
        "transfer": header["transfer"],
        "sensor": variant.sensor,
        "profile_sha256": plan.profile_sha256[variant.sensor],
        "illuminant_index": variant.illuminant_index,
        "digital_gain_drawn": variant.asked_gain == "sample",
        "iso": variant.iso,
        "noise": plan.noise if variant.iso is not None else None,
        "exposure_time": header["exposure_time"],
        "seed": plan.seed,
        "frame": variant.frame,
        "patch": variant.patch,
        "crop": list(crop),
        "method": plan.method,
        "convention": plan.convention,
        "format": plan.format,
        "element_type": "uint16" if plan.format == "dng" else plan.element_type,
        "compression": plan.compression if plan.format == "dng" else None,
        "cg2raw": __version__,
    }
