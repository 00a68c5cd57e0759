# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The device that networks are trained on. It needs PyTorch."""

import os


def device() -> str:
    """Return "cuda" where there is a GPU, else "cpu", set up such that a seed decides
    every bit: one thread of the CPU; of a GPU's algorithms those that always add in the
    same order, and that keep all of float32, as a CPU does.

    Call it before anything has run on the GPU. Source: PyTorch, Reproducibility, and
    Numerical accuracy."""
    import torch

    torch.set_num_threads(1)
    if not torch.cuda.is_available():
        return "cpu"
    os.environ.setdefault("CUBLAS_WORKSPACE_CONFIG", ":4096:8")
    torch.use_deterministic_algorithms(True)
    torch.backends.cudnn.allow_tf32 = False
    return "cuda"
