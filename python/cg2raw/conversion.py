# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Convert an image file to a DNG as the plugin does, without OpenImageIO as a host."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cg2raw import _core
from cg2raw.argument_types import path_text
from cg2raw.io import image_facts, image_file
from cg2raw.io.atomic_file import FilePath
from cg2raw.io.spectra_file import SpectraFile, read_camera
from cg2raw.raw_frame import RawFrame
from cg2raw.short_messages import NO_MEMORY
from cg2raw.spectra import Rows, estimated_light
from cg2raw.upi import Upi, UpiDraw

COUNTED_ROWS = 16  # at a time: of photographs they fit a core's cache
BY_ATTRIBUTE = ("first_frame",)  # options of the core that have no flag


def typed(name: str, value: str) -> str:
    """Return an option as it is typed for cg2raw convert; @value may be empty."""
    if name in BY_ATTRIBUTE:
        return f"--attrib dng:{name} {value}".rstrip()
    return f"--{name.replace('_', '-')} {value}".rstrip()


DIALECT = image_facts.dialect(typed)


@dataclass(frozen=True)
class Request:
    """What every image is converted by.

    options : {name: text}, of _core.export_options()."""

    options: Mapping[str, str] = field(default_factory=dict)
    threads: int = 0  # 0: one per core; files do not depend on it
    space: str | None = None  # the name of the pixels' colour space, if the file errs
    place: int | None = None  # frames from the first of its shot
    output_name: str | None = None  # whose number is the frame's; None: of the output
    upi: Upi | None = None  # its method, in place of sensor, illuminant and gains


def convert(path: FilePath, output: FilePath, request: Request) -> dict[str, Any]:
    """Write the DNG @output of the image at @path; return the report, of JSON's types.

    Raises ValueError, OSError or MemoryError in one line; then there is no new file."""
    with image_file.opened(path) as source:
        decided, spec = decide(path, output, request, source)
        unseen = None
        if decided.spectral is None:
            pixels = image_file.read_picture(path, source, spec, decided, True)
        else:
            assert decided.bins is not None  # of spectra
            file = SpectraFile(str(path), spec, decided.bins)
            pixels, unseen = read_camera(file, decided.spectral)
    nan, inf = not_finite(pixels)
    run, drawn = decided.run, None
    if request.upi:
        frame = request.upi.simulate(pixels, threads=request.threads, **run)
        drawn = request.upi.draw(run["seed"])
        simulation = frame.simulation
    else:
        simulation = decided.simulation(pixels, request.threads)
        frame = simulation.raw(pixels, request.threads).view(RawFrame)
    assert simulation is not None  # of what simulate returns
    try:
        decided.write(path_text(output), frame, simulation, request.threads)
    except MemoryError:
        raise MemoryError(f"{output}: {NO_MEMORY}") from None
    return {
        "input": str(path),
        "output": str(output),
        **report_of(frame, simulation, request, run, drawn),
        "frame_rate": decided.shot.frame_rate,
        "time_code": decided.shot.time_code,
        "layer": decided.layer.name or None,
        "linearized": decided.undone or None,
        "unseen_energy": unseen,
        "nan": nan,
        "inf": inf,
    }


def decide(
    path: FilePath,
    output: FilePath,
    request: Request,
    source: Any,
    by_header: bool = False,
) -> tuple[_core.Export, Any]:
    """Return (all that decides the DNG of a file, the ImageSpec of its picture).

    source : of the file. by_header : a light that all pixels make is not measured.
    Raises ValueError."""
    options = _core.ExportOptions(request.options, DIALECT)
    rule = _core.resolve_picture if request.upi else _core.resolve

    def measured_light(word: str, bins: _core.SpectralChannels) -> Rows:
        if by_header:
            return [(nm, 1.0) for nm in bins.wavelengths]
        file = SpectraFile(str(path), source.spec(), bins)
        return estimated_light(word, None, bins.wavelengths, file.statistic)

    return image_file.resolved(
        path,
        source,
        lambda facts: rule(facts, options, DIALECT),
        request.space,
        output_name=request.output_name or str(output),
        place=request.place,
        measured_light=measured_light,
    )


def stated_shot(path: FilePath, request: Request) -> _core.Shot:
    """Return what a file's header and the options say of its place in a shot.

    Its picture must be there, and be what the options say. Raises ValueError,
    OSError."""
    with image_file.opened(path) as source:
        decided, _ = decide(path, "", request, source, by_header=True)
        return decided.shot


def not_finite(pixels: NDArray[np.floating[Any]]) -> tuple[int, int]:
    """Return how many values are NaN, and how many infinite."""
    nan = inf = 0
    for first in range(0, len(pixels), COUNTED_ROWS):
        part = pixels[first : first + COUNTED_ROWS]
        if not np.isfinite(part).all():
            nan += int(np.isnan(part).sum())
            inf += int(np.isinf(part).sum())
    return nan, inf


def report_of(
    frame: RawFrame,
    simulation: _core.Simulation,
    request: Request,
    run: dict[str, Any],
    drawn: UpiDraw | None,
) -> dict[str, Any]:
    """Return what decided a frame, of JSON's types. run : some fields of its Run."""
    light = simulation.illuminant
    report: dict[str, Any] = {
        "width": frame.shape[1],
        "height": frame.shape[0],
        "sensor": light.sensor,
        "method": "upi" if drawn else "graphics2raw",
        "illuminant": {
            "word": light.spec,
            "neutral": list(light.neutral),
            "cct": light.cct,
            "duv": light.duv,
            "spectrum": simulation.spectrum or None,
        },
        "exposure": simulation.exposure,
        "digital_gain": simulation.digital_gain,
        "iso": simulation.exposure["iso"],
        "seed": run["seed"],
        "frame": run["frame"],
    }
    if request.upi and drawn:
        report["upi"] = {
            "weights": dict(zip(request.upi.matrices, drawn.weights, strict=True)),
            "camera_from_xyz": drawn.camera_from_xyz.tolist(),
            "red_gain": drawn.red_gain,
            "blue_gain": drawn.blue_gain,
            "shot_noise": drawn.shot_noise,
            "read_noise": drawn.read_noise,
        }
    return report
