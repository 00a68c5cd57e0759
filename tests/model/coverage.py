# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""How often 95 % intervals hold what was planted, figure by figure.

python -m model.coverage SETS [--low] [--side N] [--black DN] [--noise DN]"""

import argparse
from collections import defaultdict

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
    parser.add_argument("--black", type=float, help="DN")
    parser.add_argument("--noise", type=float, help="DN")
    given = vars(parser.parse_args())
    first = given.pop("first")
    seeds = range(first, first + given.pop("sets"))
    print(f"{'figure':28}{'sets':>6}{'inside':>9}{'median':>8}{'sd':>7}")
    for name, rows in misses(seeds, **given).items():
        inside, off = np.array(rows).T
        share, middle, sd = inside.mean(), np.median(off), off.std()
        print(f"{name:28}{len(rows):6}{share:9.1%}{middle:8.2f}{sd:7.2f}")


if __name__ == "__main__":
    main()
