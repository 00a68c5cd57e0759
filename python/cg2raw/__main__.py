# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""python -m cg2raw: the same as the command cg2raw."""

import sys

from cg2raw.cli import main

sys.exit(main())
