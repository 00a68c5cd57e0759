# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.

"""Matrix products on one thread: of small matrices several cost more than they give,
and their results depend on how many there are."""

from collections.abc import Callable
from functools import wraps
from typing import ParamSpec, TypeVar

from threadpoolctl import threadpool_limits

Given = ParamSpec("Given")
Found = TypeVar("Found")


def one_blas_thread(function: Callable[Given, Found]) -> Callable[Given, Found]:
    """Return a function while which NumPy's and SciPy's BLAS have one thread."""

    @wraps(function)
    def _called(*given: Given.args, **named: Given.kwargs) -> Found:
        with threadpool_limits(limits=1, user_api="blas"):
            return function(*given, **named)

    return _called
