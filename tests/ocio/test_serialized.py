# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The text of a config: fast to load, and still the same config."""

import time

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


def load(text):
    """Return (config, seconds of the processor) of a config's text."""
    start = time.process_time()
    config = ocio.Config.CreateFromStream(text)
    return config, time.process_time() - start


def test_it_is_the_same_config(many):
    config, _ = load(generator.config_text(many))
    assert config.serialize() == many.serialize()
    assert "twin 7" not in list(config.getColorSpaceNames())
    assert config.getColorSpace("twin 7") is not None


def test_the_list_of_inactive_spaces_comes_last(many):
    text = generator.config_text(many)
    assert text.count("inactive_colorspaces:") == 1
    assert text.splitlines()[-1].startswith("inactive_colorspaces: [twin 0, ")


def test_it_loads_fast(many):
    slow = min(load(many.serialize())[1] for _ in range(2))
    fast = min(load(generator.config_text(many))[1] for _ in range(2))
    assert fast < 0.5 * slow


def test_a_config_without_inactive_spaces():
    plain = generator.base_config()
    plain.setInactiveColorSpaces("")
    assert load(generator.config_text(plain))[0].serialize() == plain.serialize()
