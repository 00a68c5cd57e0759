# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A whole data set: begun or gone on with, handed to workers, listed."""

import contextlib
import fcntl
import hashlib
import os
import shutil
from dataclasses import dataclass

from cg2raw.atomic_file import write_atomically
from cg2raw.dataset import journal, manifest, options
from cg2raw.dataset.images import Images
from cg2raw.dataset.job import PARTS, Job


@dataclass
class Summary:
    """How many files were made and kept, of how many images; how many were no good."""

    images: int = 0
    bad: int = 0
    made: int = 0
    kept: int = 0


def make_dataset(paths, out, plan, workers=1, scheduler=None, watch=None):
    """Make, or go on with, the data set of a Plan; return its Summary.

    paths : one folder, or files. workers : processes of this machine; scheduler : the
    address of a Dask scheduler in their place. watch : (results, total) -> results, as
    to show progress. What is finished stays finished, however the process ends.
    Raises ValueError or OSError, each of one line."""
    out = os.path.realpath(out)
    images = Images(paths, out)
    os.makedirs(out, exist_ok=True)
    check_folder(out, plan)
    with locked(out):
        begin(out, plan, images)
        total = sum(1 for _ in images)
        if not total:
            raise ValueError(f"{paths[0]}: holds no EXR, PNG, TIFF or HDR image")
        found = worked(out, jobs_of(images, out, plan), workers, scheduler)
        summary = Summary()
        with contextlib.closing(found):
            for result in watch(found, total) if watch else found:
                count(summary, result)
        shutil.rmtree(parts_of(out), ignore_errors=True)
        manifest.write(out, images)
    return summary


def check_folder(out, plan):
    """Return whether a folder holds the data set of a plan already.

    Raises ValueError if it holds something else, or one of other options."""
    path = os.path.join(out, "dataset.json")
    if not os.path.exists(path):
        if any(name != journal.FOLDER for name in os.listdir(out)):
            raise ValueError(f"{out}: holds files of no data set; give an empty folder")
        return False
    with open(path, encoding="utf-8") as stream:
        differs = options.difference(stream.read(), plan)
    if differs:
        raise ValueError(
            f"{out}: {differs}; go on with what it was begun with, or give another OUT"
        )
    return True


@contextlib.contextmanager
def locked(out):
    """Keep others from writing the same data set. Raises ValueError if one does."""
    os.makedirs(os.path.join(out, journal.FOLDER), exist_ok=True)
    with open(os.path.join(out, journal.FOLDER, "lock"), "w") as stream:
        try:
            fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise ValueError(f"{out}: is being written by another cg2raw") from None
        yield


def begin(out, plan, images):
    """Prepare a folder: no manifest, no parts, the plan, no image that went away."""
    for path, header in journal.headers(out):
        if images.has(header["image"]):
            continue
        if "reason" not in header:
            raise ValueError(
                f"{out}: holds files of {header['image']}, which is no longer among "
                "the images: put it back, or give another OUT"
            )
        os.unlink(path)
    manifest.remove(out)
    shutil.rmtree(parts_of(out), ignore_errors=True)
    if not check_folder(out, plan):
        write_atomically(os.path.join(out, "dataset.json"), plan.to_json().encode())


def parts_of(out):
    """Return the folder of files that are being written."""
    return os.path.join(out, journal.FOLDER, PARTS)


def jobs_of(images, out, plan):
    """Yield the Job of each image."""
    plan_sha256 = hashlib.sha256(plan.to_json().encode()).hexdigest()
    for image, path in images:
        yield Job(out, plan_sha256, image, os.path.abspath(path))


def worked(out, jobs, workers, scheduler):
    """Return the results of jobs by local processes, or by a cluster."""
    if scheduler is not None:
        from cg2raw.dataset import cluster

        return cluster.results(jobs, scheduler)
    from cg2raw.dataset import local

    log = os.path.join(out, journal.FOLDER, "workers.log")
    return local.results(jobs, workers, log)


def count(summary, result):
    """Add a result to the summary."""
    summary.images += 1
    summary.made += result["made"]
    summary.kept += result["kept"]
    summary.bad += result["reason"] is not None
