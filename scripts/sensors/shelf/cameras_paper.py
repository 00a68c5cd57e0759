# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The ten cameras of Graphics2RAW (ICCV 2023): nine of the NUS set, and a phone.

"sample" in a source is dnglab's published analysis of one real raw file of that camera
(dnglab/dnglab, rawler/data/testdata): raw size, borders and levels as decoded.
"""

NUS = "nus9_gt_illuminants.csv"

CAMERAS = {
    "canon-1ds-mark-iii": {
        "title": "Canon EOS-1Ds Mark III",
        "rawspeed": ("Canon EOS-1Ds Mark III", ""),
        "rawler": "Canon EOS-1Ds Mark III",
        "active_area": (62, 20, 5640, 3752),
        "bits": 14,
        "black_level": 1024,
        "white_level": 15280,
        "matrices": "NUS_CST_mats/Canon1DsMkIII",
        "neutrals": (NUS, "Canon1DsMkIII"),
        "sensitivities": "Canon_EOS-1Ds_Mark_III",
        "sources": {
            "width, height": "RawSpeed's crop (62, 20) 5640 x 3752 of dnglab's sample "
            "(rawler/data/testdata): raw 5712 x 3774",
            "bits": "14-bit CR2",
            "black_level": "dnglab's sample at ISO 100: 1023 and 1024 by column",
            "white_level": "LibRaw's maximum 0x3bb0; the NUS set has 15279",
        },
    },
    "canon-600d": {
        "title": "Canon EOS 600D",
        "rawspeed": ("Canon EOS 600D", ""),
        "rawler": "Canon EOS 600D",
        "active_area": (142, 51, 5202, 3465),
        "bits": 14,
        "black_level": 2048,
        "white_level": 15303,
        "matrices": "NUS_CST_mats/Canon600D",
        "neutrals": (NUS, "Canon600D"),
        "sensitivities": "Canon_EOS_600D",
        "sources": {
            "width, height": "rawler's active area, 142 columns and 51 rows in, of "
            "dnglab's sample (rawler/data/testdata): raw 5344 x 3516; RawSpeed begins "
            "at (146, 54)",
            "bits": "14-bit CR2",
            "black_level": "dnglab's sample at ISO 200: 2047 and 2048 by row",
            "white_level": "RawTherapee's camconst: 15303 typical at the full stops "
            "from ISO 200 (13583 at ISO 100, LibRaw's 0x3510); the NUS set has 15303",
        },
    },
    "fujifilm-x-m1": {
        "title": "Fujifilm X-M1",
        "rawspeed": ("X-M1", ""),
        "rawler": "X-M1",
        "active_area": (0, 0, 4952, 3288),
        "bits": 12,
        "black_level": 256,
        "white_level": 4094,
        "matrices": "NUS_CST_mats/FujifilmXM1",
        "neutrals": (NUS, "FujifilmXM1"),
        "sources": {
            "width, height": "dnglab's sample (rawler/data/testdata): raw 5120 x 3288 "
            "less the 168 columns that RawSpeed and rawler cut from the right",
            "bits": "12 significant bits: RawSpeed's and rawler's white of 4094",
            "black_level": "RawSpeed's table; dnglab's sample at ISO 200 has 255",
            "white_level": "RawSpeed's and rawler's tables; the NUS set has 4079",
        },
    },
    "nikon-d40": {
        "title": "Nikon D40",
        "rawspeed": ("NIKON D40", "12bit-compressed"),
        "rawler": "NIKON D40",
        "active_area": (0, 0, 3038, 2014),
        "bits": 12,
        "black_level": 0,
        "white_level": 3880,
        "matrices": "NUS_CST_mats/NikonD40",
        "neutrals": (NUS, "NikonD40"),
        "sources": {
            "width, height": "RawSpeed's crop (0, 0) 3038 x 2014; dnglab's sample "
            "(rawler/data/testdata): raw is 3040 x 2014",
            "bits": "12-bit NEF",
            "black_level": "RawSpeed's table and dnglab's sample",
            "white_level": "RawSpeed's table and dnglab's sample; the NUS set has 3981",
        },
    },
    "nikon-d5200": {
        "title": "Nikon D5200",
        "rawspeed": ("NIKON D5200", "14bit-compressed"),
        "rawler": "NIKON D5200",
        "active_area": (0, 0, 6036, 4020),
        "bits": 14,
        "black_level": 0,
        "white_level": 15892,
        "matrices": "NUS_CST_mats/NikonD5200",
        "neutrals": (NUS, "NikonD5200"),
        "sources": {
            "width, height": "dnglab's sample (rawler/data/testdata): raw 6036 x 4020, "
            "all of it active in RawSpeed and rawler",
            "bits": "14-bit NEF",
            "black_level": "RawSpeed's table and dnglab's sample",
            "white_level": "RawSpeed's table, dnglab's sample and the NUS set",
        },
    },
    "olympus-e-pl6": {
        "title": "Olympus E-PL6",
        "rawspeed": ("E-PL6", ""),
        "rawler": "E-PL6",
        "active_area": (0, 0, 4640, 3472),
        "bits": 12,
        "black_level": 255,
        "white_level": 4000,
        "matrices": "NUS_CST_mats/OlympusEPL6",
        "neutrals": (NUS, "OlympusEPL6"),
        "sources": {
            "width, height": "dnglab's sample (rawler/data/testdata): raw 4640 x 3472, "
            "all of it active in rawler; RawSpeed cuts 8 columns and rows from the "
            "left and top, 24 and 8 from the right and bottom",
            "bits": "12-bit ORF",
            "black_level": "dnglab's sample at ISO 200: 255; RawSpeed's 0 stands for "
            "the value in each file",
            "white_level": "rawler's table; RawSpeed has 4095, of which it takes the "
            "file's black, and the NUS set 4043",
        },
    },
    "panasonic-gx1": {
        "title": "Panasonic GX1",
        "rawspeed": ("DMC-GX1", ""),
        "rawler": "DMC-GX1",
        "active_area": (8, 8, 4592, 3448),
        "bits": 12,
        "black_level": 143,
        "white_level": 3956,
        "matrices": "NUS_CST_mats/PanasonicGX1",
        "neutrals": (NUS, "PanasonicGX1"),
        "sources": {
            "width, height": "the published size of its 4:3 pictures, 8 columns and "
            "rows in as in dnglab's sample; that one is 3:2 (raw 4760 x 3072), so the "
            "raw size of 4:3 is not known here",
            "bits": "12-bit RW2",
            "black_level": "128 in dnglab's sample's tags plus Panasonic's offset of "
            "15 (LibRaw's table: -15); RawSpeed's table has 150",
            "white_level": "RawSpeed's and rawler's tables; the NUS set has 4095",
        },
    },
    "samsung-nx2000": {
        "title": "Samsung NX2000",
        "rawspeed": ("NX2000", ""),
        "rawler": "NX2000",
        "active_area": (0, 0, 5536, 3696),
        "bits": 12,
        "black_level": 0,
        "white_level": 4095,
        "matrices": "NUS_CST_mats/SamsungNX2000",
        "neutrals": (NUS, "SamsungNX2000"),
        "sources": {
            "width, height": "dnglab's sample (rawler/data/testdata): raw 5536 x 3714 "
            "less the 18 rows that rawler cuts from the bottom; RawSpeed keeps 5480 x "
            "3660 at (45, 25)",
            "bits": "12-bit SRW",
            "black_level": "RawSpeed's table and dnglab's sample",
            "white_level": "RawSpeed's and rawler's tables, dnglab's sample and the "
            "NUS set",
        },
    },
    "sony-a57": {
        "title": "Sony A57",
        "rawspeed": ("SLT-A57", ""),
        "rawler": "SLT-A57",
        "active_area": (0, 0, 4928, 3276),
        "bits": 14,
        "black_level": 512,
        "white_level": 16372,
        "matrices": "NUS_CST_mats/SonyA57",
        "neutrals": (NUS, "SonyA57"),
        "sources": {
            "width, height": "dnglab's sample (rawler/data/testdata): raw 4928 x 3276, "
            "all of it active in RawSpeed and rawler",
            "bits": "the 14-bit scale to which ARW's 12-bit samples are decoded",
            "black_level": "RawSpeed's table and dnglab's sample",
            "white_level": "the NUS set's 4093 of 12 bits, times 4; RawSpeed's 16596 "
            "exceeds 14 bits, and dnglab's sample's 15360 is a margin",
        },
    },
    "samsung-s20fe": {
        "title": "Samsung Galaxy S20 FE",
        "identity": ("samsung", "SM-G780F", "SM-G780F-samsung-samsung"),
        "cfa": "GRBG",
        "active_area": (0, 0, 4032, 3024),
        "bits": 10,
        "black_level": 64,
        "white_level": 1023,
        "matrices": "NUS_S20FE_CST_mats/7",
        "neutrals": ("samsung_s20fe_night_greycard_105.csv", None),
        "digital_gain": {"mean": 0.8, "sigma": 0.1},
        "noise": ("samsung", "h-gauss-s20-v1"),
        "sources": {
            "make, model, unique_camera_model": "Galaxy S20 FE 4G as Android's DNG "
            "writer names it (MODEL-MANUFACTURER-BRAND); which variant was measured is "
            "not public",
            "cfa, bits, black_level, white_level": "SamsungLabs graphics2raw and "
            "modular_neural_isp: S20 FE main camera, GRBG, black 64, white 1023",
            "width, height": "Galaxy S20 FE, main camera, 12 MP raw size",
            "calibration_illuminant_1, color_matrix_1": "SamsungLabs graphics2raw "
            "(ICCV 2023), table of ten D65 matrices, index 7; the table has none for "
            "A, so this profile has one matrix and nothing is interpolated",
            "digital_gain": "SamsungLabs graphics2raw, option --rgb_gain: N(0.8, 0.1)",
            "noise": "SamsungLabs modular_neural_isp, model h-gauss-s20-v1, ISO "
            "100-3200, var = b1 DN + b2 with DN including black 64; beta1 = b1 / 959, "
            "beta2 = max(0, 64 b1 + b2) / 959^2; sites in raster order of GRBG. ISO 50 "
            "is not in the table: it is extrapolated by one stop",
        },
    },
}
