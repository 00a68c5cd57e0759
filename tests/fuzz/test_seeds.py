# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Seeds with a name are synthetic: make_seeds.py writes each byte of them."""

import re
from pathlib import Path


import pytest

from fuzz import make_seeds

HERE = Path(__file__).parent
OTHERS = re.compile(r"found_\w+|[0-9a-f]{40}")


@pytest.mark.parametrize("kind", ["dng", "profile"])
def test_seeds_are_those_of_the_script(tmp_path, kind):
    make_seeds.main(tmp_path)
    made = {path.name: path.read_bytes() for path in (tmp_path / kind).iterdir()}
    kept = {
        path.name: path.read_bytes()
        for path in (HERE / kind).iterdir()
        if not OTHERS.fullmatch(path.name)
    }
    assert kept == made
