# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Numbers that a key decides, whatever the order of work."""

import hashlib
import json

from cg2raw import _core


def drawn_gain(profile, seed, frame):
    """Return a digital gain drawn from the profile, keyed by seed and frame."""
    run = _core.Run(
        illuminant="D65",
        iso=None,
        noise="gaussian",
        seed=seed,
        frame=frame,
        digital_gain=1.0,
        convention="dng",
        highlights=True,
        effects=False,
        camera_input=False,
        as_shot=None,
        sample_digital_gain=True,
    )
    return _core.Simulation(profile, (2, 2), run).digital_gain


def hashed(*key):
    """Return 53 bits that a key decides, exact in any reader of JSON."""
    digest = hashlib.blake2b(json.dumps(key).encode(), digest_size=8).digest()
    return int.from_bytes(digest, "big") >> 11
