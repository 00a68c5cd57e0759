# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Words: what a finding means, in plain sentences with numbers."""

from collections.abc import Mapping, Sequence

import numpy as np

from cg2raw.diagnose.diagnosis import Estimate, Gap
from cg2raw.diagnose.effects.discriminating_captures import separation

Estimates = Mapping[str, Estimate]

TITLES = {
    "exposure": "the exposure",
    "white_balance": "the white balance",
    "color_matrix": "the colour matrix",
    "blur": "blur of the lens",
    "color_shading": "colour shading",
    "lateral_chromatic_aberration": "lateral chromatic aberration",
    "lens_shading": "lens shading",
    "veiling_glare": "veiling glare",
    "crosstalk": "crosstalk between pixels",
    "gr_gb_imbalance": "imbalance of the two greens",
    "prnu": "pixels of unequal gain (PRNU)",
    "dark_current": "dark current",
    "nonlinearity": "a response that is not linear",
    "shot_noise": "the gain of the shot noise",
    "photon_statistics": "photons that are counted (Poisson)",
    "early_clipping": "a full well below white",
    "read_noise": "the level of the read noise",
    "heavy_tailed_noise": "read noise with heavy tails",
    "row_noise": "row noise",
    "black_level": "the black level",
    "column_noise": "column noise",
    "dsnu": "pixels of unequal offset (DSNU)",
    "hot_pixels": "hot pixels",
    "noise_reduction": "noise reduction in the camera",
}

WHERE = {
    "exposure": "in proportion to signal, all channels alike",
    "white_balance": "in proportion to signal, in red and blue, greys too",
    "color_matrix": "grows with chroma, none on greys",
    "blur": "along edges, flats are clean",
    "color_shading": "with radius, red and blue unlike green",
    "lateral_chromatic_aberration": "along edges, red and blue shifted radially",
    "lens_shading": "falls off with radius, all channels, in proportion to signal",
    "veiling_glare": "dark regions lifted, with the mean of the scene",
    "crosstalk": "between neighbours of the mosaic, at edges and in coloured flats",
    "gr_gb_imbalance": "greens of red rows against greens of blue rows",
    "prnu": "the same pixels in all frames, in proportion to signal",
    "dark_current": "grows with exposure time, in darks too",
    "nonlinearity": "depends on the level alone",
    "shot_noise": "variance in proportion to signal",
    "photon_statistics": "lopsided noise at low levels",
    "early_clipping": "levels pile up below white",
    "read_noise": "variance in darks",
    "heavy_tailed_noise": "outliers in darks that do not repeat",
    "row_noise": "rows differ, anew in every frame",
    "black_level": "an offset per CFA site, whatever the light",
    "column_noise": "columns differ, the same in all frames",
    "dsnu": "the same pixels in all frames, whatever the light",
    "hot_pixels": "few pixels far above the others, with exposure time",
    "noise_reduction": "neighbours of one colour share their noise",
}


def title(name: str) -> str:
    """Return an effect's plain name."""
    return TITLES.get(name, name.replace("_", " "))


def where(name: str) -> str:
    """Return where an effect shows in the residuals."""
    return WHERE.get(name, "")


def sentence(name: str, values: Estimates, gap: Gap) -> str:
    """Return one sentence of what was found, and what adding it does."""
    size = _SIZES.get(name, _largest)(values)
    return (
        f"{title(name).capitalize()}: {size}; with all that was found, held-out "
        f"chi-square goes from {gap.chi2_before:.4g} to {gap.chi2_after:.4g}."
    )


def deciding_captures(name: str, others: Sequence[str]) -> list[str]:
    """Return what to capture to tell an effect from those that look alike."""
    return [
        f"To tell {title(name)} from {title(other)}: {separation(name, other)}"
        for other in others
    ]


def _value(values: Estimates, name: str) -> float:
    return values[name].value if name in values else 0.0


def _percent(x: float) -> str:
    return f"{100 * x:.3g} %"


def _largest(values: Estimates) -> str:
    parts = (
        f"{name} {e.value:.4g} ({e.ci95[0]:.4g} to {e.ci95[1]:.4g})"
        for name, e in values.items()
    )
    return ", ".join(parts)


def corner_loss(values: Estimates) -> float:
    """Return the largest loss of light in a corner of a 3:2 frame, relative."""
    r2, r4, r6, *tilts = (
        _value(values, n)
        for n in ("r2", "r4", "r6", "tilt_x", "tilt_y", "tilt_x_r2", "tilt_y_r2")
    )
    x, y, x2, y2 = tilts
    corners = [
        1 + r2 + r4 + r6 + u * (x + x2) + v * (y + y2)
        for u in (-0.832, 0.832)
        for v in (-0.555, 0.555)
    ]
    return 1 - min(corners)


def _lens_shading(values: Estimates) -> str:
    loss = corner_loss(values)
    verb = "loses" if loss >= 0 else "gains"
    return f"the lens {verb} {_percent(abs(loss))} at the darkest corner"


def _times(values: Estimates) -> str:
    (estimate,) = values.values()
    return (
        f"variance is {np.exp(estimate.value):.4g} times the profile's "
        f"({np.exp(estimate.ci95[0]):.4g} to {np.exp(estimate.ci95[1]):.4g})"
    )


def _exposure(values: Estimates) -> str:
    gain = _value(values, "gain")
    return f"everything is {_percent(abs(gain))} {'brighter' if gain > 0 else 'darker'}"


def _white_balance(values: Estimates) -> str:
    return (
        f"red is {_value(values, 'red'):+.2%} and blue {_value(values, 'blue'):+.2%} "
        "of what the model says"
    )


def _sigma(values: Estimates) -> str:
    return f"standard deviation {_value(values, 'sigma'):.4g} of white"


def _clipping(values: Estimates) -> str:
    return f"charge clips {_percent(_value(values, 'below_white'))} below white"


def _hot(values: Estimates) -> str:
    return f"{_percent(_value(values, 'fraction'))} of the pixels are hot"


def _glare(values: Estimates) -> str:
    total = _value(values, "uniform") + _value(values, "wide")
    return f"{_percent(total)} of the light is spread over the frame"


def _crosstalk(values: Estimates) -> str:
    total = sum(e.value for e in values.values())
    return f"a pixel loses {_percent(total)} of its signal to its neighbours"


def _blur(values: Estimates) -> str:
    rings = [_value(values, f"ring_{n}") for n in range(1, 11)]
    half = 1 + sum(a * (np.cos(n * np.pi / 2) - 1) for n, a in enumerate(rings, 1))
    return f"contrast at half the Nyquist frequency is {_percent(half)}"


def _aberration(values: Estimates) -> str:
    red = _value(values, "red") + _value(values, "red_r2")
    blue = _value(values, "blue") + _value(values, "blue_r2")
    return f"red is moved {red:.3g} px and blue {blue:.3g} px at the corner"


def _nonlinearity(values: Estimates) -> str:
    loss = _value(values, "quadratic") + _value(values, "cubic")
    return f"white reads {_percent(abs(loss))} too {'low' if loss > 0 else 'high'}"


_SIZES = {
    "lens_shading": _lens_shading,
    "shot_noise": _times,
    "read_noise": _times,
    "exposure": _exposure,
    "white_balance": _white_balance,
    "prnu": _sigma,
    "dsnu": _sigma,
    "column_noise": _sigma,
    "row_noise": _sigma,
    "early_clipping": _clipping,
    "hot_pixels": _hot,
    "veiling_glare": _glare,
    "crosstalk": _crosstalk,
    "blur": _blur,
    "lateral_chromatic_aberration": _aberration,
    "nonlinearity": _nonlinearity,
}
