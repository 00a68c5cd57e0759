# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""All tables of the summaries of results, study by study."""

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

from studies.summaries import Summaries, draws_in
from studies.tables import classical_tables, colour_tables
from studies.tables_content import content_tables
from studies.tables_illuminant import illuminant_tables, light_tables
from studies.tables_night import night_tables
from studies.tables_paired import REAL
from studies.tasks.content import TESTS
from studies.tasks.illuminant import BY_KELVIN, LEDS
from studies.world.shots import KINDS

ByLight = dict[str, dict[str, Any]]  # lights: camera: errors
LIGHTS = (*BY_KELVIN, LEDS)
ILLUMINANT = {  # study: its title, and the sources that it compares with others
    "illuminant": ("Illuminant", ("ours, dng", "ours, measured lights")),
    "light_draws": (
        "How lights are drawn",
        ("ours, measured lights", "ours, mixture of lights"),
    ),
}
FAMILIES = (TESTS, "real", "ours", "upi", "no matrix", "translation")
HELD_OUT = {"light_draws": "held_out_leds"}  # the same, trained without LEDs
SHARED = ("core", "packages", "seeds", "world", "lights")  # by entries of one table
SETTINGS = ("frames", "epochs", "samples", "features", "steps", "width")
TABLES_OF: dict[str, Callable[[Any], str]] = {
    "denoising": partial(night_tables, title="Denoising"),
    "files": partial(night_tables, title="Denoising, the full path by files"),
    "photographs": partial(
        night_tables, title="Denoising of photographs, each a test frame"
    ),
    "denoising_unet": partial(night_tables, title="Denoising by U-net"),
    "isp": partial(night_tables, title="Neural ISP"),
    "isp_unet": partial(night_tables, title="Neural ISP by U-net"),
    "content": content_tables,
}


def tables_by_study(results: Summaries, within: float) -> dict[str, str]:
    """Return the tables of each study that there are summaries of, in Markdown.

    within : of the published numbers of classical methods, allowed."""
    found = {}
    if classical := of_study(results, "classical"):
        found["classical"] = classical_tables(classical, within)
    if colour := of_study(results, "colour"):
        found["colour"] = both_kinds(colour)
    for study, (title, compared) in ILLUMINANT.items():
        if errors := ready(results, study):
            tables = illuminant_tables(errors, compared, title)
            parts = [titled(tables, "", results[study]["made by"])]
            with_leds, without = by_light(results, study)
            if with_leds:
                parts.append(light_tables(with_leds, without))
            found[study] = "\n\n".join(parts)
    for study, tables_of in TABLES_OF.items():
        parts = [
            titled(tables_of(ready(results, name)), made_of, results[name]["made by"])
            for name, made_of in entries_of(results, study)
        ]
        if parts:
            found[study] = "\n\n".join(parts)
    return found


def by_light(results: Summaries, study: str) -> tuple[ByLight, ByLight]:
    """Return {lights: {camera: errors}} of a study of illuminants, and of training
    without LEDs, if that was made alike."""
    names = (study, HELD_OUT.get(study, ""))
    with_leds, without = (
        {of: found for of in LIGHTS if (found := ready(results, f"{name}, {of}"))}
        for name in names
    )
    alike = {
        of: found
        for of, found in without.items()
        if made_alike(results, *(f"{name}, {of}" for name in names))
    }
    return with_leds, alike


def made_alike(results: Summaries, *names: str) -> bool:
    """Return whether entries of two studies were made by the same of all SHARED."""
    one, other = (results.get(name, {}).get("made by", {}) for name in names)
    return all(one.get(key) == other.get(key) for key in SHARED)


def entries_of(results: Summaries, study: str) -> list[tuple[str, str]]:
    """Return (name, of what other than the world) of each entry of a study.

    An entry of a single draw has no standard errors, and waits for the second."""
    names = sorted(name for name in results if ready(results, name))
    parts = [(name, *name.partition(", ")) for name in names]
    return [(name, made_of) for name, own, _, made_of in parts if own == study]


def ready(results: Summaries, name: str) -> dict[str, Any]:
    """Return {camera: entry} of those that have two draws or more, sources in order."""
    found = of_study(results, name).items()
    return {camera: in_order(entry) for camera, entry in found if draws_in(entry) > 1}


def of_study(results: Summaries, name: str) -> dict[str, Any]:
    """Return {camera: entry} of a study's entry, sorted; {} if there is none."""
    return dict(sorted(results.get(name, {}).get("cameras", {}).items()))


def in_order(entry: Any) -> Any:
    """Return an entry whose sources stand family by family, real first."""

    def place(source: str) -> tuple[int, str]:
        family = source.partition(",")[0].partition("'")[0]
        return (FAMILIES.index(family), source)

    if not isinstance(entry, dict):
        return entry
    if REAL in entry:
        return {source: entry[source] for source in sorted(entry, key=place)}
    return {name: in_order(part) for name, part in entry.items()}


def titled(tables: str, made_of: str, made_by: Mapping[str, Any]) -> str:
    """Return tables whose heading says of what they are, if not of the world, and by
    which settings, if it is known."""
    heading, _, rest = tables.partition("\n")
    heading += f": {made_of}" if made_of else ""
    said = settings_said(made_by.get("settings", {}))
    return f"{heading}\n\n{said}\n{rest}" if said else f"{heading}\n{rest}"


def settings_said(settings: Mapping[str, Mapping[str, Any]]) -> str:
    """Return a line of those SETTINGS that tell how much was learnt of."""
    parts = [
        f"{name}: " + ", ".join(f"{own[key]:,} {key}" for key in SETTINGS if key in own)
        for name, own in settings.items()
        if set(SETTINGS) & set(own)
    ]
    return f"*By {'; '.join(parts)}.*" if parts else ""


def both_kinds(colour: Mapping[str, Mapping[str, Any]]) -> str:
    """Return study 0's tables of each kind of scenes. colour : {camera: entry}."""
    return "\n\n".join(
        colour_tables({camera: entry[kind] for camera, entry in colour.items()}, kind)
        for kind in KINDS
    )


def together(tables: Mapping[str, str]) -> str:
    """Return the tables of all studies, as tables.md has them."""
    return "\n\n".join(tables.values()) + "\n"
