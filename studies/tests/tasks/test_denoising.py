# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Study 2: what is packed, scores by a planted denoiser, a small run."""

from dataclasses import replace

import numpy as np
import pytest

from studies.draws import appended
from studies.learners.lesson import Lesson
from studies.sources.exposures import by_exposure
from studies.sources.frames import Frames
from studies.sources.sets import Draw, material
from studies.summaries import reduced
from studies.tables_night import night_tables
from studies.tasks import denoising as study
from studies.tasks.noise import Noise

FEW = {"frames": {"quick": 10}, "tests": {"quick": 3}, "draws": {"quick": 2}}
NAMES = ("ISO 3200, brightness 0.35", "ISO 3200, brightness 0.03")
FEW_SOURCES = ("real", "real, other scenes", "ours, match", "upi, match")


@pytest.fixture(scope="module")
def camera(camera_of):
    return camera_of("sony-a7s-ii")


@pytest.fixture(scope="module")
def small(world):
    """The world with few frames and seeds."""
    rules = replace(
        world.protocol.denoising,
        **FEW,
        features=40,
        samples={"quick": 2000},
        isos=(3200,),
        brightness=(0.35, 0.03),
    )
    return replace(world, protocol=replace(world.protocol, denoising=rules))


def made(world, camera, seed=0):
    """The sources of a seed of 10 frames."""
    found = material(world, camera, "night", world.protocol.seeds, 10, seed)
    every = by_exposure(found, camera, seed)
    return {name: every[name] for name in FEW_SOURCES}


def test_packing_takes_the_sites_of_rggb():
    image = np.arange(4 * 6 * 3, dtype=np.float32).reshape(4, 6, 3) / 60
    planes = study.packed([image])
    kept = image.clip(0.0, 1.0)
    assert planes.shape == (1, 4, 2, 3) and planes.max() == 1.0
    assert np.array_equal(planes[0, 0], kept[::2, ::2, 0])
    assert np.array_equal(planes[0, 1], kept[::2, 1::2, 1])
    assert np.array_equal(planes[0, 2], kept[1::2, ::2, 1])
    assert np.array_equal(planes[0, 3], kept[1::2, 1::2, 2])


def test_conditions_are_each_iso_and_brightness(small):
    assert [c.name for c in study.conditions(small.protocol.denoising)] == list(NAMES)


@pytest.mark.parametrize("white", [1.0, 0.1])
def test_what_is_not_denoised_scores_as_its_noise(white):
    """A denoiser that does nothing: PSNR of the planted variance, to 0.1 dB."""
    noise = Noise(2e-3, 1e-4)
    tests = np.full((2, 4, 60, 60), 0.4, np.float32)
    lesson = Lesson(tests, noise.added, white, 1, 0)
    scores = study.psnr_ssim_of(lambda planes: planes, tests, lesson)
    expected = -10.0 * np.log10(2e-3 * 0.4 * white + 1e-4)
    assert scores["psnr"] == pytest.approx([expected] * 2, abs=0.1)
    clean = study.psnr_ssim_of(
        lambda _: tests * np.float32(white), tests, replace(lesson, white=white)
    )
    assert clean["ssim"] == [1.0, 1.0]


def test_each_source_teaches_at_its_own_exposure(small, camera):
    """A learner that tells how bright its lesson is, and denoises nothing."""
    seen = {}

    def learner(lesson):
        seen[lesson.name] = float(lesson.clean.mean())
        return lambda planes: planes

    frames = made(small, camera)["real"]()
    dark = replace(frames, images=[image / 4 for image in frames.images])
    asked = {"real": lambda: frames, "dark": lambda: dark}
    tests = {"world": study.test_frames(small, camera, "quick")}
    draw = Draw(small, camera, "quick", 0)
    found = study.denoising_draw(draw, asked, tests, learner)["world"]
    told = f"sony-a7s-ii, {NAMES[0]}, {{}}, draw 0"
    assert seen[told.format("dark")] == pytest.approx(
        seen[told.format("real")] / 4, rel=0.02
    )
    # The test frames are as bright for all.
    assert found[NAMES[0]]["dark"] == found[NAMES[0]]["real"]


@pytest.mark.slow
def test_a_run_has_each_condition_draw_and_frame(small, camera):
    own = study.test_frames(small, camera, "quick")
    tests = {"world": own, "judge": Frames(own.images[:2], own.neutrals[:2])}
    entry, judged = {}, {}
    for seed in range(2):
        draw = Draw(small, camera, "quick", seed)
        found = study.denoising_draw(draw, made(small, camera, seed), tests)
        entry = appended(entry, found["world"])
        judged = appended(judged, found["judge"])
    assert list(entry) == list(NAMES)
    for of_world, of_judge in zip(entry.values(), judged.values(), strict=True):
        for source, measures in of_world.items():
            assert list(measures) == ["psnr", "ssim"], source
            assert {np.shape(values) for values in measures.values()} == {(2, 3)}
            # The first test frames are the same, and so are their scores.
            for name, values in of_judge[source].items():
                assert np.array_equal(np.array(measures[name])[:, :2], values)
    text = night_tables({"sony-a7s-ii": reduced(entry)}, "Denoising")
    assert text.count("| ours, match - upi, match |") == 2
    for name in NAMES:
        assert f"| {name} | sony-a7s-ii |" in text
    psnr = entry[NAMES[0]]
    gain = np.mean(psnr["ours, match"]["psnr"]) - np.mean(psnr["real"]["psnr"])
    assert f"| ours, match - real | {gain:+.2f} (" in text


def test_unets_are_trained_on_what_the_protocol_names(small, camera, tmp_path):
    pytest.importorskip("torch", reason="PyTorch is not installed")
    few = replace(
        small.protocol.denoising_unet,
        width=4,
        levels=2,
        steps={"quick": 4},
        every=2,
        batch=2,
    )
    world = replace(small, protocol=replace(small.protocol, denoising_unet=few))
    tests = {"world": study.test_frames(small, camera, "quick")}
    draw = Draw(world, camera, "quick", 0, tmp_path)
    found = study.unet_draw(draw, made(small, camera), tests)["world"]
    (iso,), (brightness,) = few.isos, few.brightness
    name = f"ISO {iso:g}, brightness {brightness:g}"
    assert list(found) == [name]
    for of_sources in found.values():
        assert list(of_sources) == list(few.sources)
    assert len(list((tmp_path / "unet").glob("*.pt"))) == len(few.sources)
    assert study.unet_draw(draw, made(small, camera), tests)["world"] == found
