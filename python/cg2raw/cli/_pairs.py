# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Sensors and illuminants that a command line lists, to be combined with each other."""

from collections.abc import Callable, Sequence

from cg2raw import _core


def asked_sensors(
    words: str,
    load: Callable[[str], _core.SensorProfile] = _core.load_profile,
    option: str = "--sensors",
) -> list[_core.SensorProfile]:
    """Return the core profiles of "all" or of "id,id,path.json". Raises ValueError.

    load : gives the profile of an id or path.
    option : that gave the words, for messages."""
    ids = _core.installed_profiles() if words == "all" else words.split(",")
    if not ids:
        folders = ":".join(_core.profile_folders()) or "no folder"
        raise ValueError(f"{option} all: none in {folders}")
    profiles = [load(id.strip()) for id in ids]
    refuse_twice(option, [profile.id for profile in profiles])
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
