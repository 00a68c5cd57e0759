# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Print how well drawn illuminants cover the real ones of the nine NUS cameras.

Each camera's neutrals are split in halves at random, many times; the models are fitted
to one half and judged on the other: by the angle from each held-out neutral to the
nearest of 50 draws, and by the likelihood of the held-out neutral. The same input
prints the same tables."""

import argparse
import csv
import sys
from pathlib import Path

import numpy as np

from cg2raw.profile.neutral_mixture import mixture_of
from studies.illuminants.mixture import SensorMixture
from studies.illuminants.models import DRAWS, MODELS, fitted_models, halves

NEUTRALS = Path("tables") / "illuminants" / "nus9_gt_illuminants.csv"
SPLITS = 100
MIXTURE_SPLITS = 20
# A uniform density that every model is mixed with, so that no likelihood is 0: how
# much of it, and where it lies in R/G and in B/G.
BACKGROUND, LOWEST, HIGHEST = 0.01, 0.05, 2.0
OTHER_BACKGROUNDS = (0.0001, 0.001, 0.1)


def neutrals_by_camera(path):
    """{camera: (N, 2) R/G and B/G} of the table of grey cards."""
    found = {}
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            r, g, b = (float(row[channel]) for channel in "rgb")
            found.setdefault(row["camera"], []).append((r / g, b / g))
    return {camera: np.array(rows) for camera, rows in found.items()}


def directions(neutrals):
    """(N, 3) unit vectors along (R/G, 1, B/G)."""
    rgb = np.insert(neutrals, 1, 1.0, axis=1)
    return rgb / np.linalg.norm(rgb, axis=1, keepdims=True)


def nearest_angle(neutrals, draws):
    """(N,) degrees from each neutral to the nearest of the draws."""
    cosine = (directions(neutrals) @ directions(draws).T).max(axis=1)
    return np.degrees(np.arccos(np.minimum(cosine, 1.0)))


def log_likelihood(density, background=BACKGROUND):
    """Nats of a density mixed with the uniform background."""
    uniform = 1.0 / (HIGHEST - LOWEST) ** 2
    return np.log((1.0 - background) * density + background * uniform)


def measured(neutrals, camera, number, splits=SPLITS):
    """(angle, density), each (splits, 3 models, N): NaN where a neutral was fitted."""
    angle = np.full((splits, len(MODELS), len(neutrals)), np.nan)
    density = angle.copy()
    for split in range(splits):
        fitted, held = halves(neutrals, number, split)
        models = fitted_models(neutrals[fitted], camera, number)
        for i, model in enumerate(models):
            draws = model.draws(DRAWS, split)
            angle[split, i, held] = nearest_angle(neutrals[held], draws)
            density[split, i, held] = model.density(neutrals[held])
    return angle, density


def mixture_gains(neutrals, camera, number, splits=MIXTURE_SPLITS):
    """(splits, N) nats that a mixture gains over the Gaussian; NaN if fitted."""
    found = np.full((splits, len(neutrals)), np.nan)
    for split in range(splits):
        fitted, held = halves(neutrals, number, split)
        several = SensorMixture(neutrals[fitted], camera)
        models = (several, several.one)
        mixed, one = (log_likelihood(m.density(neutrals[held])) for m in models)
        found[split, held] = mixed - one
    return found


def lead(gain):
    """(mean, standard error) of (splits, N) gains, NaN where not held out.

    The error is over neutrals, each with its mean over the splits: it says how much
    hangs on which lights happened to be photographed."""
    of_each = np.nanmean(gain, axis=0)
    return np.nanmean(gain), of_each.std(ddof=1) / np.sqrt(len(of_each))


def scores(gain):
    """Cells of one camera from (splits, 3 models, N) scores of which more is better.

    cg2raw's lead over either UPI with its standard error, and the part of the splits
    in which cg2raw's mean is better than both."""
    leads = [lead(gain[:, 0] - gain[:, i]) for i in (1, 2)]
    of_split = np.nanmean(gain, axis=2)
    won = (of_split[:, :1] > of_split[:, 1:]).all(axis=1).mean()
    return [f"{mean:.2f} ({error:.2f})" for mean, error in leads] + [f"{won:.0%}"]


def markdown(head, rows):
    """A table: text to the left, numbers to the right."""
    lines = [head, ["---"] + ["---:"] * (len(head) - 1), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


LEADS = ["lead over gains (SE)", "lead over box (SE)", "splits won"]


def angle_table(results):
    """Markdown of the angles, a row per camera."""
    rows = []
    for camera, (angle, _) in results.items():
        means = [f"{mean:.2f}" for mean in np.nanmean(angle, axis=(0, 2))]
        rows.append([camera, str(angle.shape[2]), *means, *scores(-angle)])
    return markdown(["camera", "neutrals", *MODELS, *LEADS], rows)


def likelihood_table(results):
    """Markdown of the log-likelihoods and of what lies outside, a row per camera."""
    rows = []
    for camera, (_, density) in results.items():
        log = log_likelihood(density)
        means = [f"{mean:.2f}" for mean in np.nanmean(log, axis=(0, 2))]
        outside = np.nanmean(np.where(np.isnan(density), np.nan, density == 0), (0, 2))
        rows.append([camera, *means, *scores(log), *(f"{o:.0%}" for o in outside)])
    return markdown(
        ["camera", *MODELS, *LEADS, *(f"outside: {model}" for model in MODELS)], rows
    )


def background_table(results):
    """Markdown of the leads over UPI's box, by the weight of the background."""
    rows = []
    for background in sorted((*OTHER_BACKGROUNDS, BACKGROUND)):
        leads = {}
        for camera, (_, density) in results.items():
            log = log_likelihood(density, background)
            leads[camera] = lead(log[:, 0] - log[:, 2])
        worst = min(leads, key=leads.get)
        mean, error = leads[worst]
        ahead = sum(mean > 0.0 for mean, _ in leads.values())
        cells = [f"{ahead} of {len(leads)}", worst, f"{mean:.2f} ({error:.2f})"]
        rows.append([f"{background:.2%}", *cells])
    return markdown(
        ["background", "cameras ahead of the box", "least ahead", "lead (SE)"], rows
    )


def mixture_table(cameras):
    """Markdown of what a mixture gains over the Gaussian, a row per camera."""
    rows = []
    for number, (camera, neutrals) in enumerate(cameras.items()):
        gain = mixture_gains(neutrals, camera, number)
        mean, error = lead(gain)
        won = (np.nanmean(gain, axis=1) > 0.0).mean()
        cells = [f"{mean:.2f} ({error:.2f})", f"{won:.0%}"]
        rows.append([camera, str(len(mixture_of(neutrals))), *cells])
    return markdown(["camera", "Gaussians", "gain (SE)", "splits won"], rows)


def report(results, cameras):
    """The four tables with their captions."""
    return "\n\n".join(
        [
            f"Angle from a held-out neutral to the nearest of {DRAWS} draws, degrees, "
            f"mean over {SPLITS} splits; less is better:",
            angle_table(results),
            "Log-likelihood of a held-out neutral, nats, each model mixed with "
            f"{BACKGROUND:.0%} of a uniform background; more is better:",
            likelihood_table(results),
            "The same with another weight of the background:",
            background_table(results),
            "What `measured:n` of a mixture gains in log-likelihood over `sample:n`, "
            f"nats, {MIXTURE_SPLITS} splits:",
            mixture_table(cameras),
        ]
    )


def arguments():
    """The command line."""
    parser = argparse.ArgumentParser(
        prog="illuminant_study", description=__doc__.splitlines()[0]
    )
    parser.add_argument(
        "--data", type=Path, required=True, help=f"folder that holds {NEUTRALS}"
    )
    parser.add_argument("--figure", type=Path, help="write the figure there, a PNG")
    return parser.parse_args()


def main():
    """Run the command; one line on stderr and exit 1 for a table that is missing."""
    given = arguments()
    try:
        cameras = neutrals_by_camera(given.data / NEUTRALS)
    except OSError as error:
        print(
            f"illuminants: {error.filename}: {error.strerror}; --data must name "
            f"the folder that holds {NEUTRALS}",
            file=sys.stderr,
        )
        return 1
    cameras = dict(sorted(cameras.items()))
    results = {
        camera: measured(neutrals, camera, number)
        for number, (camera, neutrals) in enumerate(cameras.items())
    }
    print(report(results, cameras))
    if given.figure:
        from studies.illuminants.figure import write_figure

        write_figure(given.figure, cameras)
    return 0


if __name__ == "__main__":
    sys.exit(main())
