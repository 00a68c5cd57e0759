# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Which figures there are, and the files that have them."""

from collections.abc import Iterable, Mapping
from pathlib import Path

from studies.cameras import Camera
from studies.draws import LEARNED, Run, sources_of
from studies.figures.contact_sheet import contact_sheet, scene_pictures
from studies.figures.errors_by_light import errors_by_light
from studies.figures.gap_bars import gap_bars
from studies.figures.isp_examples import isp_examples
from studies.figures.isp_panels import isp_panels
from studies.figures.night_examples import night_examples
from studies.figures.translation_curves import curves_in, translation_curves
from studies.sources.sets import Draw
from studies.summaries import Summaries
from studies.tables_of_results import LIGHTS, by_light, entries_of, ready

BY_LIGHT = {"illuminant": "illuminant", "light_draws": "light"}
COMPARED = ("illuminant", "light_draws", "isp", "denoising", "photographs")


def figures_of_results(results: Summaries) -> dict[str, bytes]:
    """Return the PNG of each figure that summaries alone make, by name."""
    names = [
        name
        for study in COMPARED
        for name, made_of in entries_of(results, study)
        if made_of not in LIGHTS  # which have a figure of their own
    ]
    found = {name: ready(results, name) for name in names}
    pngs = {"gap": gap_bars(found)} if found else {}
    for study, figure in BY_LIGHT.items():
        with_leds, without = by_light(results, study)
        if with_leds:
            pngs[figure] = errors_by_light(with_leds, without)
    return pngs


def figures_of_world(
    run: Run, camera: Camera, studies: Iterable[str]
) -> dict[str, bytes]:
    """Return the PNG of each figure that shows pictures, by name.

    Of the ISP only if it is one of the studies, of scenes at night only if denoising is
    one: they train anew, draw 0 of few sources."""
    pngs = {"scenes": contact_sheet(scene_pictures(run.world, camera))}
    if curves := curves_in(run.folder):
        pngs["translation"] = translation_curves(curves)
    draw = Draw(run.world, camera, run.mode, 0)
    if "isp" in studies:
        made = sources_of(run, LEARNED["isp"], draw)
        pngs["isp"] = isp_panels(isp_examples(draw, made))
    if "denoising" in studies:
        made = sources_of(run, LEARNED["denoising"], draw)
        pngs["night"] = contact_sheet(night_examples(draw, made), colors=256)
    return pngs


def write_figures(folder: Path, pngs: Mapping[str, bytes]) -> None:
    """Write each figure as NAME.png."""
    for name, png in pngs.items():
        (folder / f"{name}.png").write_bytes(png)
