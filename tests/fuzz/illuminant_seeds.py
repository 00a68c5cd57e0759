# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Write the seeds of lights: python -m fuzz.illuminant_seeds FOLDER, in tests.

FOLDER/illuminant is made: words of the illuminant grammar, lists of them, and names of
RAW colour spaces of the sensors that fuzz_illuminant.cpp knows."""

import sys

from fuzz.seed_folders import write_seeds

WORDS = {
    "a": "A",
    "d55": "d55",
    "kelvin": "3200K",
    "kelvin_with_fraction": "2856.5k",
    "kelvin_at_its_end": "25000K",
    "xy": "xy:0.3457:0.3585",
    "xy_without_zeros": "XY:.3:.4",
    "xy_at_its_edge": "xy:1e-9:0.01",
    "neutral": "neutral:0.55:0.45",
    "neutral_with_exponent": "neutral:5e-1:1",
    "sample": "sample:7",
    "sample_with_exponent": "sample:1e1",
    "last_sample": "sample:2147483647",
    "measured": "measured:7",
    "as_shot": "as-shot",
    "fl2": "FL2",
    "led": "LED-B3",
    "led_alias": "led_b3",
    "hp": "HP1",
    "lamp_of_the_profile": "lamp:my-lamp",
    "lamp_alias": "my_lamp",
    "cie_lamp": "lamp:fl11",
    "lists": "A,D65,sample:0-9",
    "list_of_draws": "measured:3-5,FL2,xy:0.3:0.3",
    "longest_list": "sample:0-99999",
    "space": "RAW - fuzz - D65",
    "space_of_draws": "raw unbounded - fuzz-b - sample:7",
    "space_alias": "raw_fuzz_b_xy_0_3457_0_3585",
    "unbounded_alias": "raw_unbounded_a_b_c_3200k",
    # What is refused.
    "nothing": "",
    "unknown": "daylight",
    "below_the_locus": "1666K",
    "no_chromaticity": "xy:0.6:0.5",
    "no_number": "xy:nan:inf",
    "no_neutral": "neutral:0:1",
    "half_a_sample": "sample:1.5",
    "unknown_lamp": "lamp:x",
    "nameless_lamp": "lamp:",
    "hostile_bytes": "\u00e9\n\x1b[2J",
    "list_too_long": "sample:0-99999," * 3 + "A",
    "falling_list": "sample:9-0",
    "context": "raw_context",
    "space_of_no_sensor": "raw_other_d65",
    "space_of_no_light": "RAW - fuzz",
}


def main(folder):
    """Write all seeds to a folder of folder."""
    write_seeds(folder, {"illuminant": WORDS})


if __name__ == "__main__":
    main(sys.argv[1])
