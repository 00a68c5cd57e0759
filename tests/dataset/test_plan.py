# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A plan's files: their names, and what decides light, crop and noise of each."""

import pytest

import cg2raw
from cg2raw.dataset.options import make_plan
from cg2raw.dataset.plan import Plan
from dataset.data_sets import FIELDS

SENSORS = [cg2raw.Sensor("samsung-s20fe"), cg2raw.Sensor("nikon-d850")]


def plan_of(**fields):
    return make_plan(SENSORS, pytest.fail, **FIELDS | fields)


ALL = {
    **{"illuminants": 2, "digital_gains": (1.0, 0.8), "isos": (None, 100.0)},
    **{"bracket": (-2.0, 0.0), "crop": (4, 6), "patches": 2, "format": "npy"},
}


def test_a_file_is_called_by_what_is_chosen_for_it():
    plan = plan_of(**ALL)
    files = list(plan.variants("shots/a.exr", 5))
    assert len(files) == plan.files_of_an_image == 2**6
    assert len({file.path for file in files}) == len(files)
    assert files[0].path == "shots/a/samsung-s20fe_l0_g1_clean_ev-2_p0.npy"
    assert files[-1].path == "shots/a/nikon-d850_l1_g0.8_iso100_ev+0_p1.npy"
    assert files[-1].clean_path == "shots/a/nikon-d850_l1_g0.8_clean_ev+0_p1.npy"
    assert files[0].clean_path is None
    names = [file.path for file in plan_of(isos=(99.5,)).variants("a.b", 0)]
    assert names == [f"a.b/{s.id}_l0_g1_iso99.5.dng" for s in SENSORS]
    assert next(plan_of(isos=(100.0,)).variants("a.exr", 0)).clean_path is None


def test_noise_differs_between_files_but_for_brackets_which_the_core_tells_apart():
    frames = [file.frame for file in plan_of(**ALL).variants("a.exr", 0)]
    assert len(set(frames)) == len(frames) / 2
    assert all(0 <= frame < 2**53 for frame in frames)  # JSON keeps these


@pytest.mark.parametrize(
    ("frame_from", "of_name", "of_index"),
    [("name", True, False), ("index", False, True), ("none", False, False)],
)
def test_noise_is_keyed_by_the_name_or_the_place_of_an_image(
    frame_from, of_name, of_index
):
    plan = plan_of(frame_from=frame_from)

    def frames(image, index):
        return [file.frame for file in plan.variants(image, index)]

    assert (frames("a.exr", 0) != frames("b.exr", 0)) == of_name
    assert (frames("a.exr", 0) != frames("a.exr", 1)) == of_index


def test_lights_are_drawn_by_seed_image_and_number_alone():
    words = plan_of(illuminants=3).words("a.exr")
    assert plan_of(illuminants=2, **{"isos": (100.0,)}).words("a.exr") == words[:2]
    others = [plan_of(illuminants=3, seed=1).words("a.exr")]
    others.append(plan_of(illuminants=3).words("b.exr"))
    assert len({*words, *others[0], *others[1]}) == 9
    for word in words:
        kind, _, number = word.partition(":")
        assert kind == "sample" and 0 <= int(number) < 2**31
    assert plan_of(illuminants=("A", "D50")).words("a.exr") == ["A", "D50"]


def test_crops_reach_all_places_and_no_further():
    plan = plan_of(crop=(4, 6), patches=200)
    crops = [plan.crop_at("a.exr", patch, 6, 7) for patch in range(200)]
    assert {crop[:2] for crop in crops} == {(x, y) for x in range(3) for y in range(2)}
    assert {crop[2:] for crop in crops} == {(4, 6)}
    assert plan.crop_at("a.exr", 0, 4, 6) == (0, 0, 4, 6)
    for size in ((3, 6), (4, 5)):
        words = f"is {size[0]}x{size[1]}, smaller than the crop 4x6"
        with pytest.raises(ValueError, match=words):
            plan.crop_at("a.exr", 0, *size)
    assert plan_of().crop_at("a.exr", 0, 9, 7) == (0, 0, 9, 7)


def test_a_plan_reads_back():
    plan = plan_of(**ALL)
    assert Plan.from_json(plan.to_json()) == plan
