# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The picture of a sensor: illuminants in the plane of R/G and B/G, sensitivities."""

import io
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from cg2raw import _core
from cg2raw.cfa import is_mono
from cg2raw.io.figure import BLACK, BLUE, GREEN, RED, SKY
from cg2raw.profile.spectral_file import Array
from cg2raw.profile.summary import kelvin_words

if TYPE_CHECKING:  # matplotlib takes its time
    from matplotlib.axes import Axes

SAMPLES = 200
LOCUS = np.linspace(1e6 / 15000, 1e6 / 2000, 400)  # mired: even steps of colour
TICKS = (2000, 2500, 3000, 3500, 4000, 5000, 6500, 8000, 10000, 15000)  # K
APART = 34  # pixels between labelled temperatures
MARGIN = 0.35  # of the data's extent, around it; the locus may leave the picture
CURVES = {"R": RED, "G": GREEN, "B": BLUE}
RESPONSE_TO = {"energy": "radiant energy", "photon": "a photon"}


def plot_png(profile: _core.SensorProfile, cct: Sequence[float] | None = None) -> bytes:
    """Return the PNG of a SensorProfile's illuminants; same profile, same bytes.

    Shows the neutrals, the ellipses of 1, 2 and 3 standard deviations of their
    Gaussian, their hull, samples, and the Planckian locus as the sensor sees it; below
    them the spectral sensitivities that the profile has. Of a monochrome sensor, which
    sees all lights alike, only those.
    cct : [lowest, highest] K of the neutrals, for the title.
    Raises ValueError for a monochrome sensor without them."""
    if is_mono(profile.cfa) and profile.spectral_sensitivities is None:
        raise ValueError(
            f"sensor {profile.id} is monochrome: it sees all illuminants alike, and "
            "there is nothing to draw; leave --plot out"
        )
    from matplotlib import style

    with style.context("default"):  # whatever the user's matplotlibrc says
        return drawing(profile, cct)


def drawing(profile: _core.SensorProfile, cct: Sequence[float] | None) -> bytes:
    """Return the PNG; arguments as above."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    heights = [] if is_mono(profile.cfa) else [6.5]
    if profile.spectral_sensitivities is not None:
        heights.append(3.5)
    figure = Figure(figsize=(8, sum(heights)), dpi=120, layout="constrained")
    FigureCanvasAgg(figure)
    rows = figure.subplots(len(heights), height_ratios=heights, squeeze=False)[:, 0]
    if profile.spectral_sensitivities is not None:
        draw_sensitivities(rows[-1], profile.spectral_sensitivities)
    if not is_mono(profile.cfa):
        draw_illuminants(rows[0], profile, cct)
    png = io.BytesIO()
    figure.savefig(png, format="png", metadata={"Software": None})
    return png.getvalue()


def draw_illuminants(
    axes: "Axes", profile: _core.SensorProfile, cct: Sequence[float] | None
) -> None:
    """Draw neutrals, samples and the locus in the plane of R/G and B/G."""
    samples = drawn(profile)
    draw_lights(axes, profile, samples)
    locus = draw_locus(axes, profile)
    set_limits(axes, profile, samples, locus)
    label_ticks(axes, profile)
    axes.set(xlabel="R/G of a neutral", ylabel="B/G of a neutral")
    axes.set_title(title(profile, cct), fontsize=11)
    axes.grid(color="0.9", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.legend(loc="upper right", fontsize=9, framealpha=0.9)


def title(profile: _core.SensorProfile, cct: Sequence[float] | None) -> str:
    """Return two lines: which sensor, and how much is known."""
    count = len(profile.illuminants["neutrals"])
    known = (
        f"{count} neutral{'s' * (count > 1)}"
        if count
        else "neutrals known by their distribution"
    )
    known = known if count or profile.illuminants["hull"] else "no neutrals"
    span = f", {kelvin_words(cct)}" if cct else ""
    camera = _core.camera_name(profile.make, profile.model)
    return f"{profile.id} ({camera})\n{known}{span}".replace("$", r"\$")


def drawn(profile: _core.SensorProfile) -> Array:
    """Return (n, 2) samples; none if the profile has nothing to draw from."""
    try:
        lights = [profile.illuminant(f"sample:{n}").neutral for n in range(SAMPLES)]
    except ValueError:
        return np.empty((0, 2))
    return np.array(lights)[:, [0, 2]]


def draw_lights(axes: "Axes", profile: _core.SensorProfile, samples: Array) -> None:
    """Draw hull, ellipses, neutrals and samples."""
    lights = profile.illuminants
    if len(samples):
        axes.scatter(
            samples[:, 0], samples[:, 1], s=14, marker="x", linewidth=0.8, color=SKY,
            zorder=2,
            label=f"sample:0 to sample:{SAMPLES - 1}",
        )  # fmt: skip
    if lights["hull"]:
        hull = np.array([*lights["hull"], lights["hull"][0]])
        axes.plot(*hull.T, color=GREEN, linewidth=1.5, zorder=3, label="convex hull")
        draw_ellipses(axes, lights)
    if lights["neutrals"]:
        neutrals = np.array(lights["neutrals"])
        axes.scatter(
            neutrals[:, 0], neutrals[:, 1],
            s=16 if len(lights["neutrals"]) > 9 else 50, color=BLUE, edgecolor="white",
            linewidth=0.4, zorder=5, label="neutrals",
        )  # fmt: skip


def draw_ellipses(axes: "Axes", lights: Mapping[str, Any]) -> None:
    """Draw the curves at 1, 2 and 3 standard deviations of the Gaussian."""
    values, vectors = np.linalg.eigh(lights["covariance"])
    turn = np.linspace(0, 2 * np.pi, 181)
    circle = np.stack([np.cos(turn), np.sin(turn)])
    shape = vectors * np.sqrt(np.maximum(values, 0))
    for sigmas in (1, 2, 3):
        ellipse = np.array(lights["mean"])[:, None] + sigmas * shape @ circle
        label = "Gaussian: 1, 2, 3 sd" if sigmas == 1 else None
        axes.plot(*ellipse, "--", color=RED, linewidth=1, zorder=4, label=label)
    axes.plot(*lights["mean"], "+", color=RED, markersize=11, zorder=6)


def neutral_at(profile: _core.SensorProfile, kelvin: float) -> tuple[float, float]:
    """Return (R/G, B/G) of a Planckian light, nan where the sensor does not see it."""
    try:
        neutral = profile.illuminant(f"{kelvin:.6f}K").neutral
    except ValueError:
        return (np.nan, np.nan)
    return neutral[0], neutral[2]


def draw_locus(axes: "Axes", profile: _core.SensorProfile) -> Array:
    """Draw the Planckian locus as this sensor sees it; return its (n, 2) points."""
    points = np.array([neutral_at(profile, 1e6 / mired) for mired in LOCUS])
    axes.plot(*points.T, color=BLACK, linewidth=1.3, zorder=4, label="Planckian locus")
    return points


def set_limits(
    axes: "Axes", profile: _core.SensorProfile, samples: Array, locus: Array
) -> None:
    """Frame what was measured and drawn; without either, the whole locus."""
    lights = profile.illuminants
    measured = [np.array(lights[k]) for k in ("neutrals", "hull") if lights[k]]
    points = np.concatenate([*measured, samples]) if measured else locus
    points = locus if len(points) < 3 else points
    points = points[np.isfinite(points).all(axis=1)]
    low, high = points.min(axis=0), points.max(axis=0)
    room = MARGIN * np.maximum(high - low, 0.05)
    axes.set_xlim(max(0, low[0] - room[0]), high[0] + room[0])
    axes.set_ylim(max(0, low[1] - room[1]), high[1] + room[1])


def label_ticks(axes: "Axes", profile: _core.SensorProfile) -> None:
    """Label temperatures on the locus where they are in the picture and apart."""
    axes.figure.canvas.draw()  # settles the layout, so that pixels can be compared
    box = axes.get_window_extent()
    last = None
    for kelvin in TICKS:
        at = neutral_at(profile, kelvin)
        pixel = axes.transData.transform(at)
        if not np.isfinite(pixel).all() or not box.contains(*pixel):
            continue
        if last is not None and np.hypot(*(pixel - last)) < APART:
            continue
        last = pixel
        label_tick(axes, at, kelvin, box.x1 - pixel[0] < 90, box.y1 - pixel[1] < 35)


def label_tick(
    axes: "Axes", at: tuple[float, float], kelvin: float, at_right: bool, at_top: bool
) -> None:
    """Draw one temperature; its words stay within the axes."""
    from matplotlib.patheffects import withStroke

    axes.plot(*at, "o", color=BLACK, markersize=5, zorder=7)
    axes.annotate(
        f"{kelvin} K",
        at,
        xytext=(-7 if at_right else 7, -14 if at_top or at_right else 6),
        textcoords="offset points",
        ha="right" if at_right else "left",
        fontsize=9,
        zorder=8,
        path_effects=[withStroke(linewidth=2.5, foreground="white")],
    )


def draw_sensitivities(axes: "Axes", sensitivities: Mapping[str, Any]) -> None:
    """Draw the curves of R, G and B, or the one of a monochrome sensor.

    sensitivities : SensorProfile.spectral_sensitivities."""
    rgb = np.array(sensitivities["rgb"])
    wavelengths = sensitivities["wavelengths"]
    if np.ptp(rgb, axis=1).any():
        for (name, color), curve in zip(CURVES.items(), rgb.T, strict=True):
            axes.plot(wavelengths, curve, color=color, linewidth=1.6, label=name)
        axes.legend(loc="upper right", fontsize=9, framealpha=0.9)
    else:
        axes.plot(wavelengths, rgb[:, 0], color="black", linewidth=1.6)
    axes.axhline(0.0, color="0.6", linewidth=0.6)
    axes.set(
        xlabel="wavelength, nm",
        ylabel=f"response to {RESPONSE_TO[sensitivities['unit']]}",
        xlim=(wavelengths[0], wavelengths[-1]),
    )
    axes.set_title("spectral sensitivities", fontsize=11)
    axes.grid(color="0.9", linewidth=0.6)
    axes.set_axisbelow(True)
