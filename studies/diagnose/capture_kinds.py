# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Print which captures show which effect: a row for each.

    ./studies/run capture-kinds [--cases N] [--threads N] [--effects A,B]

Every effect is hidden in simulated captures, at the middle of the strengths that the
generator draws from, and looked for in the darks alone, the flats alone, and so on. A
cell tells in how many of N cases it was the first name, and which other name was most
often in its place.
"""

import argparse
import collections
import dataclasses
import math
import sys
from collections.abc import Callable

import cg2raw
from cg2raw.diagnose import diagnose
from cg2raw.diagnose.captures.capture import Capture, CaptureSet
from cg2raw.synthetic.captures import draw_hidden, simulate_captures
from cg2raw.synthetic.strengths import KINDS

SENSOR, ISO, SHAPE = "canon-5d-mark-iv", 800.0, (96, 128)
COLUMNS: dict[str, Callable[[Capture], bool]] = {
    "darks": lambda capture: capture.kind == "dark",
    "flats": lambda capture: capture.kind == "flat",
    "darks, flats": lambda capture: capture.kind in ("dark", "flat"),
    "scenes": lambda capture: is_scene(capture) and capture.name.endswith("_0"),
    "scenes, twice": lambda capture: is_scene(capture),
    "all": lambda capture: True,
}


def is_scene(capture: Capture) -> bool:
    return capture.kind == "scene"


def captures_of(name: str, seed: int) -> CaptureSet:
    """Return frames with one hidden effect of middling strength."""
    sensor = cg2raw.Sensor(SENSOR)
    strength = math.sqrt(KINDS[name].low * KINDS[name].high)
    hidden = draw_hidden(sensor, {name: strength}, seed=seed, iso=ISO)
    return simulate_captures(sensor, hidden, seed=seed, shape=SHAPE, iso=ISO)


def first_names(name: str, cases: int, threads: int) -> dict[str, list[str]]:
    """Return column -> the first name of each case; "" where nothing was named."""
    found: dict[str, list[str]] = collections.defaultdict(list)
    for seed in range(cases):
        every = captures_of(name, seed)
        for column, belongs in COLUMNS.items():
            chosen = [capture for capture in every.captures if belongs(capture)]
            part = dataclasses.replace(every, captures=chosen)
            verdict = diagnose(part, details=False, threads=threads)
            names = [effect.name for effect in verdict.effects]
            found[column].append(names[0] if names else "")
    return found


def cell(name: str, names: list[str]) -> str:
    """Return the words on one effect in one column."""
    right = names.count(name)
    wrong = collections.Counter(n for n in names if n not in (name, ""))
    if not wrong:
        return f"{right}/{len(names)}" if right else "-"
    return f"{right}/{len(names)}, `{wrong.most_common(1)[0][0]}`"


def main() -> int:
    """Print the table, row by row."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--cases", type=int, default=3, help="per effect (default 3)")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--effects", default="", help="rows of these alone")
    arguments = parser.parse_args()
    print(f"| hidden | {' | '.join(COLUMNS)} |")
    print(f"|---|{'---|' * len(COLUMNS)}")
    for name in arguments.effects.split(",") if arguments.effects else KINDS:
        found = first_names(name, arguments.cases, arguments.threads)
        cells = (cell(name, found[column]) for column in COLUMNS)
        print(f"| `{name}` | {' | '.join(cells)} |", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
