# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""docs/sphinx/docstrings.py: docstrings and stubs as Sphinx takes them."""

import importlib.util
from pathlib import Path

import pytest

import cg2raw
from cg2raw.diagnose import diagnosis

FILE = Path(__file__).resolve().parents[2] / "docs/sphinx/docstrings.py"


@pytest.fixture(scope="module")
def docstrings():
    spec = importlib.util.spec_from_file_location("docstrings", FILE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def rest(docstrings, text, what="function", name="cg2raw.any", obj=None):
    lines = text.split("\n")
    docstrings.to_rest(None, what, name, obj, {}, lines)
    assert lines[-1] == ""
    return "\n".join(lines[:-1])


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("One line\nand another.", "One line and another."),
        ("Text.\n\nMore.", "Text.\n\nMore."),
        ("a : first\n    goes on.", "``a``\n    first\n    goes on."),
        (
            "a : first\ngoes on.\nb, c : 2",
            "``a``\n    first\n    goes on.\n\n``b``, ``c``\n    2",
        ),
        ("x*y |z| name_ a_b `c*d`", r"x\*y \|z\| name\_ a_b `c*d`"),
        ("    x = 1\n    y = 2", ".. code-block:: text\n\n    x = 1\n    y = 2"),
        ("a   one\nbc  two", ".. code-block:: text\n\n    a   one\n    bc  two"),
        ("any(x: int) -> int\n\nText.", "Text."),
    ],
)
def test_text_becomes_rest(docstrings, text, expected):
    assert rest(docstrings, text) == expected


def test_what_is_compiled_has_the_types_of_the_stub(docstrings):
    text = rest(docstrings, "Text.", "property", "cg2raw.SensorProfile.bits")
    assert text == "``int``\n\nText."
    of_function = docstrings.signature(
        None, "function", "cg2raw.illuminant_list", cg2raw.illuminant_list, {}, "", ""
    )
    assert of_function == ("(words: str)", "list[str]")


def test_what_is_python_has_the_types_of_its_source(docstrings):
    method = cg2raw.Sensor.from_json
    shown = docstrings.signature(None, "method", "cg2raw.Sensor.x", method, {}, "", "")
    assert shown == ("(text: str, name: str='profile')", "Sensor")
    of_class = docstrings.signature(
        None, "class", "cg2raw.Sensor", cg2raw.Sensor, {}, "", ""
    )
    assert of_class == ("(id_or_path: str | os.PathLike[str])", None)


def test_a_dataclass_shows_its_fields_with_their_comments(docstrings):
    text = rest(docstrings, "Text.", "class", "x", diagnosis.DetectionLimit)
    assert text.startswith("Text.\n\n.. code-block:: text\n\n    name: str\n")
    assert "    strength: float | None  # None: these captures cannot show it\n" in text
