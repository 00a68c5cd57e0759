# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Write the seeds of what a host asks: python -m fuzz.plugin_seeds FOLDER, in tests.

FOLDER/plugin is made; fuzz_plugin.cpp says what each line means. Paths are those of the
source tree, where fuzzing runs."""

import sys

from fuzz.seed_folders import write_seeds

SENSOR = "attribute string dng:sensor nikon-d40"
LIGHT = "attribute string dng:illuminant D65"
PLAIN = ["size 8 8 3 float", SENSOR, LIGHT]
WHOLE_FRAME = "attribute string dng:sensor tests/fuzz/profile/whole_frame"
NOISY = ["attribute string dng:sensor samsung-s20fe", "attribute float dng:iso 800"]


def written(lines, *calls):
    """Return a file that is opened, written by calls, and closed."""
    return [*lines, "open", *(calls or ["image float"]), "close"]


def attributes():
    """Return {name: lines} of what an image says beside its size."""
    given = {
        "noise": [*NOISY, "attribute int dng:seed 7", "attribute int dng:frame 3"],
        "physical": [
            "attribute string dng:sensor sony-a7s-ii",
            *NOISY[1:],
            "attribute string dng:noise physical",
        ],
        "choices": [
            "attribute string dng:compression none",
            "attribute string dng:matrices exact",
            "attribute string dng:crop none",
            "attribute string dng:tone_curve linear",
            "attribute string dng:effects none",
            "attribute int dng:preview 0",
            "attribute int dng:highlights 0",
        ],
        "paper": [
            *NOISY[:1],
            "attribute string dng:convention paper",
            "attribute string dng:digital_gain sample",
        ],
        "metered": ["attribute string dng:exposure auto:90:0.5"],
        "drawn": ["attribute string dng:exposure random:-1:2"],
        "settings": [
            "attribute string dng:exposure auto",
            "attribute float dng:scene_luminance 100",
            "attribute float dng:f_number 2",
            "attribute float dng:iso 100",
            "attribute float dng:nd_filter 1",
            "attribute string dng:time_limits 1/8000:1/30",
        ],
        "bracket": [
            "attribute float dng:bracket -2",
            "attribute string dng:exposure_time 1/60",
        ],
        "no_setting": ["attribute float dng:scene_luminance 100"],
        "shot": [
            "attribute string dng:framerate 24000/1001",
            "attribute string dng:timecode 01:00:00:00",
            "attribute int dng:frame 12",
            "attribute int dng:first_frame 2",
            "attribute string dng:reel A001",
            "attribute string dng:camera_label A",
            "attribute string dng:shading baked",
        ],
        "exif": [
            "attribute float ExposureTime 0.01",
            "attribute float FNumber 5.6",
            "attribute int Exif:FocalLength 50",
            "attribute string DateTime 2019:06:06 07:29:51",
            "attribute string Artist an artist",
            "attribute string ImageDescription two\\nlines",
            "attribute int Orientation 6",
            "attribute rational FramesPerSecond 24 1",
            "attribute timecode smpte:TimeCode 16777216 0",
        ],
        "primaries": [
            "attribute float[8] chromaticities 0.64 0.33 0.3 0.6 0.15 0.06 0.3127 0.329"
        ],
        "rec709": ["attribute string oiio:ColorSpace Linear"],
        "srgb": ["attribute string oiio:ColorSpace sRGB"],
        "wrong_types": [
            "attribute float[3] dng:iso 1 2 3",
            "attribute matrix dng:sensor 1",
            "attribute string[2] dng:seed 1",
        ],
        "no_number": ["attribute string dng:iso high"],
        "no_iso": ["attribute string dng:noise gaussian"],
        "unknown": ["attribute string dng:isso 100"],
        "bits": ["attribute int oiio:BitsPerSample 10"],
        "line_in_a_word": ["attribute string dng:matrices a\\nb"],
        "reference_is_none": ["attribute string dng:reference tests/fuzz/dng/no_file"],
    }
    return {name: written(PLAIN + lines) for name, lines in given.items()}


def spaces():
    """Return {name: lines} of pixels that already are RAW, or spectra."""
    raw = "attribute string oiio:ColorSpace RAW - nikon-d40 - D65"
    sensor = "attribute string dng:sensor tests/fuzz/profile/spectra"
    bins = " ".join(f"S0.{nm},0nm" for nm in range(400, 701, 50))
    spectral = ["size 4 4 7 half", f"channels {bins}", sensor, LIGHT]
    return {
        "raw_space": written(["size 8 8 3 float", raw]),
        "raw_space_and_light": written(["size 8 8 3 float", raw, LIGHT]),
        "spectral": written([*spectral, "attribute float dng:white_luminance 100"]),
        "spectral_estimate": written(
            [
                *spectral[:3],
                "attribute string dng:illuminant estimate",
                "attribute string illuminant 400nm:0.3;700nm:0.5;",
                "attribute float whiteLuminance 50",
            ],
            "rows 0 4 half",
        ),
        "spectral_without_white": written(spectral),
        "layers": written(
            ["size 8 8 7 float", "channels R G B A diffuse.R diffuse.G diffuse.B"]
            + [SENSOR, LIGHT, "attribute string dng:layer diffuse"]
        ),
        "no_layer": written(["size 8 8 2 float", SENSOR, LIGHT]),
        "more_names_than_channels": written(
            ["size 8 8 1 float", "channels R G B", SENSOR, LIGHT]
        ),
    }


def orders():
    """Return {name: lines} of ways to hand over pixels, and to stop."""
    tiled = ["size 20 18 3 float", "tile 16 16", SENSOR, LIGHT]
    whole = [*PLAIN[:1], WHOLE_FRAME, LIGHT]
    overscan = ["size 12 12 3 float", "data -2 -2", "full 0 0 8 8", SENSOR, LIGHT]
    inside = ["size 4 4 3 float", "data 2 2", "full 0 0 8 8", SENSOR, LIGHT]
    rows = [f"rows {y} {y + 1} float" for y in range(8)]
    return {
        "rows": written(PLAIN, *rows),
        "rows_backwards": written(PLAIN, *rows[::-1]),
        "rows_of_bytes": written(PLAIN, "rows 0 5 uint8", "rows 5 8 uint16"),
        "padded_pixels": written(PLAIN, "pad 3", "rows 0 4 half", "rows 4 8 double"),
        "host_format": written(PLAIN, "rows 0 8 unknown"),
        "tiles": written(
            tiled,
            *(f"pixels {x} {y} float" for x, y in ((16, 16), (0, 16), (16, 0), (0, 0))),
        ),
        "tiled_image": written(tiled, "image half"),
        "whole_frame": written(whole, *rows[::-1]),
        "whole_frame_abandoned": [*whole, "open", *rows[:3], "drop"],
        "overscan": written(overscan, "rows -2 10 float"),
        "inside": written(inside, "rows 2 6 float"),
        "nothing_to_see": written([*PLAIN, "data 9 9", "full 0 0 8 8"]),
        "far_away": written(
            [*PLAIN, "data 2147483647 -2147483648", "full -9 9 8 8"], "rows 0 1 float"
        ),
        "missing_rows": written(PLAIN, "rows 0 3 float", "rows 4 8 float"),
        "row_twice": written(PLAIN, "rows 0 3 float", "rows 2 8 float"),
        "outside": written(PLAIN, "rows -2147483648 5 float"),
        "closed_at_once": written(PLAIN, "close"),
        "abandoned": [*PLAIN, "open", "rows 0 3 float"],
        "opened_twice": [*PLAIN, "open b.dng", *rows[:2], *written([], "image float")],
        "two_files": written(PLAIN) + ["open shot.0007.dng", "image uint8", "close"],
        "same_file_again": written(PLAIN) + written([], "image half"),
        "again_and_abandoned": [*written(PLAIN), "open", "rows 0 3 float", "drop"],
        "appended": [*PLAIN, "append", "image float", "close"],
        "deep": written([*PLAIN, "deep 1"]),
        "volume": written([*PLAIN, "depth 2"]),
        "no_pixels": written(["size 0 -1 3 float", SENSOR, LIGHT]),
        "too_wide": written(["size 70000 2 3 uint8", SENSOR, LIGHT]),
        "one_site": written(["size 1 1 3 float", SENSOR, LIGHT]),
        "name_too_long": [*PLAIN, f"open {'n' * 256}.dng"],
        "name_with_nul": [*PLAIN, "open a\0b.dng", "image float", "close"],
    }


def programs():
    """Return {name: text}."""
    plain = {
        "plain": written(PLAIN),
        "no_sensor": written(PLAIN[:1] + [LIGHT]),
        "no_light": written(PLAIN[:2]),
        "monochrome": written(
            [PLAIN[0], "attribute string dng:sensor tests/fuzz/profile/mono"]
        ),
        "x_trans": written(
            ["size 12 12 3 float", "attribute string dng:sensor fujifilm-x-m1", LIGHT]
        ),
    }
    all_of_them = plain | attributes() | spaces() | orders()
    return {name: "\n".join(lines) + "\n" for name, lines in all_of_them.items()}


def main(folder):
    """Write all seeds to a folder of folder."""
    write_seeds(folder, {"plugin": programs()})


if __name__ == "__main__":
    main(sys.argv[1])
