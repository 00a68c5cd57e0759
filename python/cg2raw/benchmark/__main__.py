# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""python -m cg2raw.benchmark: see run."""

import sys

from cg2raw.benchmark.run import main

sys.exit(main())
