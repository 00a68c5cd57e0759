# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""Golden files are those of any processor: its arithmetic decides no more than their
rounding."""

import os
import platform
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        platform.machine() not in ("x86_64", "AMD64"), reason="kernels of x86-64"
    ),
]
# numpy's kernels for later processors than the oldest that it runs on.
LATER = "AVX512F AVX512CD AVX512_SKX AVX512_CLX AVX512_CNL AVX512_ICL AVX512_SPR "
LATER += "AVX2 FMA3"
WITHOUT_FMA = "glibc.cpu.hwcaps=-FMA,-FMA_Usable,-FMA4,-AVX2,-AVX2_Usable"


@pytest.mark.parametrize(
    "variables",
    [
        {"OPENBLAS_CORETYPE": "Haswell"},
        {"OPENBLAS_CORETYPE": "Prescott"},
        {"NPY_DISABLE_CPU_FEATURES": LATER},
        {"GLIBC_TUNABLES": WITHOUT_FMA},
    ],
    ids=["BLAS of AVX2", "BLAS of SSE3", "numpy without AVX2", "libm without FMA"],
)
def test_other_kernels_find_the_same(variables):
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-W", "ignore", Path(__file__).parent],
        env={**os.environ, **variables, "CG2RAW_TEST_SLOW": "0"},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout
