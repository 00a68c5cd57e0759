# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""What tells two effects apart: the frames in which they differ."""

from collections.abc import Iterable

# Effects by what they change.
GAINS = {"exposure", "lens_shading", "nonlinearity", "early_clipping"}
MIXERS = {"crosstalk", "color_matrix", "white_balance"}
SOFTENERS = {"blur", "noise_reduction", "crosstalk"}
OFFSETS = {"black_level", "dark_current", "veiling_glare"}
NOISES = {
    "shot_noise",
    "read_noise",
    "row_noise",
    "heavy_tailed_noise",
    "photon_statistics",
}
MAPS = {"prnu", "dsnu", "column_noise", "hot_pixels"}

# The first row that holds both effects decides; the most particular ones stand first.
ROWS: tuple[tuple[set[str], str], ...] = (
    (
        {"lens_shading", "color_shading"},
        "Flats: shading that differs between red, green and blue is colour shading.",
    ),
    (
        {"prnu", "shot_noise"},
        "Several flats of one level: PRNU repeats in every frame and its variance "
        "grows with the square of the signal, that of shot noise with the signal.",
    ),
    (
        {"dsnu", "read_noise"},
        "Several darks of one exposure time: DSNU repeats in every frame.",
    ),
    (
        {"hot_pixels", "heavy_tailed_noise"},
        "Several darks: hot pixels are the same ones in each and grow with exposure "
        "time; the tails of read noise fall on other pixels each time.",
    ),
    (
        {"dsnu", "prnu"},
        "Darks and flats: DSNU is there without light, PRNU is in proportion to it.",
    ),
    (
        {"gr_gb_imbalance", "crosstalk"},
        "Scenes with coloured edges: crosstalk follows the neighbours' signal, a Gr/Gb "
        "imbalance does not.",
    ),
    (
        {"veiling_glare", "lens_shading"},
        "Flats at two levels and a scene with a bright area: glare adds to dark "
        "regions what the bright ones give, shading multiplies.",
    ),
    (
        {"exposure", "white_balance", "gr_gb_imbalance"},
        "A flat under a known light: exposure moves all colours alike.",
    ),
    (
        {"exposure", "veiling_glare", "black_level"},
        "A dark, and flats at two levels: a gain grows with the signal, an offset does "
        "not.",
    ),
    (
        GAINS,
        "Flats at three or more levels: level and radius are then told apart, and so "
        "are a gain, a curve and a clip.",
    ),
    (
        MIXERS,
        "A chart with greys and saturated patches beside flats: white balance shows on "
        "greys, a colour matrix on saturated patches alone, crosstalk at edges too.",
    ),
    (
        SOFTENERS,
        "Flats and darks: noise reduction correlates the noise of neighbours, blur "
        "leaves it white, crosstalk also desaturates flats.",
    ),
    (
        {"lateral_chromatic_aberration", "blur"},
        "Edges near the corners: lateral chromatic aberration moves red and blue in "
        "opposite ways and vanishes at the centre.",
    ),
    (
        OFFSETS,
        "Darks of two exposure times: dark current grows with time, a black level does "
        "not, and glare is absent without light.",
    ),
    (
        {"row_noise", "column_noise", "read_noise"},
        "Several darks: row noise is new in each, column noise repeats, read noise has "
        "no direction.",
    ),
    (
        NOISES,
        "Darks, and flats from dim to bright: each noise grows with the signal in its "
        "own way.",
    ),
    (
        NOISES | MAPS,
        "Repeated frames: a fixed pattern repeats, noise does not.",
    ),
)
REPEATS = (
    "Repeated frames of one scene: what repeats is an error of the mean, what does not "
    "is noise."
)
GENERAL = "Flats at three levels, darks of two exposure times and two further scenes."


def separation(first: str, second: str) -> str:
    """Return a sentence: the frames in which two effects differ."""
    for effects, sentence in ROWS:
        if {first, second} <= effects:
            return sentence
    is_noise = [name in NOISES for name in (first, second)]
    return REPEATS if any(is_noise) else GENERAL


def known_effects() -> Iterable[str]:
    """Return every name that a row knows, sorted."""
    return sorted(set().union(*(effects for effects, _ in ROWS)))
