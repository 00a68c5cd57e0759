# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Random numbers set by a key, whatever the order of work."""

import hashlib
import json


def hashed(*key: object) -> int:
    """Return 53 bits that a key decides, exact in any reader of JSON."""
    digest = hashlib.blake2b(json.dumps(key).encode(), digest_size=8).digest()
    return int.from_bytes(digest, "big") >> 11
