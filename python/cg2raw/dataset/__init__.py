# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Data sets: every image by every sensor, light, digital gain and ISO, with a manifest.

`plan` says what is made, `job` makes all of one image, `local` and `cluster` hand jobs
to workers, `journal` remembers what is finished, `manifest` lists it, `run` is the
whole. What a file holds depends on its key and the plan alone, never on order, workers
or interruptions.
"""

from cg2raw.dataset.kept_profiles import sensor_of

__all__ = ["sensor_of"]
