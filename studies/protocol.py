# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The settings of the studies: protocol.toml, each table a class of its own."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tomllib

FILE = Path(__file__).with_name("protocol.toml")
Range = tuple[float, float]  # from the first to the second
Counts = tuple[int, int]  # the second included


@dataclass(frozen=True)
class SceneRules:
    """How leaves lie, in a frame of height x width pixels."""

    height: int
    width: int
    materials: Counts
    leaves: Counts
    radius: Range
    mixed: float
    facing: Range
    bounce: Range
    common: Range


@dataclass(frozen=True)
class MaterialRules:
    """What a scene's surfaces are made of."""

    fade: Range
    vivid: Range
    greys: float
    grey_level: Range
    tilt: Range


@dataclass(frozen=True)
class DayRules:
    """A main light, and a second one that fills its shadows and may be seen."""

    second: Range
    shadows: float
    gloss: float
    gloss_level: Range
    gloss_rarity: Range
    sky: float
    sky_level: Range
    sky_height: Range


@dataclass(frozen=True)
class NightRules:
    """Lamps near the leaves, some of them seen."""

    lights: Counts
    distance: Range
    lamps: Counts
    lamp_level: Range
    lamp_radius: Range


@dataclass(frozen=True)
class LightRules:
    """The pool of spectra, and how often each family is met."""

    daylight: int
    black_bodies: int
    day_kelvin: Range
    body_kelvin: Range
    scatter: Range
    body_tilt: float
    shares: dict[str, float]
    card_bandwidth: float
    pool_bandwidth: float
    night_kelvin: Range
    night_shares: dict[str, float]


@dataclass(frozen=True)
class ExposureRules:
    """Where auto exposure puts a quantile of the brightest channel."""

    quantile: float
    level: float


@dataclass(frozen=True)
class ClassicalRules:
    """The calibration of the world."""

    cameras: dict[str, list[str]]
    frames: dict[str, int]
    first: int
    power: int
    saturated: float
    within: float


@dataclass(frozen=True)
class ColourRules:
    """Study 0."""

    cameras: dict[str, list[str]]
    frames: dict[str, int]
    first: int
    dark: float
    bright: float


@dataclass(frozen=True)
class TrainingRules:
    """What sources may know of the training captures."""

    captures: int


@dataclass(frozen=True)
class SeedRules:
    """Seeds of the first scene of each training set."""

    real: int
    other: int
    rendered: int


@dataclass(frozen=True)
class LearntRules:
    """How much there is of a study of what is learnt."""

    cameras: dict[str, list[str]]
    draws: dict[str, int]


@dataclass(frozen=True)
class ChosenRules(LearntRules):
    """The same, with the sources that the study has of all."""

    sources: tuple[str, ...]


@dataclass(frozen=True)
class IlluminantRules(LearntRules):
    """Study 1."""

    frames: dict[str, int]
    tests: dict[str, int]
    epochs: dict[str, int]
    first: int
    block: int
    validation: float
    batch: int
    rate: float


@dataclass(frozen=True)
class DenoisingRules(LearntRules):
    """Study 2."""

    frames: dict[str, int]
    tests: dict[str, int]
    first: int
    noise_of: str
    isos: tuple[float, ...]
    brightness: tuple[float, ...]
    validation: float
    samples: dict[str, int]
    reach: int
    features: int
    spread: float
    focus: Range
    ridges: tuple[float, ...]


@dataclass(frozen=True)
class PhotographsRules(ChosenRules):
    """Study 2 on photographs."""

    bin: int
    size: int
    crops: int


@dataclass(frozen=True)
class UnetRules(ChosenRules):
    """A U-net, and what is learnt by it."""

    width: int
    levels: int
    size: int
    batch: int
    rate: float
    steps: dict[str, int]
    every: int


@dataclass(frozen=True)
class DenoisingUnetRules(UnetRules):
    """The other learner of study 2."""

    isos: tuple[float, ...]
    brightness: tuple[float, ...]


@dataclass(frozen=True)
class IspRules(LearntRules):
    """Study 3."""

    frames: dict[str, int]
    tests: dict[str, int]
    first: int
    step: int
    validation: float
    samples: dict[str, int]
    features: int
    ridges: tuple[float, ...]


@dataclass(frozen=True)
class TranslationRules:
    """How renders are made like balanced RAW, unpaired."""

    trained_for: tuple[str, ...]
    translators: dict[str, int]
    steps: dict[str, int]
    record: int
    batch: int
    crop: int
    patch: int
    patches: int
    rate: float
    generator_rate: float
    average: float
    content: float
    slope: float
    generator_width: int
    discriminator_width: int


@dataclass(frozen=True)
class Protocol:
    """All tables of protocol.toml."""

    scene: SceneRules
    materials: MaterialRules
    day: DayRules
    night: NightRules
    lights: LightRules
    exposure: ExposureRules
    classical: ClassicalRules
    colour: ColourRules
    training: TrainingRules
    seeds: SeedRules
    illuminant: IlluminantRules
    light_draws: ChosenRules
    held_out_leds: ChosenRules
    denoising: DenoisingRules
    files: ChosenRules
    photographs: PhotographsRules
    denoising_unet: DenoisingUnetRules
    isp: IspRules
    isp_unet: UnetRules
    content: LearntRules
    translation: TranslationRules


TABLES: dict[str, type] = dict(Protocol.__annotations__)


def read_protocol(path: Path = FILE) -> Protocol:
    """Return the Protocol of a file. Raises ValueError naming a wrong table or key."""

    def table(name: str, entries: dict[str, Any]) -> Any:
        values = {k: tuple(v) if isinstance(v, list) else v for k, v in entries.items()}
        return TABLES[name](**values)

    try:
        tables = tomllib.loads(path.read_text())
        return Protocol(**{name: table(name, tables[name]) for name in tables})
    except (KeyError, TypeError) as error:
        raise ValueError(f"{path}: {error}") from None


PROTOCOL = read_protocol()
