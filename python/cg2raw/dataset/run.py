# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Make a whole data set, or resume it: hand jobs to workers, write the manifest."""

import contextlib
import hashlib
import os
import re
import shutil
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

from cg2raw.dataset import journal, manifest, options
from cg2raw.dataset.images import Images, check_apart
from cg2raw.dataset.journal import Row
from cg2raw.dataset.kept_profiles import PLAN
from cg2raw.dataset.plan import Plan
from cg2raw.dataset.target import PARTS, Job
from cg2raw.interrupts import tidied
from cg2raw.io.atomic_file import write_in
from cg2raw.near_words import one_line
from cg2raw.system import Folder, lock, sync_file_system

STOPPED = "stopped; run the same command again to resume"
NO_LOCKS = "its file system has no locks: see that no other cg2raw writes there"
# What write_in leaves where it was killed and the file system has no unnamed files.
LEFTOVER = re.compile(rf"\.{re.escape(PLAN)}\.cg2raw-[0-9a-f]{{16}}")


@dataclass
class Summary:
    """How many files were made and kept, of how many images; how many were no good."""

    images: int = 0
    bad: int = 0
    made: int = 0
    kept: int = 0


def make_dataset(
    paths: Sequence[str],
    out: str,
    plan: Plan,
    workers: int = 1,
    scheduler: str | None = None,
    watch: Callable[[Iterator[Row], int, int], Iterable[Row]] | None = None,
    verify: str = "hash",
    tell: Callable[[str], None] | None = None,
) -> Summary:
    """Make, or go on with, the data set of a Plan; return its Summary.

    paths : one folder, or files. workers : processes of this machine; scheduler : the
    address of a Dask scheduler in their place. watch : (results, images, files of each)
    -> results, as to show progress: {"image", "files"} while an image is being worked
    on, then what `job.make` returns of it. What is finished stays finished, however the
    process ends.
    verify : what of a finished file must be as it was written for it to be kept: its
    "hash", or its "size" alone. tell : is given what the user is to see to.
    Raises ValueError or OSError, each of one line."""
    out = os.path.realpath(out)
    images = Images(paths, out)
    total = sum(1 for _ in images)
    check_count(total, paths)
    os.makedirs(out, exist_ok=True)
    check_folder(out, plan)
    with locked(out, tell):
        if folds_case(out):
            check_apart((name for name, _ in images), folds_case=True)
        begin(out, plan, images)
        jobs = jobs_of(images, out, plan, verify)
        found = worked(out, jobs, workers, scheduler)
        summary = Summary()
        parts = partial(shutil.rmtree, parts_of(out), True)
        with tidied(parts, STOPPED), contextlib.closing(found):
            each = plan.files_of_an_image
            for result in watch(found, total, each) if watch else found:
                if "reason" in result:
                    count(summary, result)
        shutil.rmtree(parts_of(out), ignore_errors=True)
        sync_file_system(out)  # before a manifest says that all files are there
        manifest.write(out, images, summary.made + summary.kept)
    return summary


def check_count(count: int, paths: Sequence[str]) -> None:
    """Raise ValueError if there are no images."""
    if not count:
        raise ValueError(f"{paths[0]}: holds no EXR, PNG, TIFF or HDR image")


def check_folder(out: str, plan: Plan) -> bool:
    """Return whether a folder holds the data set of a plan already.

    Raises ValueError if it holds something else, or one of other options."""
    with Folder(out) as folder:
        names = folder.names()
        if PLAN not in names:
            if all(map(is_ours, names)):
                return False
            raise ValueError(f"{out}: holds files of no data set; give an empty folder")
        with open(folder.open(PLAN, os.O_RDONLY), encoding="utf-8") as stream:
            differs = options.difference(stream.read(), plan)
    if differs:
        raise ValueError(
            f"{out}: {differs}; go on with what it was begun with, or give another OUT"
        )
    return True


def is_ours(name: str) -> bool:
    """Return whether a name in a new data set's folder is one that we left there."""
    return name == journal.FOLDER or LEFTOVER.fullmatch(name) is not None


@contextlib.contextmanager
def locked(out: str, tell: Callable[[str], None] | None) -> Iterator[None]:
    """Keep others from writing the same data set. Raises ValueError if one does.

    Where the file system has no locks, nobody is kept: @tell is told."""
    with (
        Folder(out, journal.FOLDER, make=True) as folder,
        open(folder.open("lock", os.O_RDWR | os.O_CREAT)) as stream,
    ):
        try:
            if not lock(stream.fileno()) and tell:
                tell(f"{out}: {NO_LOCKS}")
        except BlockingIOError:
            raise ValueError(f"{out}: is being written by another cg2raw") from None
        yield


def folds_case(out: str) -> bool:
    """Return whether a data set's file system takes names that differ by case for one,
    as those of Windows and macOS do."""
    known = os.path.join(out, journal.FOLDER)
    other = os.path.join(out, journal.FOLDER.upper())
    return os.path.exists(other) and os.path.samefile(known, other)


def begin(out: str, plan: Plan, images: Images) -> None:
    """Prepare a folder: no manifest, no parts, the plan, no image that went away."""
    for path, header in journal.headers(out):
        if images.has(header["image"]):
            continue
        if "reason" not in header:
            raise ValueError(
                f"{out}: holds files of {one_line(header['image'])}, which is no "
                "longer among the images: put it back, or give another OUT"
            )
        os.unlink(path)
    manifest.remove(out)
    shutil.rmtree(parts_of(out), ignore_errors=True)
    for name in filter(LEFTOVER.fullmatch, os.listdir(out)):
        os.unlink(os.path.join(out, name))
    path, text = os.path.join(out, PLAN), plan.to_json().encode()
    if not check_folder(out, plan) or not has_bytes(path, text):
        with Folder(out) as folder:
            write_in(folder, PLAN, text, path)


def has_bytes(path: str, data: bytes) -> bool:
    """Return whether a file is as given; an older dataset.json has fewer fields."""
    with open(path, "rb") as stream:
        return stream.read() == data


def parts_of(out: str) -> str:
    """Return the folder of files that are being written."""
    return os.path.join(out, journal.FOLDER, PARTS)


def jobs_of(images: Images, out: str, plan: Plan, verify: str) -> Iterator[Job]:
    """Yield the Job of each image."""
    plan_sha256 = hashlib.sha256(plan.to_json().encode()).hexdigest()
    for index, (image, path) in enumerate(images):
        yield Job(out, plan_sha256, image, os.path.abspath(path), index, verify)


def worked(
    out: str, jobs: Iterator[Job], workers: int, scheduler: str | None
) -> Generator[Row]:
    """Return the results of jobs by local processes, or by a cluster."""
    if scheduler is not None:
        from cg2raw.dataset import cluster

        return cluster.results(jobs, scheduler)
    from cg2raw.dataset import local

    log = os.path.join(out, journal.FOLDER, "workers.log")
    return local.results(jobs, workers, log)


def count(summary: Summary, result: Row) -> None:
    """Add a result to the summary."""
    summary.images += 1
    summary.made += result["made"]
    summary.kept += result["kept"]
    summary.bad += result["reason"] is not None
