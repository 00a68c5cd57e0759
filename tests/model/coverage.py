# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""How often 95 % intervals hold what was planted, figure by figure.

From tests/, for the table of docs/calibrate.md's section on intervals:

    python -m model.coverage 400 --low --noise 0.25 0.35 0.5 1 3 --black 64 0"""

import argparse
from collections import defaultdict
from itertools import product

import numpy as np

from cg2raw.model.figures import figures_of
from cg2raw.model.fit import fit
from model.planted import planted


def misses(seeds, **options):
    """Return {figure: [(is inside its interval, standard errors off), ...]}."""
    found = defaultdict(list)
    for seed in seeds:
        made = planted(seed, **options)
        statistics = made.statistics
        for one in figures_of(statistics, fit(statistics)):
            for name in (one.name, f"{one.name} {one.site}"):
                if name in made.truth:
                    off = one.value - made.truth[name]
                    inside = one.low <= made.truth[name] <= one.high
                    found[name].append((inside, off / one.standard_error))
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("sets", type=int)
    parser.add_argument("--first", type=int, default=0, help="seed")
    parser.add_argument("--low", action="store_true", help="noise of 0.25 to 0.8 DN")
    parser.add_argument("--side", type=int, default=1, help="of the CFA's repeat, px")
    parser.add_argument("--noise", type=float, nargs="+", default=[None], help="DN")
    parser.add_argument("--black", type=float, nargs="+", default=[None], help="DN")
    given = parser.parse_args()
    seeds = range(given.first, given.first + given.sets)
    for black, noise in product(given.black, given.noise):
        of = {"low": given.low, "side": given.side, "black": black, "noise": noise}
        known = [
            f"{name} {of[name]:g} DN"
            for name in ("noise", "black")
            if of[name] is not None
        ]
        print(f"{' '.join(known):28}{'sets':>6}{'inside':>9}{'median':>8}{'sd':>7}")
        for name, rows in misses(seeds, **of).items():
            inside, off = np.array(rows).T
            share, middle, sd = inside.mean(), np.median(off), off.std()
            print(
                f"{name:28}{len(rows):6}{share:9.1%}{middle:8.2f}{sd:7.2f}", flush=True
            )


if __name__ == "__main__":
    main()
