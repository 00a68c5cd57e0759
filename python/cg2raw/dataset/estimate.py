# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""How large a data set will be: counted by the headers of its images, and measured on a
few crops of one of them, which are made in a temporary folder."""

import hashlib
import json
import os
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from cg2raw.core_arguments import check_utf8
from cg2raw.dataset import journal
from cg2raw.dataset.images import Images
from cg2raw.dataset.job import make
from cg2raw.dataset.journal import Row
from cg2raw.dataset.kept_profiles import PLAN
from cg2raw.dataset.manifest import ENDINGS
from cg2raw.dataset.plan import Plan
from cg2raw.dataset.run import check_count, check_folder
from cg2raw.dataset.target import Job
from cg2raw.interrupts import scratch_folder
from cg2raw.io.image_file import image_size
from cg2raw.io.spectra_file import spectra_in

SIDE, CROPS = 256, 4  # pixels, and how many, of what is made to measure it
TRIES = 3  # images that are tried for that
# A row is in a journal and in manifest.jsonl; Parquet packs it to less than a fifth.
ROW_COPIES = 2.2


@dataclass
class Estimate:
    """What a data set will be; an image without a readable header does not count.

    files : with dataset.json and the manifests. bytes : of all of them and of the
    journals; None if no image could be used to measure it. measured : that image.
    bad : {image: reason} of those that cannot be used, as far as that is known."""

    images: int = 0
    rows: int = 0
    files: int = 0
    bytes: float | None = None
    measured: str = ""
    bad: dict[str, str] = field(default_factory=dict)


def estimate(paths: Sequence[str], out: str, plan: Plan) -> Estimate:
    """Return the Estimate of the data set of a Plan; write nothing into @out.

    paths, out : as of make_dataset. Raises ValueError or OSError, each of one line."""
    images = Images(paths, out)
    if os.path.exists(out):
        check_folder(out, plan)
    found, pixels, sample = Estimate(), 0, None
    for name, path in images:
        try:
            check_utf8(name)
            width, height = size_of(path, plan)
            if sample is None and len(found.bad) < TRIES:
                sample = sample_of(name, path, (width, height), plan)
                found.measured = name
        except (ValueError, OSError) as error:
            text = str(error).removeprefix(f"{path}: ")
            found.bad[name] = text.removeprefix(f"{name}: ")
        else:
            found.images += 1
            pixels += width * height
    check_count(found.images + len(found.bad), paths)
    found.rows = found.images * plan.files_of_an_image
    found.files = found.rows + 1 + len(ENDINGS)
    if sample is not None:
        per_pixel, of_row = sample
        found.bytes = pixels * plan.files_of_an_image * per_pixel
        found.bytes += found.rows * of_row + len(plan.to_json())
    return found


def size_of(path: str, plan: Plan) -> tuple[int, int]:
    """Return (width, height) of what an image gives. Raises ValueError, OSError."""
    file = spectra_in(path) if plan.layer is None else None
    if file is not None:
        height, width = file.spec.full_height, file.spec.full_width
    else:
        height, width = image_size(path, plan.layer)
    return plan.crop_at("", 0, width, height)[2:]


def sample_of(
    name: str, path: str, size: tuple[int, int], plan: Plan
) -> tuple[float, float]:
    """Return (bytes of a file per pixel of its image, bytes of its row everywhere).

    Raises ValueError or OSError for an image that cannot be used."""
    crop = (min(SIDE, size[0]), min(SIDE, size[1]))
    lights = plan.illuminants
    few = replace(
        plan,
        crop=crop,
        patches=CROPS,
        illuminants=1 if isinstance(lights, int) else lights[:1],
        digital_gains=plan.digital_gains[:1],
    )
    rows = made(name, path, few)
    per_file = sum(row["bytes"] for row in rows) / len(rows)
    text = sum(len(json.dumps(row)) for row in rows) / len(rows)
    return per_file / (crop[0] * crop[1]), text * ROW_COPIES


def made(name: str, path: str, plan: Plan) -> list[Row]:
    """Return the rows of one image's files, which are made and removed again.

    Raises ValueError or OSError for an image that cannot be used."""
    text = plan.to_json().encode()
    with scratch_folder("cg2raw.") as folder:
        with open(os.path.join(folder, PLAN), "wb") as stream:
            stream.write(text)
        sha256 = hashlib.sha256(text).hexdigest()
        result = make(Job(folder, sha256, name, os.path.abspath(path), 0))
        if result["reason"] is not None:
            raise ValueError(result["reason"])
        _, rows = journal.read(journal.path_of(folder, name))
    return list(rows.values())
