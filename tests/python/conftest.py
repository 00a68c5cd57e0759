# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Files that a test writes for a command or function to read."""

import json

import pytest


@pytest.fixture
def written(tmp_path):
    """Return write(document or text, name): the path of a file."""

    def write(content, name="camera.json"):
        text = content if isinstance(content, str) else json.dumps(content)
        (tmp_path / name).write_text(text)
        return tmp_path / name

    return write
