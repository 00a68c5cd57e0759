# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""_core.pyi says what the module holds, and mypy is content with the package."""

import ast
import importlib.util
import inspect
import re
import subprocess
import sys

import pytest

from cg2raw import _core

# How pybind11 writes what a stub says in fewer words, in this order.
WORDS = (
    (r"cg2raw\._core\.|numpy\.typing\.|typing\.(?!Supp|Ann)|collections\.abc\.", ""),
    (r"typing\.SupportsFloat \| typing\.SupportsIndex", "float"),
    (r"typing\.SupportsInt \| typing\.SupportsIndex", "int"),
    (r'typing\.Annotated\[((?:[^][]|\[[^][]*\])*), "FixedSize\(\d\)"\]', r"\1"),
    (r"typing\.Annotated\[ArrayLike, (numpy\.\w+)\]", r"NDArray[\1]"),
    (r"numpy\.ndarray", "NDArray[Any]"),
    (r"numpy\.", "np."),
)
# pybind11 knows no more of these; the stub does.
VAGUE = {"dict": "dict[", "list": "list[", "tuple": "tuple[", "object": ""}


def python_words(text):
    """Return a signature of pybind11's in the stub's words."""
    for pattern, words in WORDS:
        text = re.sub(pattern, words, text)
    return text


def function_of(docstring):
    """Return the ast of the signature in the first line of a docstring."""
    line = python_words(docstring.splitlines()[0])
    line = line if re.match(r"\w+\(", line) else "value" + line
    return ast.parse(f"def {line}: ...").body[0]


def arguments_of(function, skip_self=False):
    """Return (name, type, default) of each argument."""
    given = function.args.args[1:] if skip_self else function.args.args
    written = [ast.unparse(default) for default in function.args.defaults]
    defaults = [None] * (len(given) - len(written)) + written
    return [
        (arg.arg, ast.unparse(arg.annotation), default)
        for arg, default in zip(given, defaults, strict=True)
    ]


def same_result(stub, module):
    stub, module = ast.unparse(stub.returns), ast.unparse(module.returns)
    return stub == module or (module in VAGUE and stub.startswith(VAGUE[module]))


@pytest.fixture(scope="module")
def stub(repository):
    """Return {name: node} of the stub's top level."""
    text = (repository / "python/cg2raw/_core.pyi").read_text()
    return names_in(ast.parse(text).body)


def names_in(nodes):
    named = {}
    for node in nodes:
        if isinstance(node, ast.FunctionDef | ast.ClassDef):
            named[node.name] = node
        elif isinstance(node, ast.AnnAssign):
            named[node.target.id] = node
    return named


def public(names):
    return {n for n in names if not n.startswith("_") or n in ("__version__",)}


def members(cls):
    """Return {name: property or method} that the bindings declare in a class."""
    has_init = (cls.__init__.__doc__ or "").startswith("__init__(self")
    return {
        name: value
        for name, value in vars(cls).items()
        if not name.startswith("_") or (name == "__init__" and has_init)
    }


CLASSES = [name for name, value in vars(_core).items() if inspect.isclass(value)]
FUNCTIONS = [n for n in public(vars(_core)) if callable(getattr(_core, n))]
FUNCTIONS = sorted(set(FUNCTIONS) - set(CLASSES))


def test_stub_and_module_have_the_same_names(stub):
    assert set(stub) == public(vars(_core)) and len(CLASSES) > 5


@pytest.mark.parametrize("name", FUNCTIONS)
def test_functions_have_the_same_signature(stub, name):
    declared, module = stub[name], function_of(getattr(_core, name).__doc__)
    assert arguments_of(declared) == arguments_of(module)
    assert same_result(declared, module)


@pytest.mark.parametrize("name", sorted(set(CLASSES) - {"Error"}))
def test_classes_have_the_same_members(stub, name):
    declared, module = names_in(stub[name].body), members(getattr(_core, name))
    assert set(declared) == set(module)
    for member, value in module.items():
        is_property = isinstance(value, property)
        signature = function_of((value.fget if is_property else value).__doc__)
        decorators = [ast.unparse(d) for d in declared[member].decorator_list]
        assert decorators == (["property"] if is_property else []), member
        assert same_result(declared[member], signature), member
        if not is_property:
            args = arguments_of(declared[member], skip_self=True)
            assert args == arguments_of(signature, skip_self=True), member


def test_error_is_a_value_error(stub):
    assert [ast.unparse(base) for base in stub["Error"].bases] == ["ValueError"]
    assert issubclass(_core.Error, ValueError)


@pytest.mark.slow
def test_mypy_is_clean(repository):
    if importlib.util.find_spec("mypy") is None:
        pytest.skip("no mypy in this Python: run scripts/setup")
    command = [sys.executable, "-m", "mypy"]
    done = subprocess.run(command, cwd=repository, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
