# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""What else may lift images as a black level does, which no darks tell from it."""

from scipy.special import chdtrc
from scipy.stats import ttest_1samp

from cg2raw.diagnose.scenes.gram import Array
from cg2raw.model.dark_levels import CURRENT, DRIFT


def others_that_lift(
    levels: Array, information: Array, deviations: Array, alpha: float
) -> set[str]:
    """Return the effects that may be in its place: drift, if scenes agree on it no
    better than by chance; dark current, if it lifts all sites alike.

    levels : (k,) of each site. information : (k, k) of them. deviations : (n,) how far
    each scene is off their mean, n at least 2. alpha : chance. Source: Student,
    Biometrika 6(1), 1908."""
    mean = float((information @ levels).sum() / information.sum())
    apart = float((levels - mean) @ information @ (levels - mean))
    are_alike = len(levels) == 1 or chdtrc(len(levels) - 1, apart) > alpha
    is_drift = ttest_1samp(mean + deviations, 0.0).pvalue > alpha
    may_be = {DRIFT: is_drift, CURRENT: mean > 0 and are_alike}
    return {name for name, may in may_be.items() if may}
