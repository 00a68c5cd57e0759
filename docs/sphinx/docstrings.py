# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Our docstrings and stubs, as Sphinx's autodoc takes them.

A docstring is plain text; an entry in it is one or more names, " : " and what they are:

    rgb, other : (H, W, 3) float; alpha is ignored.
        float32 is read in place.
"""

import ast
import dataclasses
import inspect
import re
import textwrap
from pathlib import Path

import cg2raw

STUB = Path(cg2raw.__file__).with_name("_core.pyi")
ENTRY = re.compile(r"(\w+(?:, \w+)*) : (.*)")
LITERAL = re.compile(r"(``?[^`]+``?)")


def stub_nodes():
    """Return {dotted name within cg2raw: node}, of what the stub of _core declares."""
    nodes = {}
    for node in ast.parse(STUB.read_text()).body:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            nodes[node.name] = node
        if isinstance(node, ast.ClassDef):
            members = (m for m in node.body if isinstance(m, ast.FunctionDef))
            nodes |= {f"{node.name}.{member.name}": member for member in members}
    return nodes


STUBS = stub_nodes()


def stub_of(name, obj):
    """Return the node that types something compiled; None if Python has its source."""
    obj = inspect.unwrap(obj)  # what the core has is wrapped: its errors are plain
    if inspect.isfunction(obj) or inspect.ismethod(obj):
        return None
    return STUBS.get(name.partition(".")[2])


def source_node(obj):
    """Return the node of a function or class that Python has the source of."""
    return ast.parse(inspect.cleandoc("\n" + inspect.getsource(obj))).body[0]


def signature(app, what, name, obj, options, given, returned):
    """Return (arguments, result) with types as their source spells them."""
    if what == "class":
        if dataclasses.is_dataclass(obj):
            return "", None  # its fields follow
        init = inspect.unwrap(vars(obj).get("__init__"))
        if inspect.isfunction(init):
            return arguments_of(source_node(init)), None
        return None if name.partition(".")[2] in STUBS else ("", None)
    if what not in ("function", "method"):
        return given, returned
    node = stub_of(name, obj) or source_node(obj)
    result = ast.unparse(node.returns).strip("'") if node.returns else None
    return arguments_of(node), result


def arguments_of(node):
    """Return "(argument: type = default, ...)" of a function without self."""
    arguments = node.args
    if arguments.args and arguments.args[0].arg in ("self", "cls"):
        del arguments.args[0]
    return f"({ast.unparse(arguments)})"


def to_rest(app, what, name, obj, options, lines):
    """Make a docstring reStructuredText, in place."""
    text = [line for line in lines if not is_signature(line, name)]
    paragraphs = "\n".join(text).strip("\n").split("\n\n")
    blocks = [rest for paragraph in paragraphs for rest in rest_of(paragraph)]
    node = STUBS.get(name.partition(".")[2])
    if what == "property" and node is not None:
        blocks.insert(0, f"``{ast.unparse(node.returns)}``")
    if what == "class" and dataclasses.is_dataclass(obj):
        blocks.append(code(fields_of(obj)))
    lines[:] = "\n\n".join(blocks).split("\n") + [""]


def is_signature(line, name):
    """Whether pybind11 has put this line before a docstring."""
    return line.startswith(name.rpartition(".")[2] + "(") and " -> " in line


def rest_of(paragraph):
    """Return the blocks of one paragraph: text, entries, or a block as it stands."""
    lines = paragraph.split("\n")
    as_it_stands = all(line.startswith("    ") for line in lines)
    if as_it_stands or all(re.search(r"\w  +\w", line) for line in lines):
        return [code(textwrap.dedent(paragraph))]
    blocks = []
    for line in lines:
        entry = ENTRY.fullmatch(line)
        if entry:
            names = ", ".join(f"``{n}``" for n in entry[1].split(", "))
            blocks.append(f"{names}\n    {escaped(entry[2])}")
        elif blocks and "\n" in blocks[-1]:
            blocks[-1] += f"\n    {escaped(line.strip())}"
        elif blocks:
            blocks[-1] += f" {escaped(line.strip())}"
        else:
            blocks.append(escaped(line.strip()))
    return blocks


def escaped(text):
    """Return text of which reStructuredText takes nothing for markup but literals."""
    parts = LITERAL.split(text)
    parts[::2] = [re.sub(r"([\\*|]|_\b)", r"\\\1", part) for part in parts[::2]]
    return "".join(parts)


def code(text):
    """Return a block of code."""
    return ".. code-block:: text\n\n" + textwrap.indent(text, "    ")


def fields_of(cls):
    """Return the fields of a dataclass as they stand in its source, with comments."""
    source = inspect.cleandoc("\n" + inspect.getsource(cls)).splitlines()
    fields = [n for n in source_node(cls).body if isinstance(n, ast.AnnAssign)]
    lines = [line for n in fields for line in source[n.lineno - 1 : n.end_lineno]]
    return textwrap.dedent("\n".join(lines))
