# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""python -m cg2raw.synthetic: see captures."""

import sys

from cg2raw.synthetic.captures import main

sys.exit(main())
