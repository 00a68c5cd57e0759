# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Sensors with made-up noise."""

import json

import numpy as np

from cg2raw import Sensor
from cg2raw.synthetic.synthetic_camera import stream

# Colours of real cameras; levels and noise are drawn.
BASES = ("canon-70d", "nikon-d850", "sony-a7s-ii", "samsung-s20fe", "gopro-hero6-black")
BITS = (10, 12, 14)
# A coarser ADC than this many DN per read noise would show as steps, not as noise.
LEAST_READ_NOISE_DN = 0.7
ISO = 100.0
ASSUMED = "assumed, not measured"


def drawn_sensor(seed: int) -> Sensor:
    """Return a sensor of full well 2500 to 12000 e-, read noise 2 to 5 e-, black level
    64 to 512 DN, white level 1023 to 16383 DN, with noise at ISO 100."""
    rng = stream(seed, "sensor")
    full_well = float(np.exp(rng.uniform(np.log(2500), np.log(12000))))
    read_noise = rng.uniform(2, 5)
    black = float(rng.choice([64, 128, 256, 512]))
    bits = rng.permutation(BITS)
    fine = [
        b
        for b in bits
        if (2.0**b - 1 - black) * read_noise >= LEAST_READ_NOISE_DN * full_well
    ]
    chosen = int(fine[0] if fine else max(BITS))
    base = json.loads(Sensor(str(rng.choice(BASES))).to_json())
    base.update(
        id=f"drawn-{seed}",
        bits=chosen,
        black_level=[black] * 4,
        white_level=2**chosen - 1,
        effects=[],
    )
    bare = Sensor.from_json(json.dumps(base), base["id"])
    return with_noise(bare, full_well, read_noise, ISO)


def with_noise(
    sensor: Sensor, full_well: float, read_noise: float, iso: float
) -> Sensor:
    """Return a Bayer sensor with another noise, the same at all sites.

    full_well, read_noise : electrons. Raises ValueError."""
    if not 10 <= full_well <= 1e6:
        raise ValueError(f"full well {full_well:g} e- must be 10 to 1000000")
    if not 0 < read_noise < full_well / 10:
        raise ValueError(
            f"read noise {read_noise:g} e- must be above 0 and below a tenth of the "
            f"full well, {full_well:g} e-"
        )
    profile = json.loads(sensor.to_json())
    sites = len(sensor.black_level)  # one per site
    profile["noise"] = [
        {
            "iso": iso,
            "beta1": [1 / full_well] * sites,
            "beta2": [(read_noise / full_well) ** 2] * sites,
        }
    ]
    profile["sources"]["noise"] = (
        f"{ASSUMED}: full well {full_well:g} e-, read noise {read_noise:g} e-"
    )
    return Sensor.from_json(json.dumps(profile), sensor.id)
