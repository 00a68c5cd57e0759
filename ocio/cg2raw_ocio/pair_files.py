# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The files beside a config: chains of sensors under illuminants.

A config cannot hold a table, so that a RAW space of convention spectral is a file."""

import dataclasses
from collections.abc import Callable, Iterator, Sequence

from cg2raw._core import SensorProfile

from . import export, names
from .spaces import Exposure


@dataclasses.dataclass(frozen=True)
class PairFiles:
    """The files of each sensor x illuminant, made one pair at a time.

    of_pair : (profile, illuminant, exposure) -> {file name: text}."""

    of_pair: Callable[[SensorProfile, str, Exposure], dict[str, str]]
    profiles: Sequence[SensorProfile]
    illuminants: Sequence[str]
    exposure: Exposure

    def items(self) -> Iterator[tuple[str, bytes]]:
        """Yield names and bytes. Raises ValueError for a pair that cannot be."""
        for profile in self.profiles:
            for illuminant in self.illuminants:
                texts = self.of_pair(profile, illuminant, self.exposure)
                yield from ((name, text.encode()) for name, text in texts.items())


def table_files(
    profile: SensorProfile, illuminant: str, exposure: Exposure
) -> dict[str, str]:
    """Return {names.table_file(): text} of one pair: to RAW. Raises ValueError."""
    text, _ = export.raw_text(profile, illuminant, exposure)
    return {names.table_file(profile.id, illuminant): text}
