# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Job: all files for one image, read once, made in order; finished ones are kept."""

import hashlib
import json
import os
from collections.abc import Callable
from functools import lru_cache
from typing import Any

from cg2raw import RawFrame, Run, __version__, _core, write_dng
from cg2raw.arrays import FloatImage
from cg2raw.cfa import repeat_of
from cg2raw.conversion import DIALECT
from cg2raw.dataset import journal, packed
from cg2raw.dataset.journal import Row
from cg2raw.dataset.keys import hashed
from cg2raw.dataset.methods import METHODS, Camera
from cg2raw.dataset.plan import Plan, Variant
from cg2raw.dataset.source import Box, Source, read_source
from cg2raw.dataset.target import (
    BadImage,
    Job,
    Target,
    Write,
    expected,
    reason_of,
)
from cg2raw.dataset.truth import noise_of, truth
from cg2raw.exposure import core_run

TOO_LARGE = "needs more memory than there is"


def make(job: Job, say: Callable[[Row], None] = lambda row: None) -> Row:
    """Make all files of one image that are not there yet.

    say : called with {"image", "files"}, how many are finished, for each.
    Returns {"image", "made", "kept", "reason"}: reason says in one line why the image
    cannot be used, None if it can. Raises OSError or ValueError if the data set cannot
    be written: no other image could be either."""
    try:
        made, kept = make_open_variants(job, say)
    except BadImage as bad:
        return give_up(job, str(bad))
    except MemoryError:
        return give_up(job, TOO_LARGE)
    return {"image": job.image, "made": made, "kept": kept, "reason": None}


def make_open_variants(job: Job, say: Callable[[Row], None]) -> tuple[int, int]:
    """Make what is not there yet; return how many files that were, and were there."""
    target = Target(job, plan_at(job.out, job.plan_sha256))
    header = target.header()
    todo = target.open_variants()
    if todo:
        make_variants(target, header, todo, say)
    elif target.journal_differs:
        target.start_journal(header)
    return len(todo), len(target.rows)


def give_up(job: Job, reason: str) -> Row:
    """Remember why an image cannot be used; nothing of it stays. Returns the result."""
    target = Target(job, plan_at(job.out, job.plan_sha256))
    target.remove_files()
    journal.start(target.journal, {"image": job.image, "reason": reason})
    return {"image": job.image, "made": 0, "kept": 0, "reason": reason}


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
        seconds = plan.seconds(source.image.shot.exposure_time)
        check_repeats(plan, crops)
    except (ValueError, OSError) as error:
        raise BadImage(reason_of(error, path)) from None
    target.start_journal(header)
    of_image = source.row()
    for count, (order, variant) in enumerate(todo, len(target.rows)):
        say({"image": target.job.image, "files": count})
        box = crops[variant.patch]
        about = expected(header, order, variant) | {"crop": list(box)}
        make_variant(target, variant, source, about, of_image, seconds)


def check_repeats(plan: Plan, crops: list[Box]) -> None:
    """Raise ValueError for crops that are smaller than one repeat of a sensor's CFA."""
    columns, rows = min((box[2:] for box in crops), key=min)
    for id, camera in plan.cameras.items():
        if min(columns, rows) < (least := repeat_of(camera.cfa)):
            raise ValueError(
                f"{columns}x{rows} pixels: the CFA of {id} repeats after {least}, and "
                f"each side must have as many; leave {id} out of --sensors"
            )


def make_variant(
    target: Target,
    variant: Variant,
    source: Source,
    about: Row,
    of_image: Row,
    seconds: float | None,
) -> None:
    """Make one file; its pixels are gone before the next one's are there.

    about, of_image : what the manifest says of the file, and of its image. seconds :
    the exposure time, None if it is not known."""
    plan = target.plan
    camera = METHODS[plan.method](
        plan.cameras[variant.sensor], variant.scene, plan.seed
    )
    x, y, columns, rows = about["crop"]
    run = plan.run(camera, variant.iso, seconds) | exposure_of(variant, source, camera)
    try:
        scene, of_pixels = source.seen(
            (x, y, columns, rows), camera.sensor, camera.illuminant
        )
        run |= of_pixels
        of_core = core_run(camera.sensor.id, Run(**run))
        _core.exposure_stops(camera.sensor.profile, of_core, DIALECT)  # raises
        write, row = simulated(plan, variant, camera, scene, run)
    except ValueError as error:
        raise BadImage(str(error)) from None
    target.publish(write, variant, {**about, **row, **of_image})


def exposure_of(variant: Variant, source: Source, camera: Camera) -> Row:
    """Return fields of a Run: the exposure of an image, the same for all its files."""
    plan, rule = variant.plan, variant.plan.exposure
    f_number = plan.f_number or source.image.shot.f_number
    fields: Row = {"f_number": f_number, "bracket": variant.bracket}
    if rule is None:
        return fields
    sensor = plan.cameras[variant.sensor]
    frame = hashed("exposure", variant.image)
    run = core_run(sensor.id, Run(exposure=rule, seed=plan.seed, frame=frame))
    if run.needs_meter:
        fields["meter"] = source.meter(rule, camera.sensor, camera.illuminant)
    else:
        fields["exposure"] = _core.exposure_stops(sensor.profile, run, DIALECT)
    return fields


def simulated(
    plan: Plan,
    variant: Variant,
    camera: Camera,
    scene: FloatImage,
    run: dict[str, Any],
) -> tuple[Write, Row]:
    """Return (write(path), what the manifest says of the simulation).

    scene : pixels. run : fields of a Run."""
    sensor, gain = camera.sensor, camera.digital_gain
    raw = sensor.simulate(scene, threads=1, frame=variant.frame, **run)
    shape = raw.shape
    if plan.format == "dng":
        write = dng_writer(plan, raw)
    else:
        planes = packed.packed(
            raw, sensor.cfa, sensor.black_level, sensor.white_level, plan.element_type
        )
        shape = planes.shape[1:]
        write_planes = getattr(packed, f"write_{plan.format}")

        def write(path: str) -> None:
            write_planes(path, planes)

    drawn: Row = {"illuminant": camera.illuminant, "method_seed": camera.seed}
    simulation = raw.simulation
    assert simulation is not None  # of what Sensor.simulate returns
    drawn["spectrum"] = simulation.spectrum or None
    exposure = simulation.exposure
    drawn |= {
        "exposure": exposure["stops"],
        "exposure_time": exposure["exposure_time"],
        "f_number": exposure["f_number"],
        "exposure_rule": plan.exposure,
        "scene_luminance": plan.scene_luminance,
        "bracket": variant.bracket,
    }
    light, convention = simulation.illuminant, run["convention"]
    row = truth(sensor, light, convention, gain, shape)
    return write, drawn | row | noise_of(sensor, variant.iso, plan.noise)


def dng_writer(plan: Plan, raw: RawFrame) -> Write:
    """Return write(path) of a DNG."""
    # A file that a loss of power leaves partial is known by its hash, and made again.
    how: dict[str, Any] = {"compression": plan.compression, "preview": False}
    how |= {"threads": 1, "sync": False}

    def write(path: str) -> None:
        write_dng(path, raw, **how)

    return write
