# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""python -m studies.diagnose: see run."""

import sys

from studies.diagnose.run import main

sys.exit(main())
