# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Write docs/python.md, the page of the Python API, from the package's docstrings.

    python scripts/api_page.py [--check] [PAGE]

With --check nothing is written: exits with 1 if the page is not what it would be.
"""

import argparse
import ast
import dataclasses
import inspect
import sys
import textwrap
from pathlib import Path

import cg2raw
from cg2raw import diagnose, synthetic
from cg2raw.diagnose import diagnosis

ROOT = Path(__file__).resolve().parent.parent
STUB = ROOT / "python" / "cg2raw" / "_core.pyi"
INTRO = """\
# The Python API

`scripts/api_page.py` writes this page from the docstrings; edit those, not this.

Images are NumPy arrays, (height, width, 3) or (height, width, 4) with alpha ignored.
float32 is read where it lies if the channels of a pixel lie together, whatever the
strides of rows and columns; float16 is converted a few rows at a time; other floats are
copied to float32 first, and integers are refused. Mosaics are (height, width): float32
in 0..1 above black, or uint16 DN. What is wrong raises `ValueError` with one line that
says what is allowed. Long calls let other threads run. An argument of type `Light` is a
word such as `D65`, or an `Illuminant` of the same sensor; `FloatImage` and `RawImage`
are arrays of float32 and uint16.

```python
import cg2raw
import numpy as np

sensor = cg2raw.Sensor("canon-5d-mark-iv")
rgb = np.full((64, 96, 3), 0.18, np.float32)  # scene-linear Rec.709

# All at once ...
raw = sensor.simulate(rgb, illuminant="3200K", iso=1600, seed=1)
cg2raw.write_dng("shot.dng", raw)

# ... or stage by stage
camera = sensor.to_camera(rgb, illuminant="3200K")
clean = sensor.mosaic(camera)
noisy = sensor.add_noise(clean, iso=1600, seed=1)
assert (sensor.raw_from_signal(noisy) == raw).all()
cg2raw.write_dng("same.dng", sensor.raw_from_signal(noisy),
                 sensor=sensor, illuminant="3200K", iso=1600)

# and back
seen = sensor.demosaic(sensor.signal_from_raw(raw))
developed = sensor.to_scene(seen, illuminant="3200K")
assert abs(developed.mean() - 0.18) < 0.01

print(cg2raw.read_dng_metadata("shot.dng").as_shot_neutral)
```

`cg2raw.register_oiio_plugin()` lets the `OpenImageIO` of the same Python write DNGs,
too, by the plugin of the same installation; `cg2raw doctor` tells which one that is.
"""
DIAGNOSE = """\
# cg2raw.diagnose

What a profile lacks to explain measured frames: [diagnose.md](diagnose.md) has an
example. It is imported by itself, and needs `pip install "cg2raw[diagnose]"`.
"""
# What a Diagnosis is made of, beside its public name.
PARTS = ("Finding", "Estimate", "Alternative", "Gap", "ResidualTest", "DetectionLimit")


def stub_classes():
    """Return {class: {member: node}} of the stub; it has types that bindings lack."""
    tree = ast.parse(STUB.read_text())
    classes = [node for node in tree.body if isinstance(node, ast.ClassDef)]
    functions = {f.name: f for f in tree.body if isinstance(f, ast.FunctionDef)}
    members = {
        cls.name: {f.name: f for f in cls.body if isinstance(f, ast.FunctionDef)}
        for cls in classes
    }
    return {**members, "": functions}


STUBS = stub_classes()


def signature_of(name, value, owner=""):
    """Return "(argument: type = default, ...) -> type"."""
    node = STUBS.get(owner, {}).get(name)
    if node is not None and not inspect.isfunction(value):
        arguments = ast.unparse(node.args).removeprefix("self, ").removeprefix("self")
        return f"({arguments}) -> {ast.unparse(node.returns)}"
    if isinstance(value, classmethod):
        value = value.__func__
    # Annotations as their source has them, whatever NumPy calls those types.
    node = ast.parse(inspect.cleandoc("\n" + inspect.getsource(value))).body[0]
    arguments = ast.unparse(node.args)
    for first in ("self, ", "cls, ", "self", "cls"):
        if arguments.startswith(first):
            arguments = arguments.removeprefix(first)
            break
    result = f" -> {ast.unparse(node.returns)}" if node.returns else ""
    return f"({arguments}){result}"


def doc_of(value):
    """Return a docstring without the signature that pybind11 puts first."""
    text = inspect.cleandoc(value.__doc__ or "")
    first, _, rest = text.partition("\n")
    return rest.strip() if " -> " in first and "(" in first else text


def block(text):
    """Return text as it stands, or nothing."""
    return f"```text\n{text}\n```\n" if text else ""


def function_page(level, name, value, owner=""):
    """Return the lines on one function or method."""
    shown = f"{owner}.{name}" if owner else f"cg2raw.{name}"
    lines = f"{'#' * level} {shown}\n\n"
    signature = textwrap.fill(
        name + signature_of(name, value, owner), 88, subsequent_indent="    "
    )
    return lines + block(f"{signature}\n\n{doc_of(value)}")


def class_page(name, cls):
    """Return the lines on a class: itself, its properties, its methods."""
    public = {n: v for n, v in vars(cls).items() if not n.startswith("_")}
    page = f"## cg2raw.{name}\n\n{block(doc_of(cls))}"
    fields = {n: v for n, v in public.items() if isinstance(v, property)}
    if fields:
        page += "\n| property | type | |\n|---|---|---|\n"
    for field, value in fields.items():
        type = type_of(name, field, value).replace("|", "\\|")
        meaning = " ".join(value.__doc__.split())
        page += f"| `{field}` | `{type}` | {meaning} |\n"
    methods = [(n, v) for n, v in public.items() if callable(v) or is_class_method(v)]
    return page + "".join("\n" + function_page(3, n, v, name) for n, v in methods)


def type_of(name, field, value):
    """Return the type of a property, of the stub's or of Python's."""
    if name in STUBS:
        return ast.unparse(STUBS[name][field].returns)
    source = inspect.cleandoc("\n" + inspect.getsource(value.fget))
    return ast.unparse(ast.parse(source).body[0].returns)


def fields_page(name, cls):
    """Return the lines on a dataclass: what it is, and its fields as they stand."""
    node = ast.parse(inspect.getsource(cls)).body[0]
    lines = inspect.getsource(cls).splitlines()[node.body[0].end_lineno :]
    fields = textwrap.dedent("\n".join(lines)).strip()
    return f"## {name}\n\n" + block(f"{doc_of(cls)}\n\n{fields}")


def diagnose_page():
    """Return the parts of the page on cg2raw.diagnose."""
    parts = [DIAGNOSE]
    for name in sorted(diagnose.__all__, key=str.lower):
        value = getattr(diagnose, name)
        if inspect.isclass(value):
            parts.append(fields_page(f"cg2raw.diagnose.{name}", value))
        else:
            parts.append(function_page(2, name, value, "cg2raw.diagnose"))
    home = "cg2raw.diagnose.diagnosis"
    parts += [fields_page(f"{home}.{name}", getattr(diagnosis, name)) for name in PARTS]
    home = "cg2raw.synthetic"
    for name in ("draw_hidden", "simulate_captures"):
        value = getattr(synthetic, name)
        parts.append(function_page(2, name, value, home))
    return parts


def is_class_method(value):
    return isinstance(value, classmethod)


def value_page(name, value):
    """Return the lines on a constant."""
    shown = value if name != "__version__" else "The version of the package."
    return f"## cg2raw.{name}\n\n{block(shown)}"


def page():
    """Return the whole page."""
    parts = [INTRO]
    for name in sorted(cg2raw.__all__, key=str.lower):
        value = getattr(cg2raw, name)
        if dataclasses.is_dataclass(value):
            parts.append(fields_page(f"cg2raw.{name}", value))
        elif inspect.isclass(value):
            parts.append(class_page(name, value))
        elif callable(value):
            parts.append(function_page(2, name, value))
        else:
            parts.append(value_page(name, value))
    parts += diagnose_page()
    return "\n".join(part.rstrip("\n") + "\n" for part in parts)


def main():
    """Write or check the page; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--check", action="store_true", help="write nothing")
    parser.add_argument("page", nargs="?", default=ROOT / "docs/python.md", type=Path)
    arguments = parser.parse_args()
    if not arguments.check:
        arguments.page.write_text(page())
    elif not arguments.page.exists() or arguments.page.read_text() != page():
        print(f"{arguments.page} is not up to date: run scripts/api_page.py")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
