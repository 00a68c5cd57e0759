# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Pages with figures: one file of HTML, without scripts."""

import base64
from collections.abc import Iterable
from typing import Any

MISSING = "the page needs Jinja2 and Pillow: pip install 'cg2raw[diagnose]'"


def filled(
    package: str,
    template: str,
    figures: Iterable[tuple[str, str, bytes]],
    **fields: Any,
) -> str:
    """Return the page of a template, of a package's templates folder.

    figures : (title, description, PNG) each, drawn only if the libraries are there.
    fields : of the template. Raises ValueError if Jinja2 or Pillow is missing."""
    try:
        import PIL  # noqa: F401
        from jinja2 import Environment, PackageLoader, StrictUndefined
    except ImportError:
        raise ValueError(MISSING) from None
    environment = Environment(
        loader=PackageLoader(package),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
    )
    shown = [
        {
            "title": title,
            "words": words,
            "uri": "data:image/png;base64," + base64.b64encode(png).decode("ascii"),
        }
        for title, words, png in figures
    ]
    return environment.get_template(template).render(figures=shown, **fields)
