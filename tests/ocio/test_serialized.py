# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The text of a config: fast to load, and still the same config."""

import PyOpenColorIO as ocio
import pytest

from cg2raw_ocio import config as generator


@pytest.fixture(scope="module")
def many():
    """Return a config of 200 spaces with an inactive twin each."""
    made = generator.base_config()
    for i in range(200):
        for prefix in ("space", "twin"):
            made.addColorSpace(ocio.ColorSpace(name=f"{prefix} {i}"))
    made.setInactiveColorSpaces(", ".join(f"twin {i}" for i in range(200)))
    return made


def test_it_is_the_same_config(many):
    config = ocio.Config.CreateFromStream(generator.config_text(many))
    assert config.serialize() == many.serialize()
    assert "twin 7" not in list(config.getColorSpaceNames())
    assert config.getColorSpace("twin 7") is not None


def test_the_list_of_inactive_spaces_comes_last(many):
    text = generator.config_text(many)
    assert text.count("inactive_colorspaces:") == 1
    assert text.splitlines()[-1].startswith("inactive_colorspaces: [twin 0, ")


def test_a_config_without_inactive_spaces():
    plain = generator.base_config()
    plain.setInactiveColorSpaces("")
    config = ocio.Config.CreateFromStream(generator.config_text(plain))
    assert config.serialize() == plain.serialize()
