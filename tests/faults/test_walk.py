# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""A sample of what scripts/faults walks: of each command, some calls of each kind."""

import signal

import pytest

from conftest import oiiotool_runner
from faults.injector import CALLS
from faults.judge import Ended, Known, faults_of
from faults.targets import TARGETS
from faults.walk import walked
from tiers import slow

# Every how many-th call of a kind fails, and how many are tried at most: what takes a
# few seconds. Of memory, thousands of allocations are met.
FEW = dict.fromkeys(CALLS, (2, 2)) | {"malloc": (61, 8)}
ONE = dict.fromkeys(CALLS, (1, 1)) | {"malloc": (61, 2)}  # where a run takes longer
LONGER = ("dataset", "calibrate", "diagnose", "oiio-wheel")
MANY = dict.fromkeys(CALLS, (1, 40)) | {"malloc": (1, 10**6)}


def check(name, library, steps, errors=None):
    """Walk some faults of a target; return how many it met."""
    target = TARGETS[name]
    if target.is_program:
        oiiotool_runner(name)  # which skips
    count = walked(target, library, steps, errors=errors)
    assert count.findings == []
    return count.fired


@pytest.mark.parametrize(
    "name", [name if name == "oiio-wheel" else slow(name) for name in TARGETS]
)
def test_some_faults_of_each_kind(library, name):
    steps = ONE if name in LONGER else FEW
    assert check(name, library, steps, errors=1) > 15


@pytest.mark.slow
@pytest.mark.parametrize("name", TARGETS)
def test_all_faults(library, name):
    assert check(name, library, MANY) > 200


def test_a_fault_is_met_and_judged():
    """The judge sees each thing that is promised, or it would find nothing."""
    known = Known({"a": b"old"}, {"a": b"new"}, "/place")
    right = Ended(256, "cannot write /place/a: No space left on device")
    assert faults_of(right, {"a": b"old"}, known) == []
    assert faults_of(right, {"a": b"new"}, known) == []
    assert faults_of(right, {"a": b"ne"}, known) == ["a is neither old nor new"]
    assert faults_of(right, {}, known) == ["a is missing"]
    assert faults_of(right, {"a": b"old", ".t": b""}, known) == ["leaves .t"]
    assert faults_of(Ended(0, ""), {"a": b"old"}, known) == ["a is neither old nor new"]
    assert faults_of(Ended(0, ""), {"a": b"new"}, known) == []
    assert faults_of(Ended(None, ""), {"a": b"new"}, known) == ["hangs"]
    assert faults_of(Ended(256, "no"), {"a": b"old"}, known) == ["names no path"]
    killed = Ended(signal.SIGSEGV, "/place")
    assert faults_of(killed, {"a": b"old"}, known) == ["killed by SIGSEGV"]
    traced = Ended(256, "Traceback /place")
    assert faults_of(traced, {"a": b"old"}, known) == ["says Traceback"]
    long = Ended(256, "/place" * 400)
    assert faults_of(long, {"a": b"old"}, known) == ["says 2400 letters"]
    folder = Known({}, {"b": None, "b/c": b"new"}, "/place")
    assert faults_of(right, {"b": None}, folder) == ["leaves a part of b"]
    assert faults_of(right, {"b": None, "b/c": b"new"}, folder) == []
