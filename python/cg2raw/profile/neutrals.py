# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Measured neutrals of grey cards, from a table."""

from cg2raw.io.text_table import Row, Table, read_table

# Headers, in lower case without blanks, and what stands for R/G and B/G.
LAYOUTS = (("r", "g", "b"), ("r/g", "b/g"), ("rg", "bg"))
ALLOWED = "r,g,b or r/g,b/g or rg,bg"
LEAST, MOST = 0.01, 100.0  # R/G and B/G that a profile takes
FEWEST = 3  # distinct neutrals that span a distribution


def read_neutrals(path: str) -> list[list[float]]:
    """Return [[R/G, B/G], ...] of a table of camera RGB of grey, black removed.

    The header names the columns: r,g,b of any scale, or r/g,b/g, or rg,bg; other
    columns are not read. io/text_table.py says which tables are read.
    Raises ValueError naming file, line and column; OSError if it cannot be read."""
    table = read_table(path)
    if not table.line:
        raise ValueError(f"{path}: is empty; its header must be {ALLOWED}")
    columns = columns_of(table)
    neutrals = [neutral_of(row, columns) for row in table.rows]
    distinct = len({tuple(neutral) for neutral in neutrals})
    if distinct < FEWEST:
        raise ValueError(
            f"{path}: holds {distinct} distinct neutrals; a distribution needs at "
            f"least {FEWEST}"
        )
    return neutrals


def columns_of(table: Table) -> dict[str, int]:
    """Return {name: index} of the one layout whose columns a table has."""
    layouts = [{name: table.column(name) for name in layout} for layout in LAYOUTS]
    found = [
        {name: at for name, at in layout.items() if at is not None}
        for layout in layouts
        if None not in layout.values()
    ]
    if len(found) != 1:
        have = "has columns of several" if found else "names no neutrals"
        table.fail(f"header {', '.join(table.names)} {have}; it must hold {ALLOWED}")
    return found[0]


def neutral_of(row: Row, columns: dict[str, int]) -> list[float]:
    """Return [R/G, B/G] of one row."""
    values = {name: row.number(at) for name, at in columns.items()}
    for name, value in values.items():
        if value <= 0:
            row.fail(columns[name], f"is {value:g}; must be above 0")
    if len(values) == 3:
        neutral = {"r/g": values["r"] / values["g"], "b/g": values["b"] / values["g"]}
    else:
        neutral = values
    for name, ratio in neutral.items():
        if not LEAST <= ratio <= MOST:
            row.fail(
                None,
                f"{name} {ratio:g} must be {LEAST:g} to {MOST:g}; black must be "
                "removed from the measured values",
            )
    return [round(ratio, 6) for ratio in neutral.values()]
