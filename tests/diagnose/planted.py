# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Frames drawn from a model's own prediction, so that its values are known."""

import json
from dataclasses import replace
from functools import cache

import numpy as np

from cg2raw import Sensor
from cg2raw.cfa import repeat_of
from cg2raw.diagnose.captures.capture import Capture, CaptureSet
from cg2raw.diagnose.captures.splits import GROUPS
from cg2raw.diagnose.effects.catalogue import candidates
from cg2raw.diagnose.effects.registry import stated_by
from cg2raw.diagnose.frames.frame import frame_of, source_of
from cg2raw.diagnose.frames.tiling import tiling
from cg2raw.diagnose.scenes.model import Model
from cg2raw.diagnose.scenes.noise_level import noise_models
from cg2raw.diagnose.scenes.predict import predict
from cg2raw.diagnose.workers import Workers
from cg2raw.synthetic.captures import simulate_captures
from cg2raw.synthetic.sensors import ISO, with_noise
from diagnose.closed_loop import simulated

SHAPE = (64, 96)
FULL_WELL, READ_NOISE = 5000.0, 3.0  # electrons
READ = READ_NOISE / FULL_WELL  # read noise in signal
ONE = Workers(1)
BY_NAME = {effect.name: effect for effect in candidates("RGGB")}
# Of effects of light: what a few small frames show by far, in the middle of a range.
PLANTED = {
    "exposure": (0.05,),
    "white_balance": (0.05, -0.04),
    "color_matrix": (0.04, -0.02, 0.03, 0.02, -0.03, 0.02),
    "blur": (0.1, 0.02, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0),
    "color_shading": (0.06, 0.0, 0.0, 0.0, -0.05, 0.0, 0.0, 0.0),
    "lateral_chromatic_aberration": (0.5, -0.4, 0.0, 0.0),
    "lens_distortion": (0.6, -0.2),
    "lens_shading": (-0.2, -0.05, 0.0, 0.01, 0.0, 0.0, 0.0, *20 * (0.0,)),
    "veiling_glare": (0.03, 0.02),
    "crosstalk": (0.01, 0.02, 0.015, 0.01),
    "gr_gb_imbalance": (0.02, -0.01),
    "nonlinearity": (0.06, 0.02),
    "full_well": (0.55,),
    "black_level": (0.002, -0.001, 0.003, 0.001),
    "bias_structure": (0.002, -0.001, 0.0, 0.0),
    "amplifier_mismatch": (0.002, 0.0, 0.01, -0.02),
    "noise_reduction": (0.05, 0.02),
}


def sensor_of(full_well=FULL_WELL, read_noise=READ_NOISE, effects=None, **fields):
    """Return a Bayer sensor of fine DN (9 per read noise), the same at all sites.

    effects : name -> parameters, that its profile states. fields : of its profile, in
    place of what it has."""
    levels = {"bits": 14, "black_level": [256.0] * 4, "white_level": 16383}
    fields = {"id": "planted", **levels, "effects": listed(effects or {}), **fields}
    sensor = changed("canon-70d", **fields)
    if "noise" in fields:
        return sensor
    return with_noise(sensor, full_well, read_noise, ISO)


def changed(sensor, **fields):
    """Return a sensor, or that of an id, with other fields; None leaves one out."""
    sensor = Sensor(sensor) if isinstance(sensor, str) else sensor
    profile = json.loads(sensor.to_json()) | fields
    kept = {name: value for name, value in profile.items() if value is not None}
    return Sensor.from_json(json.dumps(kept), "changed")


def listed(effects):
    """Return effects, name -> parameters, as a profile lists them."""
    return [{"name": name, "parameters": values} for name, values in effects.items()]


def stating(sensor, effects):
    """Return a sensor with a profile that states effects, with all their parameters.

    effects : name -> parameters, others of which are 0."""
    entries = [one | {"parameters": stated_by(one, None)} for one in listed(effects)]
    return changed(sensor, effects=entries)


def x_trans():
    """Return a sensor of 6 x 6 sites, the same at all of them."""
    noise = {"iso": ISO, "beta1": [2e-4] * 36, "beta2": [4e-7] * 36}
    return changed("fujifilm-x-m1", noise=[noise])


@cache
def scene_of(seed, shape=SHAPE):
    """Return (H, W, 3) float32, 0.02..0.8: blobs and edges in many colours."""
    rng = np.random.default_rng(seed)
    rows, cols = np.mgrid[: shape[0], : shape[1]].astype(float)
    scene = np.full((*shape, 3), 0.1)
    for _ in range(60):
        row, col = rng.uniform(0, shape[0]), rng.uniform(0, shape[1])
        far = np.hypot(rows - row, cols - col)
        inside = 0.5 - 0.5 * np.tanh((far - rng.uniform(3, 14)) / rng.uniform(0.7, 2))
        color = rng.uniform(0.02, 0.55, 3)
        scene = scene * (1 - inside[..., None]) + color * inside[..., None]
    return scene.astype(np.float32)


def capture_of(kind="scene", seed=1, **more):
    """Return a capture without pixels of its own; a flat shows a grey of 0.3."""
    shape, level = more.pop("shape", SHAPE), more.pop("level", 0.3)
    scenes = {
        "dark": lambda: np.zeros(3, np.float32),
        "flat": lambda: np.full(3, level, np.float32),
        "scene": lambda: scene_of(seed, shape),
    }
    return Capture(
        **{
            "name": f"{kind}-{seed}",
            "kind": kind,
            "shape": shape,
            "group": "fit",
            "set": f"{kind}-{seed}",
            "illuminant": "D65",
            "iso": ISO,
            "exposure_time": 1.0,
            "raw": lambda: np.full(shape, 300, np.uint16),
            "scene": scenes[kind],
            **more,
        }
    )


def captures_of(kinds, group="fit", **more):
    """Return one capture per kind, each of a scene of its own."""
    return [
        capture_of(kind, n, name=f"{kind}{n}{group}", group=group, **more)
        for n, kind in enumerate(kinds)
    ]


def standard_set(shape, **more):
    """Return captures without pixels: two darks, two flats and two frames of a scene in
    each group."""
    captures = []
    for number, group in enumerate(GROUPS):
        for repeat in range(2):
            name = f"{group}{repeat}"
            given = {"group": group, "shape": shape, **more}
            dark = {"exposure_time": 0.5 + repeat, "name": f"dark-{name}"}
            flat = {"level": 0.2 + 0.4 * repeat, "name": f"flat-{name}"}
            scene = {"set": f"scene-{group}", "name": f"scene-{name}"}
            captures += [
                capture_of("dark", 7 * number + repeat, **{**dark, **given}),
                capture_of("flat", 7 * number + repeat, **{**flat, **given}),
                capture_of("scene", number, **{**scene, **given}),
            ]
    return captures


def frames_of(sensor, captures, pixels=65536):
    """Return the frames of captures, as the engine makes them."""
    capture_set = CaptureSet(sensor, captures)
    noise = noise_models(capture_set)
    side = repeat_of(sensor.cfa)
    return [
        frame_of(
            source_of(capture_set, c, c.raw()),
            tiling(c.shape, pixels, side),
            noise[c.iso],
        )
        for c in captures
    ]


def model_of(sensor, **terms):
    """Return a model with terms at values, in the order of their parameters; those that
    are left out at the end are 0."""
    model = Model(sensor)
    for name, values in terms.items():
        all_values = BY_NAME[name].null
        all_values[: len(values)] = values
        model = model.with_effect(BY_NAME[name], all_values)
    return model


def drawn(frames, model, seed, extra=0.0):
    """Return frames whose pixels are drawn from a model's mean and variance.

    extra : is added to the signal of every frame, or (frame, rng) -> what is."""
    result = []
    for number, frame in enumerate(frames):
        rng = np.random.default_rng([seed, number])
        p = predict(model, frame)
        spread = np.sqrt(np.maximum(p.variance - 1 / 12 / frame.range**2, 0))
        signal = p.mean + spread * rng.standard_normal(p.mean.shape)
        more = extra(frame, rng) if callable(extra) else extra
        result.append(shown(frame, signal + more))
    return result


def shown(frame, signal):
    """Return the frame as an ADC that rounds, and clips at white, shows a signal."""
    dn = np.minimum(np.round(signal * frame.range), frame.range)
    return replace(frame, signal=dn / frame.range, at_white=dn >= frame.range)


def shown_set(sensor, captures, seed, extra=0.0, model=None):
    """Return a set of captures whose pixels are drawn from a model, or the profile."""
    black = np.mean(sensor.black_level)
    frames = frames_of(sensor, captures, 10**9)
    result = []
    for frame in drawn(frames, model or Model(sensor), seed, extra):
        dn = np.clip(np.round(frame.signal[0] * frame.range + black), 0, None)
        raw = np.minimum(dn, sensor.white_level).astype(np.uint16)
        result.append(replace(frame.capture, raw=lambda raw=raw: raw))
    return CaptureSet(sensor, result)


def unexplained(found):
    """Return where darks and flats have structure that no effect has."""
    gains = found.selection.unnamed
    return [name for name, gain in gains.items() if gain > found.least]


def bare(sensor):
    """Return the sensor with no noise of its own."""
    return changed(sensor, noise=None)


def shot_by_registry(sensor, effects, seed=1, shape=(112, 144)):
    """Return the standard set, each dark and flat twice, drawn by the registry's own
    simulation of a sensor with effects, to be diagnosed as frames of one without them.

    effects : name -> parameters."""
    planted = changed(sensor, effects=listed(effects))
    bare_captures = simulate_captures(sensor, {}, seed=seed, shape=shape, twice=True)
    return replace(simulated(bare_captures, planted), sensor=sensor)
