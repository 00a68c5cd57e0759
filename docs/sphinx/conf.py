# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The configuration of Sphinx, which scripts/docs runs.

Its source folder is the repository's root, so that README.md and the pages of docs link
each other as they do in the repository.
"""

import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent.parent
sys.path.insert(0, str(HERE))

import docstrings  # noqa: E402

import cg2raw  # noqa: E402

project = "cg2raw"
copyright = "Contributors to the cg2raw Project"
version = release = cg2raw.__version__

extensions = ["myst_parser", "sphinx.ext.autodoc"]
PAGES = ("README.md", "CONTRIBUTING.md", "CHANGES.md", "SECURITY.md")
root_doc = "docs/index"
include_patterns = [*PAGES, "docs/**"]
# Folders that are not left out are searched.
exclude_patterns = [
    path.name for path in ROOT.iterdir() if path.name not in (*PAGES, "docs")
]

# Links to a heading by its words, as GitHub has them.
myst_heading_anchors = 3
suppress_warnings = ["myst.header"]  # pages may skip a level

default_role = "literal"
smartquotes = False
add_module_names = False
autodoc_member_order = "bysource"
python_maximum_signature_line_length = 88

html_theme = "furo"
html_title = f"cg2raw {release}"
html_copy_source = False
html_show_sourcelink = False


def setup(app):
    """Have docstrings and signatures made what Sphinx reads."""
    app.connect("autodoc-process-docstring", docstrings.to_rest)
    app.connect("autodoc-process-signature", docstrings.signature)
