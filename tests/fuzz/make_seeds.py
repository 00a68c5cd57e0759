# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Write the seeds that fuzzing starts from: python -m fuzz.make_seeds FOLDER, in tests.

All of them are made up here; none holds a byte of a camera's file. FOLDER/dng,
FOLDER/profile and FOLDER/spectra are made. Tag numbers: DNG specification 1.7.1;
types: TIFF 6.0."""

import json
import struct
import sys

from fuzz.seed_folders import write_seeds

BYTE, ASCII, SHORT, LONG, RATIONAL, UNDEFINED, SRATIONAL, DOUBLE = (
    1,
    2,
    3,
    4,
    5,
    7,
    10,
    12,
)
FORMATS = {1: "B", 2: "B", 3: "H", 4: "I", 5: "I", 7: "B", 10: "i", 12: "d"}

X_TRANS = "GGRGGBGGBGGRBRGRBGGGBGGRGGRGGBRBGBRG"  # as the layout is published
GLARE = {"uniform": 0.1, "wide": 0.1}
SECOND_MATRIX = (
    SRATIONAL,
    10000,
    [8000, -2000, -800, -4000, 12000, 2200, -800, 1800, 6000],
)
CALIBRATION = (SRATIONAL, 100, [101, 0, 0, 0, 100, 0, 0, 0, 99])
FORWARD = (SRATIONAL, 128, [74, 28, 21, 20, 108, 0, -2, -37, 145])


def dng(ifd0, sub_ifds=(), exif=None, order="<"):
    """Return a TIFF. ifd0, sub_ifds, exif : {tag: (type, [denominator,] values)}."""
    body = bytearray(
        struct.pack(order + "2sHI", b"II" if order == "<" else b"MM", 42, 0)
    )

    def packed(kind, *words):
        values = words[-1]
        if len(words) == 2:
            values = [word for value in values for word in (value, words[0])]
        data = struct.pack(f"{order}{len(values)}{FORMATS[kind]}", *values)
        return kind, len(values) // (2 if kind in (RATIONAL, SRATIONAL) else 1), data

    def append(ifd):
        entries = []
        for tag, field in sorted(ifd.items()):
            kind, count, data = packed(*field)
            if len(data) > 4:
                body.extend(data)
                data = struct.pack(order + "I", len(body) - len(data))
            entries.append(
                struct.pack(order + "HHI", tag, kind, count) + data.ljust(4, b"\0")
            )
        body.extend(
            struct.pack(order + "H", len(entries)) + b"".join(entries) + bytes(4)
        )
        return len(body) - 6 - 12 * len(entries)

    ifd0 = dict(ifd0)
    if sub_ifds:
        ifd0[330] = (LONG, [append(ifd) for ifd in sub_ifds])
    if exif:
        ifd0[34665] = (LONG, [append(exif)])
    struct.pack_into(order + "I", body, 4, append(ifd0))
    return bytes(body)


def text(words):
    return (ASCII, [*words.encode(), 0])


def raw(side=2, colors=(0, 1, 1, 2), **more):
    """Return the tags of a mosaic of 12 x 12 pixels. more : t51041=..., by number."""
    tags = {254: (LONG, [0]), 256: (LONG, [12]), 257: (LONG, [12]), 258: (SHORT, [16])}
    tags |= {262: (SHORT, [32803]), 277: (SHORT, [1]), 33421: (SHORT, [side, side])}
    tags |= {33422: (BYTE, colors), 50714: (SHORT, [64]), 50717: (SHORT, [1023])}
    return tags | {int(name[1:]): value for name, value in more.items()}


def camera(**more):
    """Return the tags of IFD0 that name and describe a camera."""
    tags = {271: text("Maker"), 272: text("Model 1"), 274: (SHORT, [1])}
    tags |= {50706: (BYTE, [1, 4, 0, 0]), 50707: (BYTE, [1, 3, 0, 0])}
    tags |= {50708: text("Maker Model 1"), 50728: (RATIONAL, 100, [52, 100, 57])}
    tags |= {50721: (SRATIONAL, 1000, [703, -80, -101, -442, 1256, 206, -85, 199, 576])}
    tags |= {50778: (SHORT, [21])}
    return tags | {int(name[1:]): value for name, value in more.items()}


def without(tags, *numbers):
    """Return tags but for those of some numbers."""
    return {tag: field for tag, field in tags.items() if tag not in numbers}


EXIF = {33434: (RATIONAL, 60, [1]), 33437: (RATIONAL, 10, [56]), 34855: (SHORT, [400])}
EXIF |= {36867: text("2019:06:06 07:29:51"), 37386: (RATIONAL, 1, [65])}
EXIF |= {42036: text("A lens")}


def gain_map(points=3, area=(0, 0, 12, 12), pitch=1, gain=lambda v, h: 1.0):
    """Return an opcode GainMap, its points from edge to edge."""
    step = 1 / max(1, points - 1)
    gains = [gain(v * step, h * step) for v in range(points) for h in range(points)]
    data = struct.pack(">10I", *area, 0, 1, pitch, pitch, points, points)
    data += struct.pack(">4dI", step, step, 0, 0, 1)
    return 9, data + struct.pack(f">{len(gains)}f", *gains)


def opcodes(*list_of_opcodes):
    data = struct.pack(">I", len(list_of_opcodes))
    for number, parameters in list_of_opcodes:
        data += struct.pack(">4I", number, 0x01030000, 1, len(parameters)) + parameters
    return (UNDEFINED, list(data))


def shaded(v, h):
    return 1 + 0.4 * ((v - 0.5) ** 2 + (h - 0.5) ** 2)


def raws():
    """Return {name: tags of a mosaic}."""
    sites = [(row, col, 12, 12) for row in (0, 1) for col in (0, 1)]
    maps = [gain_map(3, area, 2, shaded) for area in sites]
    xtrans = ["RGB".index(letter) for letter in X_TRANS]
    return {
        "bayer": raw(),
        "x_trans": raw(6, xtrans),
        "quad": raw(4, [0, 0, 1, 1, 0, 0, 1, 1, 1, 1, 2, 2, 1, 1, 2, 2]),
        "mono": without(raw(t262=(SHORT, [34892])), 33421, 33422),
        "noise": raw(t51041=(DOUBLE, [1e-4, 2e-7])),
        "noise_of_planes": raw(t51041=(DOUBLE, [1e-4, 2e-7, 2e-4, 1e-7, 3e-4, 3e-7])),
        "active_area": raw(t50829=(LONG, [1, 2, 11, 12])),
        "linearization": raw(t50712=(SHORT, list(range(0, 1024, 64)))),
        "black_deltas": raw(
            t50713=(SHORT, [2, 2]),
            t50714=(RATIONAL, 10, [640, 641, 642, 643]),
            t50715=(SRATIONAL, 3, list(range(12))),
            t50716=(SRATIONAL, 3, list(range(12))),
        ),
        "gain_map": raw(t51009=opcodes(gain_map(5, gain=shaded))),
        "gain_maps": raw(t51009=opcodes(*maps)),
        "opcodes": raw(
            t51008=opcodes((5, bytes(8)), (4, bytes(8))),
            t51009=opcodes((8, b"\1\2\3"), gain_map(1)),
            t51022=opcodes((1, bytes(2)), (99, b"")),
        ),
        "without_levels": without(raw(), 50714, 50717),
    }


def cameras():
    """Return {name: tags of IFD0}."""
    pair = {"t50722": SECOND_MATRIX, "t50779": (SHORT, [17])}
    return {
        "two_matrices": camera(**pair),
        "calibrated": camera(
            **pair,
            t50723=CALIBRATION,
            t50724=CALIBRATION,
            t50727=(RATIONAL, 10, [20, 10, 15]),
            t50931=text("signature"),
            t50932=text("signature"),
        ),
        "forward": camera(**pair, t50964=FORWARD, t50965=FORWARD),
        "white_xy": without(camera(t50729=(RATIONAL, 10000, [3127, 3290])), 50728),
        "no_neutral": without(camera(), 50728),
        "texts": camera(
            t270=text("a description"),
            t315=text("an artist"),
            t33432=text("\u00e9\u4e00"),
        ),
    }


def dngs():
    """Return {name: bytes}."""
    preview = {254: (LONG, [1]), 262: (SHORT, [6])}
    files = {}
    for order, end in (("<", "little"), (">", "big")):
        for name, tags in raws().items():
            files[f"{name}_{end}"] = dng(camera() | tags, exif=EXIF, order=order)
        for name, tags in cameras().items():
            ifd0 = tags | {254: (LONG, [1]), 262: (SHORT, [2])}
            files[f"{name}_{end}"] = dng(ifd0, [preview, raw()], EXIF, order)
    return files


def profile(**fields):
    """Return a legal profile as JSON text; a field of None is left out."""
    legal = {
        "schema": 1,
        "id": "a",
        "make": "b",
        "model": "c",
        "unique_camera_model": "d",
    }
    legal |= {"sources": {"noise": "planted"}, "cfa": "RGGB", "width": 64, "height": 48}
    legal |= {"bits": 14, "black_level": [512] * 4, "white_level": 16383}
    legal |= {"calibration_illuminant_1": "D65"}
    legal |= {"color_matrix_1": [0.7, -0.08, -0.1, -0.44, 1.26, 0.2, -0.08, 0.2, 0.58]}
    legal |= fields
    return json.dumps(
        {name: value for name, value in legal.items() if value is not None}
    )


def profiles():
    """Return {name: text}."""
    second = [0.8, -0.2, -0.08, -0.4, 1.2, 0.22, -0.08, 0.18, 0.6]
    pair = {"calibration_illuminant_2": "A", "color_matrix_2": second}
    noise = [{"iso": iso, "beta1": iso * 1e-6, "beta2": 1e-6} for iso in (100, 400)]
    shape = {"tukey_lambda": -0.1, "row_sigma": 5e-4}
    outliers = {"outlier_fraction": 0.01, "outlier_variance_ratio": 9.0}
    neutrals = [[0.9, 0.3], [0.5, 0.6], [0.7, 0.35], [0.45, 0.75], [0.6, 0.5]]
    shading = {"r2": -0.3, "r4": 0.1, "r6": 0.0, "tilt_x": 0.01, "tilt_y": 0.0}
    shading |= {"tilt_x_r2": 0.0, "tilt_y_r2": -0.02}
    x_trans = {"cfa": X_TRANS, "black_level": [512, 513, 514]}
    lamp = {"name": "x", "neutral": [0.5, 0.6], "color_matrix": second}
    power = {"wavelengths": [400, 545, 546, 700], "values": [0.2, 0, 9, 0.4]}
    curves = {"wavelengths": list(range(380, 781, 20))}
    for channel, peak in (("R", 600), ("G", 540), ("B", 460)):
        away = [abs(nm - peak) / 100 for nm in curves["wavelengths"]]
        curves[channel] = [max(0.01, round(1 - far, 3)) for far in away]
    return {
        "one_matrix": profile(),
        "two_matrices": profile(**pair),
        "forward": profile(
            **pair,
            forward_matrix_1=[0.6, 0.2, 0.16, 0.2, 0.8, 0, 0, -0.175, 1],
            forward_matrix_2=[0.6, 0.2, 0.16, 0.2, 0.8, 0, 0, -0.175, 1],
        ),
        "neutrals": profile(illuminants={"neutrals": neutrals}),
        "hull": profile(
            illuminants={
                "mean": [0.6, 0.5],
                "covariance": [[0.02, -0.01], [-0.01, 0.02]],
                "hull": neutrals,
            }
        ),
        "noise": profile(noise=noise),
        "shape": profile(noise=[row | shape for row in noise]),
        "outliers": profile(
            noise=[row | shape | outliers for row in noise],
            noise_effects=["poisson_shot_noise", "heavy_tailed_noise"],
        ),
        "per_site": profile(
            noise=[{"iso": 100, "beta1": [1e-4] * 4, "beta2": [1e-6] * 3}]
        ),
        "x_trans": profile(**x_trans, noise=noise),
        "x_trans_sites": profile(cfa=X_TRANS, black_level=list(range(36))),
        "quad": profile(cfa="RRGGRRGGGGBBGGBB", black_level=512),
        "mono": profile(
            cfa="mono",
            black_level=512,
            calibration_illuminant_1=None,
            color_matrix_1=None,
            noise=noise,
        ),
        "lamps": profile(lamps=[lamp, {**lamp, "name": "FL2", "power": power}]),
        "spectra": profile(
            spectral_sensitivities=curves, lamps=[{**lamp, "power": power}]
        ),
        "photons": profile(
            spectral_sensitivities={**curves, "unit": "photon", "scale": 0.5}
        ),
        "digital_gain": profile(digital_gain={"mean": 0.9, "sigma": 0.1}),
        "effects": profile(
            effects=[
                {
                    "name": "lens_shading",
                    "parameters": shading,
                    "evidence": {"rms": [0.1]},
                },
                {
                    "name": "row_noise",
                    "parameters": {"sigma": 0.1},
                    "ci95": {"a": [0, 1]},
                },
                {"name": "quantisation"},
            ]
        ),
        "whole_frame": profile(
            effects=[{"name": "veiling_glare", "parameters": GLARE}]
        ),
        "no_lists": profile(noise=[], effects=[], illuminants={"neutrals": []}),
        "nulls": profile().replace("}", "", 1)[:-1] + ', "noise": null}',
        "escapes": profile(sources={"a\n\u00e9": "\u4e00 \U0001f4f7"}),
    }


def spectra():
    """Return {name: channels of an image}, a line each: name, wavelength, response."""
    nm = range(400, 701, 50)
    box = "{}nm:0;{}nm:1;{}nm:0;"
    boxes = {w: box.format(w - 25, w, w + 25) for w in nm}
    return {
        "commas": lines(f"S0.{w},0nm" for w in nm),
        "dots_are_none": lines(f"S0.{w}.0nm" for w in nm),
        "whole": lines(f"S0.{w}nm" for w in nm),
        "falling": lines(f"S0.{w}nm" for w in reversed(nm)),
        "metres": lines(f"S0.{w}e-9m" for w in nm),
        "micrometres": lines(f"S0.0,{w}um" for w in nm),
        "terahertz": lines(f"S0.{w}THz" for w in range(430, 750, 40)),
        "hertz": lines(f"S0.{w}e12Hz" for w in range(430, 750, 40)),
        "stokes": lines(f"S{i}.{w}nm" for w in nm for i in range(4)),
        "with_rgb": lines(["R", "G", "B", "A", *(f"S0.{w}nm" for w in nm)]),
        "attributes": lines(f"wl{w}\t{w}e-9" for w in nm),
        "both_ways": lines(["S0.550nm", "wl\t6e-7", "S0.500nm\t7e-7"]),
        "responses": lines(f"S0.{w}nm\t\t{boxes[w]}" for w in nm),
        "spaces": lines(f"S0.{w}nm\t\t 400nm : 1" for w in nm),
        "of_frequencies": lines(f"S0.{w}nm\t\t500THz:1;600THz:2" for w in nm),
        "gaps": lines(["S0.400nm\t\t390nm:1;410nm:1;", "S0.700nm\t\t690nm:1;710nm:1;"]),
        "lines": lines(f"S0.{w},00001nm" for w in (400, 401, 700)),
        "far": lines(["S0.1nm", "S0.550nm", "S0.1000000nm"]),
        "one": lines(["S0.550nm", "R"]),
        "twice": lines(["S0.550nm", "S0.550,0nm"]),
        "reflectances": lines(f"T.{w}nm" for w in nm),
        "some_responses": lines(["S0.400nm", f"S0.500nm\t\t{boxes[500]}"]),
        "no_response": lines(["S0.400nm\t\tD65", "S0.500nm\t\tD65"]),
        "nm_for_m": lines(["a\t400", "b\t500"]),
        "not_finite": lines(["a\tnan", "b\tinf", "c\t5e-7"]),
        "empty": "",
        "many": lines(f"S0.{w}nm" for w in range(380, 781)),
    }


def lines(words):
    """Return a text of a line each."""
    return "".join(f"{word}\n" for word in words)


def main(folder):
    """Write all seeds to a folder of folder for each reader."""
    write_seeds(folder, {"dng": dngs(), "profile": profiles(), "spectra": spectra()})


if __name__ == "__main__":
    main(sys.argv[1])
