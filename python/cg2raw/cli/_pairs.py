# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Sensors and illuminants that a command line lists, to be combined with each other."""

import difflib
from collections.abc import Sequence

from cg2raw import _core


def load_one(id: str) -> _core.SensorProfile:
    """Return the SensorProfile; an unknown id is told the closest one."""
    installed = _core.installed_profiles()
    if id in installed or "/" in id or id.endswith(".json"):
        return _core.load_profile(id)
    close = difflib.get_close_matches(id.lower(), installed, 1)
    hint = f"did you mean {close[0]}? " if close else ""
    raise ValueError(
        f'unknown sensor "{id}": {hint}installed: {", ".join(installed) or "none"}; '
        "or give the path of a profile (.json)"
    )


def asked_sensors(words: str) -> list[_core.SensorProfile]:
    """Return the core profiles of "all" or of "id,id,path.json". Raises ValueError."""
    ids = _core.installed_profiles() if words == "all" else words.split(",")
    if not ids:
        folders = ":".join(_core.profile_folders()) or "no folder"
        raise ValueError(f"--sensors all: none in {folders}")
    profiles = [load_one(id.strip()) for id in ids]
    refuse_twice("--sensors", [profile.id for profile in profiles])
    return profiles


def asked_illuminants(words: str) -> list[str]:
    """Return the words of a list of illuminants. Raises ValueError."""
    if any(word.strip().lower() == "as-shot" for word in words.split(",")):
        raise ValueError(
            "--illuminants as-shot: needs a DNG, whose AsShotNeutral it is, and a "
            "config has none; name a light, or its neutral:R/G:B/G"
        )
    found = _core.illuminant_list(words)
    refuse_twice("--illuminants", found)
    return found


def refuse_twice(option: str, words: Sequence[str]) -> None:
    """Raise ValueError for a word that is there twice, but for upper and lower case."""
    seen: dict[str, str] = {}
    for word in words:
        if word.lower() in seen:
            raise ValueError(
                f"{option}: {seen[word.lower()]} and {word} are the same; name it once"
            )
        seen[word.lower()] = word


def check_pairs(
    profiles: Sequence[_core.SensorProfile], illuminants: Sequence[str]
) -> None:
    """Raise ValueError naming the sensor that cannot have an illuminant."""
    for profile in profiles:
        for illuminant in illuminants:
            try:
                profile.illuminant(illuminant)
            except ValueError as error:
                raise ValueError(
                    f"--illuminants {illuminant}: not with {profile.id}: {error}"
                ) from None
