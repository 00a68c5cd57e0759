# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""illuminant.h: the grammar, neutrals, and parity with Adobe's renderer."""

import numpy as np
import pytest

import cg2raw
from oracles import adobe, cameras, robertson

GRAMMAR = "3200K.*xy:.*neutral:.*sample:"
D40 = cameras.oracle("NikonD40")
NAMED = {
    "A": (0.4476, 0.4074),
    "D50": (0.3457, 0.3585),
    "D55": (0.3324, 0.3474),
    "D65": (0.3127, 0.3290),
    "D75": (0.2990, 0.3149),
    "xy:0.38:0.37": (0.38, 0.37),
}


@pytest.fixture(scope="module")
def sensor():
    return cg2raw.Sensor.from_json(cameras.profile_text())


@pytest.mark.parametrize(("spec", "xy"), NAMED.items())
def test_a_named_light_is_seen_by_the_matrix_of_its_temperature(sensor, spec, xy):
    light = sensor.illuminant(spec)
    neutral = D40.neutral_from_xy(xy)
    seen, _, _ = D40.xy_from_neutral(neutral)
    assert light.spec == spec
    assert light.neutral == pytest.approx(neutral, abs=1e-12)
    assert light.xy == pytest.approx(seen, abs=1e-12)
    assert light.xy == pytest.approx(xy, abs=1e-5)  # the neutral has six digits
    cct, duv = robertson.temperature(seen, "adobe")
    assert light.cct == pytest.approx(cct, rel=1e-9)
    assert light.duv == pytest.approx(duv, abs=1e-9)


@pytest.mark.parametrize("kelvin", ["1667", "2856", "3200", "4321.5", "25000"])
def test_a_temperature_is_a_black_body(sensor, kelvin):
    light = sensor.illuminant(kelvin + "K")
    xy = cg2raw.planckian_xy(float(kelvin))
    assert light.neutral == pytest.approx(D40.neutral_from_xy(xy), abs=1e-12)


def test_a_neutral_is_taken_as_it_is(sensor):
    light = sensor.illuminant("neutral:0.55:0.45")
    assert light.neutral == pytest.approx((0.55, 1.0, 0.45), abs=0)


def test_as_shot_is_the_neutral_of_the_reference(sensor):
    light = sensor.illuminant("as-shot", as_shot=(0.3, 0.6, 0.2))
    assert light.neutral == pytest.approx((0.5, 1.0, 0.333333), abs=1e-12)
    with pytest.raises(ValueError, match="reference"):
        sensor.illuminant("as-shot")


@pytest.mark.parametrize(
    "spec",
    "|F2|3200|K|-5K|0K|1666K|25001K|nanK|infK|1e9K|5000K |xy|xy:0.3|xy:0.3:0.3:0.3"
    "|xy:a:b|xy:nan:0.3|xy:0.9:0.9|xy:0:0|xy:-0.1:0.3|xy:0.3:|neutral:0.5|neutral:0:0.5"
    "|neutral:-1:1|neutral:inf:1|neutral:0.5:nan|neutral:0.5:0.5:0.5|sample|sample:"
    "|measured|measured:x|measured:-1|measured:0-3|sample:x|sample:-1|sample:1.5|sample:0-3|sample:99999999999|A,D65|as_shot".split(
        "|"
    ),
)
def test_an_unknown_word_is_told_a_near_one_or_the_grammar(sensor, spec):
    with pytest.raises(ValueError, match=f"{GRAMMAR}|did you mean") as error:
        sensor.illuminant(spec)
    assert (spec or '""') in str(error.value) and "\n" not in str(error.value)


def test_lists():
    assert cg2raw.illuminant_list("A,sample:0-3,xy:0.3:0.4,D65") == [
        "A",
        "sample:0",
        "sample:1",
        "sample:2",
        "sample:3",
        "xy:0.3:0.4",
        "D65",
    ]
    assert cg2raw.illuminant_list("measured:8-9") == ["measured:8", "measured:9"]


@pytest.mark.parametrize(
    "words", ["", "A,,D65", ",A", "A;D65", "sample:5-3", "sample:0-", "A,F2", "1000K"]
)
def test_a_list_with_a_word_that_does_not_parse_is_an_error(words):
    with pytest.raises(ValueError, match=GRAMMAR):
        cg2raw.illuminant_list(words)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("sample:9-0", "must rise, as sample:0-9;"),
        ("sample:0-100000", "names 100001 draws; a list has at most 100000;"),
        ("measured:0-2147483648", "is beyond the last draw, 2147483647;"),
    ],
)
def test_a_range_of_draws_says_which_bound_it_breaks(words, said):
    with pytest.raises(ValueError, match=said):
        cg2raw.illuminant_list(words)


def ratios(sensor, count, first=0):
    lights = [sensor.illuminant(f"sample:{i}") for i in range(first, first + count)]
    return np.array([light.neutral for light in lights])[:, [0, 2]]


def test_a_sample_is_a_pure_function_of_profile_and_index(sensor):
    again = cg2raw.Sensor.from_json(cameras.profile_text())
    backwards = [again.illuminant(f"sample:{i}").neutral for i in reversed(range(20))]
    forwards = [sensor.illuminant(f"sample:{i}").neutral for i in range(20)]
    assert forwards == backwards[::-1]
    assert len(set(map(tuple, forwards))) == 20


def hull_margin(points, hull):
    """Smallest cross product with the hull's edges; negative outside."""
    edge = np.roll(hull, -1, axis=0) - hull
    offset = points[:, None, :] - hull[None]
    return (edge[:, 0] * offset[..., 1] - edge[:, 1] * offset[..., 0]).min(axis=1)


def hull_of(points):
    """Convex hull, counter-clockwise, by gift wrapping."""
    points = np.unique(points, axis=0)
    hull = [points[0]]
    while True:
        best = points[(points != hull[-1]).any(axis=1)][0]
        for p in points:
            a, b = best - hull[-1], p - hull[-1]
            if a[0] * b[1] - a[1] * b[0] < 0.0:
                best = p
        if (best == hull[0]).all():
            return np.array(hull)
        hull.append(best)


def test_samples_are_the_gaussian_of_the_neutrals_within_their_hull(sensor):
    neutrals = np.array(cameras.profile()["illuminants"]["neutrals"])
    hull = hull_of(neutrals)
    samples = ratios(sensor, 3000)
    assert hull_margin(samples, hull).min() >= 0.0
    rng = np.random.default_rng(5)
    drawn = rng.multivariate_normal(neutrals.mean(axis=0), np.cov(neutrals.T), 400000)
    drawn = drawn[hull_margin(drawn, hull) >= 0.0]
    error = drawn.std(axis=0) / np.sqrt(len(samples))
    assert np.abs(samples.mean(axis=0) - drawn.mean(axis=0)).max() < 4.0 * error.max()
    spread = np.cov(samples.T) / np.cov(drawn.T)
    assert spread == pytest.approx(1.0, abs=0.12)  # 4 sigma of 3000 draws: 0.10


def test_mean_covariance_and_hull_may_stand_for_the_neutrals(sensor):
    neutrals = np.array(cameras.profile()["illuminants"]["neutrals"])
    stated = {
        "mean": neutrals.mean(axis=0).tolist(),
        "covariance": np.cov(neutrals.T).tolist(),
        "hull": hull_of(neutrals).tolist(),
    }
    other = cg2raw.Sensor.from_json(cameras.profile_text(illuminants=stated))
    assert ratios(other, 50) == pytest.approx(ratios(sensor, 50), abs=2e-6)


@pytest.mark.parametrize("neutrals", [[], [[0.5, 0.6]], [[0.5, 0.6], [0.7, 0.4]]])
def test_too_few_neutrals_are_sampled_along_the_locus(neutrals):
    text = cameras.profile_text(illuminants={"neutrals": neutrals})
    sensor = cg2raw.Sensor.from_json(text)
    lights = [sensor.illuminant(f"sample:{i}") for i in range(100)]
    kelvin = np.array([light.cct for light in lights])
    assert kelvin.min() >= 2845.0 and kelvin.max() <= 6505.0
    assert np.ptp(1e6 / kelvin) > 150.0  # of 197 mired
    assert max(abs(light.duv) for light in lights) < 5e-4


def test_one_matrix_and_too_few_neutrals_leave_nothing_to_sample():
    text = cameras.profile_text(
        illuminants=None, calibration_illuminant_2=None, color_matrix_2=None
    )
    with pytest.raises(ValueError, match="neutrals.*matrix"):
        cg2raw.Sensor.from_json(text).illuminant("sample:0")


def test_one_matrix_is_never_interpolated():
    text = cameras.profile_text(calibration_illuminant_2=None, color_matrix_2=None)
    sensor = cg2raw.Sensor.from_json(text)
    expected = adobe.rounded_matrix(cameras.matrices("NikonD40")[0])
    for spec in ("A", "D75"):
        xy = sensor.illuminant(spec).xy
        assert sensor.camera_from_xyz(xy) == pytest.approx(expected, abs=1e-15)


def test_the_order_of_the_calibrations_does_not_matter(sensor):
    cm_a, cm_d65 = (m.ravel().tolist() for m in cameras.matrices("NikonD40"))
    text = cameras.profile_text(
        calibration_illuminant_1="D65",
        color_matrix_1=cm_d65,
        calibration_illuminant_2="A",
        color_matrix_2=cm_a,
    )
    other = cg2raw.Sensor.from_json(text)
    for spec in ("A", "4000K", "D75"):
        assert other.illuminant(spec).neutral == sensor.illuminant(spec).neutral


def test_weight_is_clamped_and_linear_in_reciprocal_temperature(sensor):
    assert sensor.warm_weight(cg2raw.planckian_xy(2000.0)) == 1.0
    assert sensor.warm_weight(cg2raw.planckian_xy(9000.0)) == 0.0
    for kelvin in (3000.0, 4000.0, 5500.0):
        xy = cg2raw.planckian_xy(kelvin)
        assert sensor.warm_weight(xy) == pytest.approx(D40.warm_weight(xy), abs=1e-9)


def test_matrices_are_scaled_and_rounded_as_converters_do():
    doubled = [2.0 * v for v in cameras.matrices("NikonD40")[0].ravel()]
    text = cameras.profile_text(color_matrix_1=doubled)
    matrix = cg2raw.Sensor.from_json(text).camera_from_xyz((0.53, 0.41))
    assert np.max(matrix @ adobe.xyz(adobe.D50)) == pytest.approx(1.0, abs=2e-4)
    assert matrix == pytest.approx(adobe.rounded_matrix(np.reshape(doubled, (3, 3))))
    assert matrix * 1e4 == pytest.approx(np.round(matrix * 1e4), abs=1e-9)


# Either light makes a renderer think of the other one: it never settles, as with a real
# file of a GoPro HERO7.
RESTLESS = {
    "color_matrix_1": [
        0.865,
        0.036,
        -0.452,
        -0.962,
        1.393,
        0.221,
        -0.053,
        0.148,
        1.067,
    ],
    "color_matrix_2": [
        0.874,
        -0.456,
        0.207,
        -0.275,
        1.263,
        0.159,
        -0.321,
        0.179,
        0.617,
    ],
}
RESTLESS_NEUTRAL = (1.067, 1.0, 0.615)


def test_a_neutral_that_never_converges_gets_the_mean_of_the_last_two():
    sensor = cg2raw.Sensor.from_json(cameras.profile_text(**RESTLESS))
    oracle = adobe.Camera([2850.0, 6500.0], list(RESTLESS.values()))
    xy, passes, converged = sensor.xy_from_neutral(RESTLESS_NEUTRAL)
    orbit = [np.array(adobe.D50)]
    for _ in range(30):
        XYZ = np.linalg.solve(
            oracle.camera_from_xyz(orbit[-1]), adobe.rounded_neutral(RESTLESS_NEUTRAL)
        )
        orbit.append(adobe.chromaticity(XYZ))
    assert (passes, converged) == (30, False)
    assert np.abs(orbit[30] - orbit[29]).sum() > 0.1
    assert orbit[30] == pytest.approx(orbit[28], abs=1e-12)
    assert xy == pytest.approx((orbit[29] + orbit[30]) / 2.0, abs=1e-12)
    light = sensor.illuminant("neutral:1.067:0.615")
    assert light.xy == pytest.approx(xy, abs=1e-12)


REAL = ("Fusion_GPFR7066.dng", "Hero6_GOPR0024.dng", "bmpcc_twelvemonkeys.dng")


@pytest.mark.parametrize("name", REAL)
def test_neutrals_of_real_files_are_seen_as_adobe_sees_them(camera_data, name):
    pytest.importorskip("tifffile")
    from oracles import dng_renderer

    dng = dng_renderer.read(camera_data / "real" / name, pixels=False)
    lights = {2850.0: "A", 5000.0: "D50", 6500.0: "D65"}
    fields = {}
    for n, (kelvin, matrix) in enumerate(
        zip(dng.camera.kelvin, dng.camera.matrices, strict=True)
    ):
        fields[f"calibration_illuminant_{n + 1}"] = lights[kelvin]
        fields[f"color_matrix_{n + 1}"] = matrix.ravel().tolist()
    sensor = cg2raw.Sensor.from_json(cameras.profile_text(**fields))
    xy, passes, converged = sensor.xy_from_neutral(dng.neutral)
    expected = dng.camera.xy_from_neutral(dng.neutral)
    assert xy == pytest.approx(expected[0], abs=1e-9)
    assert (passes, converged) == expected[1:]
    assert sensor.camera_from_xyz(xy) == pytest.approx(
        dng.camera.camera_from_xyz(expected[0]), abs=1e-9
    )


@pytest.mark.parametrize(
    ("name", "sensor_id", "spec"),
    [
        ("RAW - nikon-d40 - 2856K", "nikon-d40", "2856K"),
        ("RAW - samsung-s20fe - sample:3", "samsung-s20fe", "sample:3"),
        ("RAW - nikon-d40 - xy:0.3457:0.3585", "nikon-d40", "xy:0.3457:0.3585"),
        ("RAW - nikon-d40 - measured:12", "nikon-d40", "measured:12"),
        ("raw_nikon_d40_measured_12", "nikon-d40", "measured:12"),
    ],
)
def test_raw_space_names(name, sensor_id, spec):
    assert tuple(cg2raw.raw_space_from_name(name)) == (sensor_id, spec)


@pytest.mark.parametrize("name", ["ACEScg", "lin_rec709", "", "raw", "scene_linear"])
def test_other_spaces_are_no_raw_spaces(name):
    assert cg2raw.raw_space_from_name(name) is None


def test_interop_ids_of_raw_spaces_are_known_again():
    known = cg2raw._core.raw_space_interop_id("nikon-d40", "sample:7")
    assert known == "cg2raw:raw_nikon_d40_sample_7"
    for name in (known, known.removeprefix("cg2raw:"), known.upper()):
        assert tuple(cg2raw.raw_space_from_name(name)) == ("nikon-d40", "sample:7")
