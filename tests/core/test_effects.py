# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""effect.h: the laws that every registered effect obeys."""

import numpy as np
import pytest

import cg2raw
from oracles import cameras
from oracles.scenes import scene

STAGES = (
    "color",
    "optics",
    "pixel",
    "response",
    "noise",
    "saturation",
    "readout",
    "adc",
    "processing",
)
EFFECTS = {effect["name"]: effect for effect in cg2raw.effects()}
NAMED = """color_matrix exposure white_balance
    blur color_shading lateral_chromatic_aberration lens_distortion lens_shading
    veiling_glare crosstalk dust gr_gb_imbalance mains_flicker pdaf_pixels prnu
    amplifier_glow dark_current dark_current_nonuniformity hot_pixels nonlinearity
    poisson_shot_noise shot_noise full_well
    amplifier_mismatch bias_structure black_level black_level_drift
    column_fixed_pattern dsnu
    heavy_tailed_noise random_telegraph_noise read_noise read_noise_correlation
    row_noise quantisation noise_reduction"""
# Parameters that act only where the effect's others do.
PARTNERS = {
    "heavy_tailed_noise": (
        "tukey_lambda",
        "outlier_fraction",
        "outlier_variance_ratio",
    ),
    "blur": ("red_scale", "blue_scale"),
    "hot_pixels": ("fraction", "rate"),
    "bias_structure": ("edge", "edge_length"),
    "amplifier_glow": ("per_second", "row", "column", "extent"),
    "dark_current_nonuniformity": ("rate", "log_sigma"),
    "dust": ("density", "depth", "radius"),
    "mains_flicker": ("period",),
    "pdaf_pixels": ("pitch", "row", "column"),
    "random_telegraph_noise": ("fraction", "amplitude"),
}
# Where a tenth of the way to a bound does not show in the scene, or fills it.
STRONG = {
    "full_well": {"below_white": 0.85},
    "dark_current": {"per_second": 0.05},
    "hot_pixels": {"rate": 0.01},
    "amplifier_glow": {"per_second": 0.05},
    "dark_current_nonuniformity": {"rate": 0.01},
    "dust": {"density": 5000.0},
    "mains_flicker": {"period": 20.0},
    "pdaf_pixels": {"pitch": 7, "row": 3, "column": 5},  # whole numbers
    # Of few pixels whose variance has long tails: as many as make it known to 2 %.
    "random_telegraph_noise": {"fraction": 0.1},
}
TIMED = "amplifier_glow dark_current dark_current_nonuniformity hot_pixels".split()
# Effects on the noise of others, which is there besides.
ON_NOISE = {"read_noise_correlation": "read_noise"}
# Their centre, or their mean, is that of the image.
OF_THE_IMAGE = """lens_shading color_shading lateral_chromatic_aberration
    lens_distortion veiling_glare amplifier_glow amplifier_mismatch
    bias_structure""".split()
OF_A_FRAME = ("black_level_drift",)  # all its pixels share one draw
# Of the order of the noise, and so that no sample lies far from its level.
BASE = {
    "shot_noise": {f"beta1_{site}": 2e-3 for site in ("00", "01", "10", "11")},
    "read_noise": {f"beta2_{site}": 1e-4 for site in ("00", "01", "10", "11")},
}
REACH = 2 * (max(effect["reach"] for effect in EFFECTS.values()) // 2 + 1)


def sensor_with(name=None, **values):
    """A sensor with one effect; parameters that are not given are null."""
    if name is None:
        return cg2raw.Sensor.from_json(cameras.profile_text())
    parameters = {p["name"]: p["null"] for p in EFFECTS[name]["parameters"]}
    parameters.update(values)
    settings = [{"name": name, "parameters": parameters}]
    if name in ON_NOISE:
        settings.append({"name": ON_NOISE[name], "parameters": BASE[ON_NOISE[name]]})
    return cg2raw.Sensor.from_json(cameras.profile_text(effects=settings))


def tenth(parameter):
    """A tenth of the way from null to a bound."""
    p = parameter
    bound = p["max"] if p["max"] != p["null"] else p["min"]
    return p["null"] + 0.1 * (bound - p["null"])


def strong(name):
    """Every parameter at a tenth."""
    values = {p["name"]: tenth(p) for p in EFFECTS[name]["parameters"]}
    return {**values, **STRONG.get(name, {})}


def strengths(name):
    """Every parameter at a tenth, and each one that acts alone, others null."""
    all_on = strong(name)
    yield all_on
    for parameter, value in all_on.items():
        if parameter not in PARTNERS.get(name, ()):
            yield {parameter: value}


def run_of(name, **run):
    """What a run says beside the scene."""
    timed = {"exposure_time": 2.0} if name in TIMED else {}
    return {"illuminant": "D50", **timed, **run}


def signal(sensor, name=None, **run):
    return np.asarray(sensor.signal(scene(), **run_of(name, **run)), float)


def test_the_registry_is_complete_and_in_the_order_of_the_stages():
    assert set(NAMED.split()) <= set(EFFECTS)
    keys = [(STAGES.index(e["stage"]), e["name"]) for e in EFFECTS.values()]
    assert keys == sorted(keys)


@pytest.mark.parametrize("name", EFFECTS)
def test_an_effect_says_what_it_is(name):
    effect = EFFECTS[name]
    assert effect["meaning"] and effect["source"] and effect["parameters"]
    for p in effect["parameters"]:
        assert p["name"] and p["unit"] and p["meaning"]
        assert p["min"] <= p["null"] <= p["max"] and p["min"] < p["max"]


@pytest.mark.parametrize("name", EFFECTS)
def test_null_parameters_are_identity(name):
    other = ON_NOISE.get(name)
    without = sensor_with(other, **BASE[other]) if other else sensor_with()
    assert (signal(sensor_with(name), name) == signal(without)).all()


@pytest.mark.parametrize("name", EFFECTS)
def test_every_parameter_does_something(name):
    """Alone, or with the others if it acts only with them."""
    all_on = strong(name)
    for p in EFFECTS[name]["parameters"]:
        others = all_on if p["name"] in PARTNERS.get(name, ()) else {}
        steps = ({p["name"]: value} for value in (p["null"], all_on[p["name"]]))
        seen = [signal(sensor_with(name, **{**others, **step}), name) for step in steps]
        assert (seen[0] != seen[1]).any(), p["name"]


@pytest.mark.parametrize("name", EFFECTS)
def test_effects_can_be_left_out_of_a_run(name):
    for values in strengths(name):
        seen = signal(sensor_with(name, **values), name, effects=False)
        assert (seen == signal(sensor_with())).all()


@pytest.mark.parametrize("name", EFFECTS)
def test_one_key_one_frame(name):
    for values in strengths(name):
        sensor = sensor_with(name, **values)
        runs = [signal(sensor, name, seed=5, frame=2) for _ in range(2)]
        assert (runs[0] == runs[1]).all()


@pytest.mark.parametrize("name", EFFECTS)
def test_what_is_temporal_changes_from_frame_to_frame(name):
    temporal = EFFECTS[name]["pattern"] == "temporal" or name in ON_NOISE
    for values in strengths(name):
        sensor = sensor_with(name, **values)
        frames = [signal(sensor, name, frame=f) for f in (0, 1)]
        seeds = [signal(sensor, name, seed=s) for s in (0, 1)]
        assert (frames[0] != frames[1]).any() == temporal
        assert (seeds[0] != seeds[1]).any() >= temporal


@pytest.mark.parametrize("name", EFFECTS)
def test_threads_do_not_matter(name):
    sensor = sensor_with(name, **strong(name))
    rgb = scene(150, 601)
    raw = [
        sensor.simulate(rgb, **run_of(name), seed=3, threads=t).tobytes()
        for t in (1, 2, 7)
    ]
    assert raw[0] == raw[1] == raw[2]


@pytest.mark.parametrize("name", EFFECTS)
def test_a_pixel_does_not_depend_on_the_image_around_it(name):
    if name in OF_THE_IMAGE:
        pytest.skip("its centre or its mean is that of the image")
    sensor = sensor_with(name, **strong(name))
    rgb = scene(60, 700)
    whole, part = (
        np.asarray(sensor.signal(image, **run_of(name), seed=4))
        for image in (rgb, rgb[:53, :421])
    )
    inner = (slice(53 - REACH), slice(421 - REACH))
    assert (whole[inner] == part[inner]).all()


def departures(settings, rows, **run):
    """Return signals that are drawn less those predicted, means, variances (rows, 16).

    Of many rows, whose draws are independent even where those of a row are not; each
    is a frame of its own where the draws of a frame are not."""
    sensor = cg2raw.Sensor.from_json(cameras.profile_text(effects=settings))
    rgb = 0.4 * scene(rows, 16)  # nothing reaches white
    mean, variance = (np.asarray(x, float) for x in sensor.predict(rgb, **run))
    if any(setting["name"] in OF_A_FRAME for setting in settings):
        # Pairs, which begin on the same site of the CFA.
        pairs = [rgb[row : row + 2] for row in range(0, rows, 2)]
        drawn = [sensor.signal(p, seed=6, frame=n, **run) for n, p in enumerate(pairs)]
        left = np.concatenate(drawn).astype(float) - mean
        return tuple(x[::2] for x in (left, mean, variance))
    return np.asarray(sensor.signal(rgb, seed=6, **run), float) - mean, mean, variance


def rows_for(name):
    """Rows of 16 pixels; fewer where they cost more: with the square of the height, a
    frame each, or a thousand spots."""
    fewer = {"veiling_glare": 1000, "dust": 10000, **dict.fromkeys(OF_A_FRAME, 8000)}
    return fewer.get(name, 20000)


def check_moments(left, mean, variance):
    rows = len(left)
    z = left / np.sqrt(variance)
    assert z.mean() == pytest.approx(0.0, abs=4.0 / np.sqrt(rows))
    assert z.var() == pytest.approx(1.0, abs=4.0 * np.sqrt(2.0 / rows))
    # The signal's own mean does not leak into the noise.
    slope = np.polyfit(mean.ravel(), left.ravel(), 1)[0]
    assert abs(slope) < 5.0 * np.sqrt(variance.mean() / mean.var() / mean.size)


def setting_of(name, **values):
    return {"name": name, "parameters": {**strong(name), **values}}


@pytest.mark.parametrize("name", EFFECTS)
def test_drawn_mean_and_variance_are_the_predicted_ones(name):
    left, mean, variance = departures(
        [setting_of(name)], rows_for(name), **run_of(name)
    )
    if variance.any():
        check_moments(left, mean, variance)
    else:
        assert not left.any()


@pytest.mark.parametrize("name", [n for n in EFFECTS if n not in BASE])
def test_an_effect_predicts_what_it_makes_of_noise(name):
    """It works on a signal with shot and read noise, or adds to them."""
    settings = [setting_of(name), *(setting_of(n, **v) for n, v in BASE.items())]
    left, mean, variance = departures(settings, rows_for(name), **run_of(name))
    assert variance.min() > 0.9e-5
    check_moments(left, mean, variance)


def test_drawn_effects_and_gaussian_ones_add_up():
    """No variance is drawn twice, and the order within a stage does not matter."""
    rows = 40000
    names = ("poisson_shot_noise", "heavy_tailed_noise", "row_noise", "shot_noise")
    values = {"beta1": 0.01, "beta2": 4e-4, "tukey_lambda": 0.0, "sigma": 0.02}
    values |= {"outlier_fraction": 0.02, "outlier_variance_ratio": 9.0}
    effects = [
        {
            "name": name,
            "parameters": {
                p["name"]: values[p["name"].partition("_0")[0].partition("_1")[0]]
                for p in EFFECTS[name]["parameters"]
            },
        }
        for name in names
    ]
    sensor = cg2raw.Sensor.from_json(cameras.profile_text(effects=effects))
    rgb, run = scene(rows, 16), {"illuminant": "D50", "seed": 6}
    mean, variance = (np.asarray(x, float) for x in sensor.predict(rgb, **run))
    np.testing.assert_allclose(variance, 8e-4 + 0.02 * mean, rtol=1e-5)
    z = (np.asarray(sensor.signal(rgb, **run), float) - mean) / np.sqrt(variance)
    assert z.mean() == pytest.approx(0.0, abs=4.0 / np.sqrt(rows))
    assert z.var() == pytest.approx(1.0, abs=0.01)
    slope = np.polyfit(mean.ravel(), (z**2).ravel(), 1)[0]
    assert abs(slope) < 5.0 * np.sqrt(2.0 / z.size) / mean.std()


@pytest.mark.parametrize("name", EFFECTS)
def test_what_was_clipped_stays_white(name):
    if STAGES.index(EFFECTS[name]["stage"]) <= STAGES.index("response"):
        pytest.skip("it acts before the sensor clips")
    if name == "full_well":
        pytest.skip("it clips below white")
    sensor, run = sensor_with(name, **strong(name)), run_of(name)
    raw = sensor.simulate(scene() + 20.0, seed=3, **run)
    assert (raw == sensor.white_level).all()
    _, variance = sensor.predict(scene() + 20.0, **run)
    assert EFFECTS[name]["stage"] == "adc" or not variance.any()


@pytest.mark.parametrize("name", EFFECTS)
def test_parameters_out_of_bounds_are_named(name):
    for p in EFFECTS[name]["parameters"]:
        for value in (p["min"] - 1.0, p["max"] + 1.0):
            with pytest.raises(ValueError, match=f"{name}.*{p['name']}"):
                signal(sensor_with(name, **{p["name"]: value}))


def test_unknown_parameters_are_named():
    with pytest.raises(ValueError, match="lens_shading.*r8.*r2"):
        signal(sensor_with("lens_shading", r8=0.1))


def test_an_effect_may_not_act_twice():
    noisy = sensor_with("shot_noise", beta1_00=1e-4)
    with pytest.raises(ValueError, match="shot_noise.*twice"):
        signal(noisy, iso=100)
