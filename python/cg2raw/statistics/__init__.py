# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""What darks and flats say, as small arrays, after one pass over their pixels.

frame_statistics(groups, side, white) goes over the frames. Its ConstantStatistics are
all that calibration and the likelihood (cg2raw.model) need of them, and can be saved.
"""

from cg2raw.statistics.constant import ConstantStatistics, GroupInfo, PlaneStatistics
from cg2raw.statistics.frame_statistics import frame_statistics

__all__ = ["ConstantStatistics", "GroupInfo", "PlaneStatistics", "frame_statistics"]
