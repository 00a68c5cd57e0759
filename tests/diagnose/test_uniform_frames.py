# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Which darks and flats decide, whose noise it is, and what is said of the others."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from cg2raw.diagnose.uniform_frames import lines_apart, uniform_frames
from diagnose.planted import bare, capture_of, sensor_of, shown_set, standard_set

SENSOR = sensor_of()
BLACK = SENSOR.black_level[0]
LEAST = 8.0  # nats


def uniform(changed, sensor=SENSOR):
    """Return what decides of two darks, flats and scenes a group. changed : what
    (capture, scene of its group, rng) -> DN are, or None for one that is left out."""
    made = shown_set(SENSOR, standard_set((64, 96)), 1)
    scenes = {c.group: c.raw() for c in made.captures if c.kind == "scene"}
    captures = []
    for number, capture in enumerate(made.captures):
        dn = changed(capture, scenes[capture.group], np.random.default_rng(number))
        if dn is not None:
            raw = np.rint(dn).astype(np.uint16)
            captures.append(replace(capture, raw=lambda raw=raw: raw))
    given = replace(made, sensor=sensor, captures=captures)
    return uniform_frames(given, LEAST, lambda share: None)


def test_noise_that_no_profile_has_is_that_of_frames_that_fit_and_select():
    """Whatever the noise of those that report. A thousand pixels tell it to 5 %."""

    def noisy(capture, scene, rng):
        size = 40 * (capture.group == "report")
        return capture.raw() + size * rng.standard_normal(capture.shape)

    profile = uniform(lambda capture, *_: capture.raw()).profile
    assert uniform(noisy, bare(SENSOR)).profile == pytest.approx(profile, rel=0.1)


@pytest.mark.parametrize(("others", "fate"), [(1, "left out"), (0, "kept, since its")])
def test_a_dark_with_a_residual_image_is_left_out_if_there_is_another(others, fate):
    def spoiled(capture, scene, rng):
        if capture.name == "dark-fit1" and not others:
            return None
        share = 0.02 * (capture.name == "dark-fit0")
        return capture.raw() + share * (scene - BLACK)

    found = uniform(spoiled)
    [note] = found.notes
    assert note.startswith("dark-fit0: has a residual image of scene-fit0, ")
    assert f"% of its light: {fate}" in note
    assert ("dark-fit0" in {c.name for c in found.captures}) == (not others)


@pytest.mark.parametrize(("count", "end"), [(20, "."), (21, ", ....")])
def test_the_first_lines_that_are_far_from_others_are_listed(count, end):
    """None that a mask leaves out, nor single samples."""
    apart, counts = np.zeros((64, 96), bool), np.ones((64, 96), bool)
    apart[1 : 1 + count], apart[60], apart[:, 5], apart[50, 7] = True, True, True, True
    counts[60] = False
    captures = [capture_of("dark", 1, mask=lambda: counts)]
    rows, column = lines_apart(SimpleNamespace(masked=lambda shape: apart), captures)
    listed = ", ".join(map(str, range(1, 21)))
    assert rows.startswith(f"{count} rows far from the others")
    assert rows.endswith(f": row {listed}{end}") and column.endswith(": column 5.")


def test_frames_of_the_most_frequent_size_decide():
    made = shown_set(SENSOR, standard_set((64, 96)), 1)
    first = made.captures[0]
    small = replace(first, shape=(32, 96), raw=lambda: first.raw()[:32])
    given = replace(made, captures=[small, *made.captures[1:]])
    found = uniform_frames(given, LEAST, lambda share: None)
    assert small not in found.captures and len(found.captures) == 11
    assert found.notes == ["1 frame of another size left out of the darks and flats."]


def test_darks_of_saved_statistics_are_not_asked_for_residual_images(tmp_path):
    made = shown_set(SENSOR, standard_set((64, 96)), 1)
    made = replace(made, captures=[replace(c, digest=c.name) for c in made.captures])
    saved, tell = tmp_path / "kept.npz", lambda share: None
    found = uniform_frames(made, LEAST, tell, saved)
    note = "Darks of saved statistics: no residual image is looked for."
    assert saved.exists() and note in found.notes
    frames = [c for c in made.captures if c.is_uniform]
    alone = uniform_frames(replace(made, captures=frames), LEAST, tell, saved)
    assert note not in alone.notes  # nor is one where nothing else was lit
