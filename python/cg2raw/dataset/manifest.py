# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The manifest: a row per file, as JSON lines and Parquet, in the order of images."""

import hashlib
import os
import re
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from itertools import islice
from typing import Any

from cg2raw.core_arguments import has_surrogates
from cg2raw.dataset import journal
from cg2raw.dataset.journal import Row
from cg2raw.io.atomic_file import create
from cg2raw.near_words import one_line
from cg2raw.system import sync_folder

NAME = "manifest"
ENDINGS = (".parquet", ".jsonl")
# Of a row group. Two are in memory, 12 kB a row, and what a Parquet file ends with: 52
# columns of each row group, which are 40 B a row in groups of 1024.
ROWS = 4096
COLUMNS = (
    ("path", "string"),
    ("clean_path", "string"),
    ("sha256", "string"),
    ("bytes", "int64"),
    ("width", "int32"),
    ("height", "int32"),
    ("input", "string"),
    ("input_sha256", "string"),
    ("layer", "string"),
    ("transfer", "string"),
    ("white_luminance", "double"),
    ("sensor", "string"),
    ("profile_sha256", "string"),
    ("cfa", "string"),
    ("black_level", "list"),
    ("white_level", "double"),
    ("illuminant", "string"),
    ("illuminant_index", "int32"),
    ("neutral", "list"),
    ("xy", "list"),
    ("cct", "double"),
    ("duv", "double"),
    ("spectrum", "string"),
    ("camera_from_xyz", "list"),
    ("transform_first", "list"),
    ("transform_second", "list"),
    ("transform_gains", "list"),
    ("exposure", "double"),
    ("exposure_rule", "string"),
    ("scene_luminance", "double"),
    ("bracket", "double"),
    ("digital_gain", "double"),
    ("digital_gain_drawn", "bool"),
    ("iso", "double"),
    ("noise", "string"),
    ("noise_effects", "strings"),
    ("beta1", "list"),
    ("beta2", "list"),
    ("system_gain", "list"),
    ("read_noise", "list"),
    ("tukey_lambda", "double"),
    ("row_sigma", "double"),
    ("outlier_fraction", "double"),
    ("outlier_variance_ratio", "double"),
    ("exposure_time", "double"),
    ("f_number", "double"),
    ("seed", "uint64"),
    ("frame", "uint64"),
    ("patch", "int32"),
    ("crop", "integers"),
    ("method", "string"),
    ("method_seed", "uint64"),
    ("convention", "string"),
    ("format", "string"),
    ("element_type", "string"),
    ("compression", "string"),
    ("cg2raw", "string"),
)

NAMES = [name for name, _ in COLUMNS]
ENTRY = ["order", *NAMES]  # of a journal
# Of the columns that the rows of a journal have, in their order.
COLUMNS_DIGEST = hashlib.blake2b(" ".join(NAMES).encode(), digest_size=8).hexdigest()
ORDER = re.compile(rb'\{"order": (\d{1,18}), ')  # what an entry begins with


def is_text(value: Any) -> bool:
    """Return whether Arrow takes a value for a text: not with half of a pair."""
    return type(value) is str and (value.isascii() or not has_surrogates(value))


def is_between(low: int, high: int) -> Callable[[Any], bool]:
    """Return a test for whole numbers from @low to below @high; True is none."""
    return lambda value: type(value) is int and low <= value < high


is_exact = is_between(-(2**53), 2**53 + 1)  # a whole number that a double has


def is_double(value: Any) -> bool:
    """Return whether a value is a number that a double has."""
    return type(value) is float or is_exact(value)


def is_list_of(fits: Callable[[Any], bool]) -> Callable[[Any], bool]:
    """Return a test for lists whose items all fit."""
    return lambda value: type(value) is list and all(map(fits, value))


FITS = {
    "string": is_text,
    "double": is_double,
    "int32": is_between(-(2**31), 2**31),
    "int64": is_between(-(2**63), 2**63),
    "uint64": is_between(0, 2**64),
    "bool": lambda value: type(value) is bool,
    "list": is_list_of(is_double),
    "integers": is_list_of(is_between(-(2**31), 2**31)),
    "strings": is_list_of(is_text),
}
TESTS = [FITS["int64"], *(FITS[kind] for _, kind in COLUMNS)]  # of an entry


def is_whole(row: Row) -> bool:
    """Return whether a row is an entry of a journal: its place, then all columns and no
    other, in their order, each of its type or None."""
    if list(row) != ENTRY or row["order"] is None:
        return False
    values = zip(row.values(), TESTS, strict=True)
    return all(value is None or fits(value) for value, fits in values)


def entry(row: Row) -> Row:
    """Return a row as journals have it: where it stands among those of its image, then
    the columns of the manifest, in their order. Raises KeyError."""
    return {name: row[name] for name in ENTRY}


def remove(out: str) -> None:
    """Remove the manifest: there is one only of a data set that is complete."""
    for ending in ENDINGS:
        path = os.path.join(out, NAME + ending)
        if os.path.lexists(path):
            os.unlink(path)


def write(out: str, images: Iterable[tuple[str, str]], expected: int) -> None:
    """Write both manifests of @images, (name, path) each.

    expected : how many files there are. Rows stream from the journals; each manifest
    appears whole. Raises ValueError, and then there is none, for another count."""
    import pyarrow.parquet

    schema = arrow_schema()
    text = os.path.join(out, journal.FOLDER, "manifest.jsonl")
    table = os.path.join(out, journal.FOLDER, "manifest.parquet")
    count, found = 0, lines(out, images)
    with (
        create(text) as stream,
        create(table) as file,
        pyarrow.parquet.ParquetWriter(file, schema) as writer,
        ThreadPoolExecutor(1) as other,  # of rows that are read meanwhile
    ):

        def add(batch: list[bytes]) -> None:
            writer.write_table(table_of(batch, schema), ROWS)

        added = None
        while batch := list(islice(found, ROWS)):
            stream.writelines(batch)
            if added is not None:
                added.result()
            added = other.submit(add, batch)
            count += len(batch)
        if added is not None:
            added.result()
    if count != expected:
        raise ValueError(
            f"{out}: {expected} files are finished, {count} are on record: something "
            "else writes here; run the same command again to mend it"
        )
    publish(out, text, table)


def publish(out: str, text: str, table: str) -> None:
    """Give both manifests their names, once they are on the disk."""
    for path, ending in ((text, ".jsonl"), (table, ".parquet")):
        with open(path, "rb") as stream:
            os.fsync(stream.fileno())
        os.replace(path, os.path.join(out, NAME + ending))
    sync_folder(out)


def lines(out: str, images: Iterable[tuple[str, str]]) -> Iterator[bytes]:
    """Yield the lines of the manifest, as the journals have them."""
    for image, _ in images:
        header, texts = journal.read_texts(journal.path_of(out, image))
        if not header or header.get("columns") != COLUMNS_DIGEST:
            continue
        numbered = {}
        for text in texts:
            if found := ORDER.match(text):
                numbered[int(found[1])] = b"{" + text[found.end() :] + b"\n"
        yield from (numbered[order] for order in sorted(numbered))


def table_of(batch: list[bytes], schema: Any) -> Any:
    """Return lines of JSON as a table of Arrow. Raises ValueError for other columns."""
    from pyarrow import ArrowInvalid, BufferReader, json

    data = b"".join(batch)
    how = json.ParseOptions(explicit_schema=schema, unexpected_field_behavior="error")
    whole = json.ReadOptions(use_threads=False, block_size=len(data) + 1)
    try:
        return json.read_json(BufferReader(data), whole, how)
    except ArrowInvalid as error:
        raise ValueError(f"{NAME}: rows of other columns: {error}") from None


def bad_images(
    out: str, images: Iterable[tuple[str, str]]
) -> Iterator[tuple[str, str]]:
    """Yield (image, reason) of those that could not be used."""
    for image, _ in images:
        header = journal.header(journal.path_of(out, image))
        if header and journal.names(header, "reason"):
            yield image, one_line(header["reason"])


def arrow_schema() -> Any:
    """Return the schema of the Parquet file."""
    import pyarrow

    types = {
        "string": pyarrow.string(),
        "double": pyarrow.float64(),
        "int32": pyarrow.int32(),
        "int64": pyarrow.int64(),
        "uint64": pyarrow.uint64(),
        "bool": pyarrow.bool_(),
        "list": pyarrow.list_(pyarrow.float64()),
        "integers": pyarrow.list_(pyarrow.int32()),
        "strings": pyarrow.list_(pyarrow.string()),
    }
    return pyarrow.schema([(name, types[kind]) for name, kind in COLUMNS])
