# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Five cameras of measured noise, one more of measured neutrals, two real DNGs.

"sample": see cameras_paper.py. Left out, since a matrix of another camera would be
false:

- Google Pixel 6 and 9 Pro, Samsung Galaxy S22 Ultra, S20 Ultra: their noise is
  published (SamsungLabs modular_neural_isp), a colour matrix of theirs is not.
- The phones of SIDD (Noise Flow) and the OPPO of PMRID: noise alone as well.
- Canon EOS-1D: its Gehler-Shi neutrals lie 20 % off the locus of its only matrix.
- Canon EOS 550D: the tags of its DNG contradict the pixels, and Cube++ mixes bodies.
- GoPro Fusion: its DNG repeats the HERO6's matrices digit for digit and halves its
  NoiseProfile exactly, so neither was calibrated for it.
"""

CAMERAS = {
    "canon-5d": {
        "title": "Canon EOS 5D",
        "rawspeed": ("Canon EOS 5D", ""),
        "rawler": "Canon EOS 5D",
        "active_area": (90, 34, 4386, 2920),
        "bits": 12,
        "black_level": 128,
        "white_level": 3692,
        "neutrals": ("gehler_shi_illuminants.csv", "Canon EOS 5D"),
        "sensitivities": "Canon_EOS_5D",
        "sources": {
            "width, height": "RawSpeed's crop (90, 34) 4386 x 2920 of dnglab's sample "
            "(rawler/data/testdata): raw 4476 x 2954",
            "bits": "12-bit CR2",
            "black_level": "dnglab's sample at ISO 400; RawSpeed's table has 127",
            "white_level": "RawSpeed's and rawler's tables and dnglab's sample",
        },
    },
    "canon-5d-mark-iv": {
        "title": "Canon EOS 5D Mark IV",
        "rawspeed": ("Canon EOS 5D Mark IV", ""),
        "rawler": "Canon EOS 5D Mark IV",
        "active_area": (136, 42, 6744, 4502),
        "bits": 14,
        "black_level": 512,
        "white_level": 16383,
        "noise": ("eld", "CanonEOS5D4"),
        "sensitivities": "Canon_EOS_5D_Mark_IV",
        "sources": {
            "width, height": "dnglab's sample (rawler/data/testdata): active area "
            "(136, 42) 6744 x 4502 of raw 6880 x 4544; RawSpeed begins at (136, 44)",
            "bits": "14-bit CR2",
            "black_level": "dnglab's sample at ISO 100: 511 and 512 by column",
            "white_level": "RawTherapee's camconst: 16383 nominal at the full stops; "
            "the noise was measured on such 14-bit values",
        },
    },
    "canon-70d": {
        "title": "Canon EOS 70D",
        "rawspeed": ("Canon EOS 70D", ""),
        "rawler": "Canon EOS 70D",
        "active_area": (72, 38, 5496, 3670),
        "bits": 14,
        "black_level": 2049,
        "white_level": 15303,
        "noise": ("eld", "CanonEOS70D"),
        "sources": {
            "width, height": "RawSpeed's and rawler's active area, 72 columns and 38 "
            "rows in, of dnglab's sample (rawler/data/testdata): raw 5568 x 3708",
            "bits": "14-bit CR2",
            "black_level": "dnglab's sample at ISO 100",
            "white_level": "LibRaw's maximum 0x3bc7; RawTherapee's camconst: 15303 "
            "typical at the full stops from ISO 200 (13583 at ISO 100); the noise was "
            "measured on such 14-bit values",
        },
    },
    "canon-700d": {
        "title": "Canon EOS 700D",
        "rawspeed": ("Canon EOS 700D", ""),
        "rawler": "Canon EOS 700D",
        "active_area": (72, 52, 5208, 3476),
        "bits": 14,
        "black_level": 2047,
        "white_level": 15303,
        "noise": ("eld", "CanonEOS700D"),
        "sources": {
            "width, height": "dnglab's sample (rawler/data/testdata): active area (72, "
            "52) 5208 x 3476 of raw 5280 x 3528; RawSpeed begins at (76, 60)",
            "bits": "14-bit CR2",
            "black_level": "dnglab's sample at ISO 200",
            "white_level": "RawTherapee's camconst: 15303 typical at the full stops "
            "from ISO 200 (13583 at ISO 100); LibRaw's maximum is 0x3c00; the noise "
            "was measured on such 14-bit values",
        },
    },
    "nikon-d850": {
        "title": "Nikon D850",
        "rawspeed": ("NIKON D850", "14bit-compressed"),
        "rawler": "NIKON D850",
        "active_area": (0, 0, 8288, 5520),
        "bits": 14,
        "black_level": 400,
        "white_level": 15520,
        "noise": ("eld", "NikonD850"),
        "noise_note": "; calibrated twice, of which the first is taken up to ISO 800 "
        "and the second above",
        "sensitivities": "Nikon_D850",
        "sources": {
            "width, height": "dnglab's sample (rawler/data/testdata): raw 8288 x 5520, "
            "all of it active in RawSpeed and rawler",
            "bits": "14-bit NEF",
            "black_level": "RawSpeed's table and dnglab's sample",
            "white_level": "RawSpeed's table and dnglab's sample; RawTherapee's "
            "camconst finds saturation at 16145 (G) and 16383 (R, B) up to ISO 320 and "
            "takes 15700 at ISO 6400; the noise was measured on such 14-bit values",
        },
    },
    "sony-a7s-ii": {
        "title": "Sony A7S II",
        "rawspeed": ("ILCE-7SM2", ""),
        "rawler": "ILCE-7SM2",
        "active_area": (0, 0, 4256, 2848),
        "bits": 14,
        "black_level": 512,
        "white_level": 16300,
        "noise": ("eld", "SonyA7S2"),
        "sensitivities": "Sony_ILCE-7SM2",
        "sources": {
            "width, height": "dnglab's sample (rawler/data/testdata): raw 4288 x 2848 "
            "less the 32 columns that RawSpeed cuts from the right",
            "bits": "the 14-bit scale of its ARW, compressed or not",
            "black_level": "RawSpeed's table, RawTherapee's camconst and dnglab's "
            "sample",
            "white_level": "RawSpeed's table and RawTherapee's camconst; dnglab's "
            "sample's 15360 is a margin; the noise was measured on such 14-bit values",
        },
    },
    "gopro-hero6-black": {
        "dng": "Hero6_GOPR0024.dng",
        "sources": {
            "make, model, unique_camera_model, cfa, width, height, bits, black_level, "
            "white_level, calibration_illuminant_1, color_matrix_1, "
            "calibration_illuminant_2, color_matrix_2": "a DNG of the "
            "camera (gopro/gpr, GOPR0024), as cg2raw reads it",
            "noise": "NoiseProfile of that DNG, at its ISO 100 alone; read noise "
            "included",
            "effects": "the polynomial of lens_shading that fits the GainMaps of that "
            "DNG; what it leaves of their brightness is among its evidence",
        },
    },
    "blackmagic-pocket": {
        "dng": "bmpcc_twelvemonkeys.dng",
        "sources": {
            "make, model": "the words of UniqueCameraModel: the DNG has neither tag",
            "unique_camera_model, cfa, width, height, calibration_illuminant_1, "
            "color_matrix_1, calibration_illuminant_2, color_matrix_2": "a "
            "DNG of the camera (haraldk/TwelveMonkeys), as cg2raw reads it",
            "bits, black_level, white_level": "the same DNG; these are of the values "
            "behind its LinearizationTable, on which BlackLevel and WhiteLevel are "
            "stated",
        },
    },
}
