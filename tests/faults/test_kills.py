# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A data set killed again and again, at any moment of any resume: the same bytes.

The runs are forks of one process. tests/dataset/test_kill.py kills the command itself.
"""

import random
import time

import pytest

from faults.judge import contents
from faults.targets import TARGETS
from faults.walk import NONE, Walk


def killed(walk, server, kills):
    """Kill @kills runs, let some in between end; return how many files each left."""
    draw, whole = random.Random(7), walk.known[False].after
    begun = time.monotonic()
    assert server.run(NONE).code == 0  # one with nothing to do
    walk.begin(False)
    assert server.run(NONE).code == 0
    calm = time.monotonic() - begun
    walk.begin(False)
    counts, done = [], 0
    while done < kills:
        ended = server.run(NONE, draw.uniform(0, calm) if draw.random() < 0.8 else 60)
        found = contents(walk.folder / "out", (".cg2raw",))
        # What has a name is what it is to be; what is being written has a hidden one.
        seen = {name: data for name, data in found.items() if name[0] != "."}
        assert seen.items() <= whole.items()
        if ended.status is None:
            done += 1
            counts.append(len(seen))
        else:
            assert ended.code == 0, ended
            assert found == whole
            walk.begin(False)
    assert server.run(NONE).code == 0
    assert contents(walk.folder / "out", (".cg2raw",)) == whole
    return counts


def check(library, tmp_path, kills):
    """Return how many files were there after each of @kills."""
    walk = Walk(TARGETS["dataset"], library, tmp_path)
    with walk.start() as server:
        return killed(walk, server, kills)


def test_killed_a_few_times(library, tmp_path):
    assert len(set(check(library, tmp_path, 6))) > 1


@pytest.mark.slow
def test_killed_many_times(library, tmp_path, request):
    counts = check(library, tmp_path, request.config.getoption("--kills"))
    assert len(set(counts)) > 3  # at many different moments
