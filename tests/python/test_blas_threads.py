# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""BLAS has one thread while such a function runs, and what it had afterwards."""

import numpy as np
import pytest
from threadpoolctl import threadpool_info

from cg2raw.blas_threads import one_blas_thread


def threads():
    np.linalg.inv(np.eye(3))
    return [
        one["num_threads"] for one in threadpool_info() if one["user_api"] == "blas"
    ]


def test_one_thread_within_and_as_many_as_before_after():
    before = threads()

    @one_blas_thread
    def fails(given, *, other):
        assert (given, other) == (1, 2)
        assert set(threads()) == {1}
        raise ValueError("said")

    with pytest.raises(ValueError, match="said"):
        fails(1, other=2)
    assert threads() == before
    assert fails.__name__ == "fails"
