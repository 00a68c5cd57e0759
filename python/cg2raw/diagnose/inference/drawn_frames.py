# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Drawn frames: what captures would be if a model of their sensor were true."""

import json
from dataclasses import replace

from cg2raw import _core
from cg2raw.diagnose.frames.frame import Frame
from cg2raw.diagnose.inference.model_profile import model_profile, values_alone
from cg2raw.diagnose.inference.splits import Splits
from cg2raw.diagnose.likelihood.model import Model
from cg2raw.sensor import Sensor


def drawn_frames(model: Model, splits: Splits, seed: int) -> Splits | None:
    """Return the frames with signals that the core draws by a model, of the same light
    on the same pixels; None of captures whose noise the core cannot draw.

    Maps are those of the model's profile: the sensor is another one of the same kind.
    Nuisances are of the captures, and are not drawn."""
    if not all(_can_be_drawn(model, frame) for frame in splits.frames):
        return None
    values = values_alone(model, splits.fit.frames)
    profile = model_profile(model, splits.fit.frames, values)
    sensor = Sensor.from_json(json.dumps(profile), "a model of the sensor")
    numbered = list(enumerate(splits.frames))
    drawn = splits.workers.map(
        lambda one: _drawn(sensor, one[1], seed, one[0]), numbered
    )
    return Splits(drawn, splits.workers)


def _can_be_drawn(model: Model, frame: Frame) -> bool:
    return frame.samples is None and frame.capture.iso is not None


def _drawn(sensor: Sensor, frame: Frame, seed: int, number: int) -> Frame:
    run = _core.Run(
        illuminant="",
        iso=frame.capture.iso,
        noise=None,
        seed=seed,
        frame=number,
        digital_gain=1.0,
        convention="dng",
        highlights=True,
        effects=True,
        camera_input=True,
        as_shot=None,
        exposure_time=frame.seconds,
    )
    dn = _core.draw_blocks(
        sensor.profile,
        run,
        frame.camera,
        frame.tiles.origins,
        frame.tiles.shape,
        frame.tiles.margin,
        frame.neutral,
        frame.glare_context,
    )
    black = sensor.white_level - frame.range
    return replace(
        frame,
        signal=(dn - black) / frame.range,
        at_white=dn >= sensor.white_level,
        at_zero=dn == 0,
    )
