# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""One entry of the shelf, made a profile.

Keys of an entry, all but `bits`, `black_level`, `white_level` optional where another
says the same:

identity : (make, model, unique_camera_model); without it RawSpeed's row has them
rawspeed : (model, mode) of RawSpeed's row, also a second opinion on the CFA
rawler : model of rawler's rows: CFA, and the matrices if `matrices` is absent
cfa : letters at the corner of the active area; without it rawler's, shifted
active_area : (x, y, width, height) in the raw file
matrices : key of the table of graphics2raw
sensitivities : camera of the Academy's table of spectral sensitivities
neutrals : (table, camera or None)
noise : ("samsung" or "eld", name in that table)
noise_note : what else is to be said of an "eld" camera
dng : a real DNG, read by cg2raw itself, for all that is not given here
sources : {"field, field": text}, over the texts that the tables give
"""

import json
import re

from . import noise, tables

NEUTRAL_SETS = {
    "nus9_gt_illuminants.csv": "NUS set, {title} (Cheng et al., JOSA A 2014): the "
    "distribution of {count} grey cards",
    "gehler_shi_illuminants.csv": "Gehler-Shi set, {title} (Gehler et al., CVPR 2008, "
    "in Shi's linear reprocessing): the distribution of {count} ColorCheckers",
    "samsung_s20fe_night_greycard_105.csv": "SamsungLabs graphics2raw (ICCV 2023): the "
    "distribution of {count} grey cards shot at night",
}
NO_NEUTRALS = (
    "no set of its neutrals is published, so sample:n walks the Planckian locus "
    "between the calibration illuminants"
)
NO_NOISE = (
    "no published noise data, so this sensor is simulated clean; cg2raw calibrate "
    "measures it (docs/calibrate.md)"
)
ELD = (
    "Wei et al., A Physics-based Noise Formation Model for Extreme Low-light Raw "
    "Denoising (CVPR 2020), released parameters (MIT): K of ISO 100 to 6400 by its "
    "authors' word, in 14-bit DN per electron; beta1 = K / (white - black), beta2 = "
    "(variance of the Tukey-lambda read noise + row variance) / (white - black)^2; "
    "both sigmas follow log-linear fits that single ISOs leave by 20 to 40 %"
)


def per_field(sources):
    """Return {"a": text, "b": text} of {"a, b": text}."""
    return {field: text for key, text in sources.items() for field in key.split(", ")}


def identity(entry, folder):
    """Return make, model and unique_camera_model, with their sources."""
    names = ("make", "model", "unique_camera_model")
    if "identity" in entry:
        return dict(zip(names, entry["identity"], strict=True)), {}
    row = tables.rawspeed_row(folder, *entry["rawspeed"])
    text = "RawSpeed's table of cameras"
    values = (row["make"], row["model"], row["id"])
    return dict(zip(names, values, strict=True)), {", ".join(names): text}


def cfa(entry, folder):
    """Return the CFA's letters at the corner of the active area, with their source."""
    if "cfa" in entry:
        return {"cfa": entry["cfa"]}, {}
    whole = tables.rawler_row(folder, entry["rawler"], "D65")["cfa"]
    second = tables.rawspeed_row(folder, *entry["rawspeed"])["cfa"]
    if second not in ("", whole):
        raise ValueError(f"{entry['rawler']}: rawler says {whole}, RawSpeed {second}")
    x, y = entry["active_area"][:2]
    tellers = "rawler's and RawSpeed's tables" if second else "rawler's table"
    seen = tables.phase_at(whole, x, y)
    text = f"{tellers}: {whole} at the corner of the raw file"
    if (x, y) != (0, 0):
        text += f", hence {seen} at ({x}, {y}), the corner of the active area"
    return {"cfa": seen}, {"cfa": text}


def calibrations(entry, folder):
    """Return calibration illuminants and colour matrices, with their sources."""
    if "matrices" in entry:
        found = tables.graphics2raw_matrices(folder, entry["matrices"])
        text = (
            "Adobe's matrices for A and D65, as SamsungLabs graphics2raw (ICCV 2023) "
            "lists them; equal to 1e-4 to those in dnglab's rawler"
        )
    else:
        found = tables.rawler_matrices(folder, entry["rawler"])
        text = "Adobe's matrices for A and D65, as dnglab's rawler lists them"
    fields = {
        f"calibration_illuminant_{i}": light for i, light in enumerate(found, start=1)
    } | {
        f"color_matrix_{i}": matrix for i, matrix in enumerate(found.values(), start=1)
    }
    return fields, {", ".join(fields): text}


def sensitivities(entry, folder):
    """Return the spectral sensitivities that may be passed on, with their source."""
    if "sensitivities" not in entry:
        return {}, {}
    camera = entry["sensitivities"]
    field, file, creator = tables.rawtoaces_sensitivities(folder, camera)
    text = (
        f"rawtoaces-data of the Academy Software Foundation (Apache-2.0), {file} by "
        f"{creator}; the matrices above are not fitted to them"
    )
    return {"spectral_sensitivities": field}, {"spectral_sensitivities": text}


def illuminants(entry, folder):
    """Return the distribution of the neutrals, if any is published, with its source."""
    if "neutrals" not in entry:
        return {}, {"illuminants": NO_NEUTRALS}
    file, camera = entry["neutrals"]
    neutrals = tables.neutrals_of(folder, file, camera)
    text = NEUTRAL_SETS[file].format(title=entry["title"], count=len(neutrals))
    return {"illuminants": tables.distribution_of(neutrals)}, {"illuminants": text}


def noise_rows(entry, folder):
    """Return the rows of noise, with their source."""
    if "noise" not in entry:
        return {"noise": []}, {"noise": NO_NOISE}
    kind, name = entry["noise"]
    levels = entry["black_level"], entry["white_level"]
    rows = {"samsung": noise.samsung_noise, "eld": noise.eld_noise}[kind]
    text = ELD + entry.get("noise_note", "")
    return {"noise": rows(folder, name, *levels)}, {"noise": text}


def from_tables(name, entry, folder):
    """Return the profile of an entry that the tables describe."""
    bayer = len(cfa(entry, folder)[0]["cfa"]) == 4
    black = entry["black_level"]
    sensor = {
        "width": entry["active_area"][2],
        "height": entry["active_area"][3],
        "bits": entry["bits"],
        "black_level": [black] * 4 if bayer else black,
        "white_level": entry["white_level"],
    }
    fields, sources = {}, {}
    for part in (identity, cfa):
        more, texts = part(entry, folder)
        fields, sources = fields | more, sources | texts
    fields |= sensor
    for part in (calibrations, sensitivities, illuminants, noise_rows):
        more, texts = part(entry, folder)
        fields, sources = fields | more, sources | texts
        if part is illuminants and "digital_gain" in entry:
            fields["digital_gain"] = entry["digital_gain"]
    sources = per_field(sources) | per_field(entry["sources"])
    order = {key: sources[key] for key in fields if key in sources}
    return {
        "schema": 1,
        "id": name,
        **{key: fields.pop(key) for key in ("make", "model", "unique_camera_model")},
        "sources": order | sources,
        **fields,
        "effects": [],
    }


def rounded(value):
    """Return JSON data at 6 digits: the last bits of a fit are one machine's."""
    if isinstance(value, dict):
        return {key: rounded(part) for key, part in value.items()}
    if isinstance(value, list):
        return [rounded(part) for part in value]
    if not isinstance(value, float):
        return value
    return int(value) if value.is_integer() else noise.significant(value)


def from_dng(name, entry, folder):
    """Return the profile of an entry that a real DNG describes, read by cg2raw."""
    import cg2raw  # only here: tables alone need no build of the library

    sensor = cg2raw.Sensor.from_dng(folder.parent / "real" / entry["dng"])
    read = {"noise": [], "effects": [], **rounded(json.loads(sensor.to_json()))}
    for of_exposure in ("illuminants", "digital_gain"):
        read.pop(of_exposure, None)
    sources = {
        "illuminants": NO_NEUTRALS + "; the file's own neutral is one exposure's"
    }
    if not read["noise"]:
        sources["noise"] = NO_NOISE
    last = {key: read.pop(key) for key in ("noise", "effects")}
    return {
        **read,
        "id": name,
        "sources": per_field(entry["sources"]) | sources,
        **last,
    }


def profile_of(name, entry, folder):
    """Return the profile of one entry as a dict; folder holds the tables."""
    make = from_dng if "dng" in entry else from_tables
    return make(name, entry, folder)


def formatted(profile):
    """Return JSON text with every list of numbers on one line."""
    return (
        re.sub(
            r"\[[-+0-9.eE,\s]+\]",
            lambda numbers: (
                "[" + ", ".join(numbers.group()[1:-1].split()).replace(",,", ",") + "]"
            ),
            json.dumps(profile, indent=2),
        )
        + "\n"
    )
