# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The fenced blocks of the README, as tests run them."""

import re
from pathlib import Path

README = Path(__file__).resolve().parent.parent / "README.md"
BLOCK = re.compile(r"^```(.*)\n((?:.*\n)*?)^```$", re.MULTILINE)


def sections():
    """Return {heading: [(language, code) of its blocks, in order]}."""
    parts = re.split(r"^## (.+)\n", README.read_text(), flags=re.MULTILINE)
    assert not BLOCK.search(parts[0])
    return {
        heading: BLOCK.findall(text)
        for heading, text in zip(parts[1::2], parts[2::2], strict=True)
    }


def install():
    """Return the blocks of "Install": from this tree, and by a wheel."""
    (_, tree), (_, wheel) = sections()["Install"]
    return tree, wheel
