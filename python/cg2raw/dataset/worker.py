# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A worker process of this machine: jobs come in by stdin, results leave by stdout."""

import json
import os
import sys

from cg2raw.short_messages import about
from cg2raw.system import end_with_parent


def main() -> None:
    """Make jobs until there are no more."""
    end_with_parent(int(sys.argv[1]))
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)  # what a library prints must not mix with answers
    from cg2raw.dataset.job import make
    from cg2raw.dataset.target import Job

    def say(row: dict[str, object]) -> None:
        answers.write(json.dumps(row) + "\n")
        answers.flush()

    use_one_thread()
    for line in sys.stdin:
        job = Job(**json.loads(line))
        try:
            answer = make(job, say)
        except (OSError, ValueError) as error:
            answer = {"failure": about(job.out, error)}
        say(answer)


def use_one_thread() -> None:
    """Keep OpenImageIO from taking every core in every worker."""
    from cg2raw.oiio.openimageio import openimageio

    oiio = openimageio()
    oiio.attribute("threads", 1)
    oiio.attribute("exr_threads", -1)  # -1: none of its own
