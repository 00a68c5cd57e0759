# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The JSON Schema of a sensor profile, for scripts/profile_page.py, which writes it.

The fields are those that the core reads (plugins/core/profile_json.cpp); its tests ask
the core for its own list of them. Effects are those of its registry."""

import json
import re

import cg2raw

LETTERS = "[RGBrgb]"
COLORS = "(?=.*[Rr])(?=.*[Gg])(?=.*[Bb])"


def spelt(word):
    """Return the pattern of a word in either case."""
    return "".join(f"[{c.upper()}{c.lower()}]" for c in word)


BAYER = "|".join(spelt(cfa) for cfa in ("RGGB", "GRBG", "GBRG", "BGGR"))
MONO = spelt("mono")
# CFA -> the counts of numbers that may stand for its sites.
SITES = {
    f"^(?:{BAYER})$": (1, 3, 4),
    f"^{COLORS}{LETTERS}{{16}}$": (1, 3, 16),
    f"^{COLORS}{LETTERS}{{36}}$": (1, 3, 36),
    f"^{MONO}$": (1,),
}
CFA = "^(?:" + "|".join(pattern[1:-1] for pattern in SITES) + ")$"
OF_COLORS = (
    *(
        f"{name}_{n}"
        for n in "12"
        for name in ("calibration_illuminant", "color_matrix")
    ),
    *("forward_matrix_1", "forward_matrix_2", "lamps", "illuminants"),
)


def number(low=None, high=None, above=None):
    """Return the schema of a number within bounds."""
    bounds = {"minimum": low, "maximum": high, "exclusiveMinimum": above}
    return {"type": "number", **{k: v for k, v in bounds.items() if v is not None}}


def whole(low, high):
    """Return the schema of a whole number."""
    return {"type": "integer", "minimum": low, "maximum": high}


def numbers(least, most=None, item=None):
    """Return the schema of a list of numbers."""
    most = least if most is None else most
    counts = {"minItems": least} | ({"maxItems": most} if most else {})
    return {"type": "array", "items": item or number(), **counts}


def objects(fields, required, **more):
    """Return the schema of an object that has these fields and no others."""
    return {
        "type": "object",
        "properties": fields,
        "required": list(required),
        "additionalProperties": False,
        **more,
    }


TEXT = {"type": "string", "minLength": 1}
RATIO = number(0.01, 100)
PAIR = numbers(2, item=RATIO)
MATRIX = numbers(9)
PER_SITE = {"anyOf": [number(0), numbers(1, 36, number(0))]}
SHARE_PER_SITE = {"anyOf": [number(0, 1), numbers(1, 36, number(0, 1))]}


def light_sources():
    """Return the names of calibration illuminants, as the core lists them."""
    text = json.loads(cg2raw.Sensor("nikon-d40").to_json())
    text["calibration_illuminant_1"] = "none"
    try:
        cg2raw.Sensor.from_json(json.dumps(text))
    except ValueError as error:
        return str(error).partition("must be one of ")[2].split(", ")
    raise AssertionError("the core takes every calibration illuminant")


def described(schema, text):
    """Return a schema with what it means."""
    return {"description": text, **schema}


def illuminants():
    """Return the schema of the distribution of neutrals: listed, or summed up."""
    listed = objects({"neutrals": {"type": "array", "items": PAIR}}, ["neutrals"])
    covariance = numbers(2, item=numbers(2))
    gaussian = objects(
        {"weight": number(0, 1), "mean": PAIR, "covariance": covariance},
        ["weight", "mean", "covariance"],
    )
    summed = objects(
        {
            "mean": PAIR,
            "covariance": covariance,
            "hull": numbers(3, 0, PAIR),
            "mixture": {"type": "array", "items": gaussian, "maxItems": 16},
        },
        ["mean", "covariance", "hull"],
    )
    return {"oneOf": [listed, summed]}


def lamp():
    """Return the schema of a lamp."""
    wavelengths = numbers(1, 0, number())
    power = objects(
        {"wavelengths": wavelengths, "values": numbers(1, 0, number(0, 1e9))},
        ["wavelengths", "values"],
    )
    return objects(
        {
            "name": {"type": "string", "pattern": "^[A-Za-z0-9._-]+$"},
            "neutral": PAIR,
            "calibration_illuminant": {"enum": [*light_sources(), "other"]},
            "color_matrix": MATRIX,
            "power": power,
        },
        ["name", "neutral", "color_matrix"],
    )


def noise_row():
    """Return the schema of the noise at one ISO."""
    shape, outliers = (
        ("tukey_lambda", "row_sigma"),
        ("outlier_fraction", "outlier_variance_ratio"),
    )
    pairs = {a: [b, *(shape if pair is outliers else ())]
             for pair in (shape, outliers) for a, b in (pair, pair[::-1])}  # fmt: skip
    return objects(
        {
            "iso": number(above=0, high=1e7),
            "beta1": SHARE_PER_SITE,
            "beta2": SHARE_PER_SITE,
            "tukey_lambda": number(-0.4, 0.5),
            "row_sigma": number(0, 1),
            "outlier_fraction": number(0, 0.5),
            "outlier_variance_ratio": number(1, 100),
        },
        ["iso", "beta1", "beta2"],
        dependentRequired=pairs,
    )


def effect(known):
    """Return the schema of one effect of the registry, with its parameters' bounds."""
    parameters = {
        p["name"]: described(number(p["min"], p["max"]), f"{p['meaning']}, {p['unit']}")
        for p in known["parameters"]
    }
    required = [p["name"] for p in known["parameters"] if not p["optional"]]
    return described(
        objects(
            {
                "name": {"const": known["name"]},
                "parameters": objects(parameters, required),
                "ci95": {},
                "evidence": {},
            },
            ["name", "parameters"] if required else ["name"],
        ),
        known["meaning"],
    )


def spectral():
    """Return the schema of spectral sensitivities, of three channels or of one."""
    curve = numbers(2, 0)
    channels = {name: curve for name in ("R", "G", "B", "mono")}
    wavelengths = numbers(2, 0, number(above=0))
    return objects(
        {
            "wavelengths": wavelengths,
            **channels,
            "unit": {"enum": ["energy", "photon"]},
            "scale": number(above=0),
        },
        ["wavelengths"],
        oneOf=[{"required": ["R", "G", "B"]}, {"required": ["mono"]}],
    )


def fields():
    """Return {field: schema with its description}, in the order of the page."""
    light, matrix = {"enum": light_sources()}, MATRIX
    gain = objects({"mean": number(above=0), "sigma": number(0)}, ["mean", "sigma"])
    drawn = [
        {"enum": ["shot_noise", "poisson_shot_noise"]},
        {"enum": ["read_noise", "heavy_tailed_noise"]},
    ]
    pair = {"type": "array", "prefixItems": drawn, "minItems": 2, "maxItems": 2}
    known = {"type": "array", "items": {"oneOf": [*map(effect, cg2raw.effects())]}}
    rows = {"type": "array", "items": noise_row()}
    said = {"type": "object", "additionalProperties": TEXT}
    ids = {"type": "string", "pattern": "^[a-z0-9][a-z0-9.-]{0,99}$"}
    schemas = {
        "schema": {"const": 1}, "id": ids, "make": TEXT, "model": TEXT,
        "unique_camera_model": TEXT, "sources": said,
        "cfa": {"type": "string", "pattern": CFA},
        "width": whole(2, 65535), "height": whole(2, 65535), "bits": whole(8, 16),
        "black_level": PER_SITE, "white_level": whole(1, 65535),
        "calibration_illuminant_1": light, "color_matrix_1": matrix,
        "forward_matrix_1": matrix,
        "calibration_illuminant_2": light, "color_matrix_2": matrix,
        "forward_matrix_2": matrix,
        "lamps": {"type": "array", "items": lamp()}, "illuminants": illuminants(),
        "digital_gain": gain, "spectral_sensitivities": spectral(), "noise": rows,
        "noise_effects": pair, "effects": known,
    }  # fmt: skip
    texts = dict(re.findall(r"^(\w+): (.+)$", MEANINGS, re.M))
    return {name: described(schema, texts[name]) for name, schema in schemas.items()}


# One line for each field.
MEANINGS = """
schema: Version of this format: 1.
id: Name of the sensor in commands; up to 100 lower-case letters, digits, hyphens and dots, a letter or digit first.
make: Exif Make.
model: Exif Model.
unique_camera_model: DNG UniqueCameraModel.
sources: Where each number is from: {field: text}.
cfa: Filters from the top left of the active area: RGGB, GRBG, GBRG, BGGR, a repeat of 4x4 or 6x6 sites as 16 or 36 letters, or mono.
width: Pixels of a row of the active area.
height: Rows of the active area.
bits: Of a word of the RAW file.
black_level: DN without light; one number, one each for R, G, B, or one per site of the CFA.
white_level: DN at saturation, above every black level.
calibration_illuminant_1: The light of color_matrix_1.
color_matrix_1: Camera RGB from CIE XYZ, 9 numbers row by row (DNG ColorMatrix1).
forward_matrix_1: CIE XYZ under D50 from white-balanced camera RGB (DNG ForwardMatrix1).
calibration_illuminant_2: The light of color_matrix_2; of another temperature.
color_matrix_2: As color_matrix_1; matrices are interpolated between the two lights.
forward_matrix_2: As forward_matrix_1.
lamps: Lights with a matrix of their own: name, neutral [R/G, B/G], color_matrix; perhaps calibration_illuminant and power (wavelengths in nm, values relative).
illuminants: What sample:n and measured:n draw: neutrals [R/G, B/G]; or their mean, covariance and hull, and perhaps a mixture of Gaussians (weight, mean, covariance) that is closer to them.
digital_gain: What dng:gain sample draws: mean and standard deviation.
spectral_sensitivities: R, G, B, or mono, at wavelengths (nm); unit energy (default) or photon; scale is what they were divided by.
noise: One row per ISO, rising. Variance = beta1 x + beta2 of a signal x, 0 at black and 1 at white; perhaps tukey_lambda with row_sigma, and outlier_fraction with outlier_variance_ratio.
noise_effects: What draws the noise: of light, then of the read-out.
effects: Departures from an ideal sensor, by their names in cg2raw effects, with all parameters.
"""  # noqa: E501


def by_cfa():
    """Return what depends on the CFA: the counts of numbers, and matrices."""
    rules = []
    for pattern, counts in SITES.items():
        lists = [{"type": "array", "minItems": n, "maxItems": n} for n in counts]
        per_site = {"anyOf": [{"type": "number"}, *lists]}
        row = {"properties": {"beta1": per_site, "beta2": per_site}}
        then = {"properties": {"black_level": per_site, "noise": {"items": row}}}
        if counts == (1,):
            then["not"] = {"anyOf": [{"required": [name]} for name in OF_COLORS]}
        else:
            then["required"] = ["calibration_illuminant_1", "color_matrix_1"]
        cfa = {"properties": {"cfa": {"type": "string", "pattern": pattern}}}
        rules.append({"if": cfa | {"required": ["cfa"]}, "then": then})
    return rules


def schema():
    """Return the schema as a dictionary."""
    required = (
        "schema id make model unique_camera_model sources cfa width height bits "
        "black_level white_level"
    ).split()
    second = {f"{name}_2": [f"{other}_2"] for name, other in (
        ("calibration_illuminant", "color_matrix"),
        ("color_matrix", "calibration_illuminant"),
        ("forward_matrix", "color_matrix"))}  # fmt: skip
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "cg2raw sensor profile",
        **objects(fields(), required),
        "dependentRequired": second,
        "allOf": by_cfa(),
    }
