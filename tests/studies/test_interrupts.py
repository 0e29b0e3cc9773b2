"""Ctrl-C in studies: it ends them at once, also where threads compute, says how to go on, and loses nothing."""

from __future__ import annotations

import os
import signal
from concurrent.futures import ThreadPoolExecutor
from importlib import import_module

import pytest

import gearidae as gd

LOW = gd.preset("teodorescu2009_low_speed")
LAW = gd.wear.loss_law("adhesion_work", energy=1e-6)
LONG = 300_000
"""Mesh exits that no machine passes within the test."""
SOON = 3_000
"""Blocks of output after Ctrl-C at most; the runs would need a hundred times as many."""


def threshold(**options):
    return gd.studies.sticking_threshold(LOW, between=(1.0, 0.9), exits=LONG, **options)


def starting_torque(**options):
    slow = LOW.replace({"load.viscous": 1e-16})  # from rest through the mesh takes days of simulated time
    return gd.studies.starting_torque(slow, [1.0, 0.9], lowest=1e-22, impacts=1, **options)


def life(**options):
    return gd.studies.life(LOW, LAW, cycles=LONG // 1000, settle=1000, **options)


def lives(**options):
    vary = {"drive.torque": "uniform(4.4e-18, 4.6e-18)"}
    return gd.studies.lives(LOW, LAW, vary, 2, cycles=LONG // 1000, settle=1000, **options)


def ensemble(**options):
    vary = {"drive.torque": "uniform(4.4e-18, 4.6e-18)"}
    return gd.studies.ensemble(LOW.replace({"run.duration": 1000.0}), vary, 2, **options)


def coating_map(**options):
    long = LOW.replace({"run.duration": 1000.0, "run.samples": 101})
    return gd.studies.coating_map(long, [1.0, 0.9], **options)


@pytest.fixture
def ctrl_c(monkeypatch):
    """Send SIGINT as a run has come to its fourth block; count the blocks after it."""
    native = import_module("gearidae.engine.native")
    real, counts = native.update_statistics, []

    def counted(*args):
        counts.append(None)
        if len(counts) == 4:
            os.kill(os.getpid(), signal.SIGINT)
        return real(*args)

    monkeypatch.setattr(native, "update_statistics", counted)
    return counts


@pytest.mark.parametrize("jobs", [1, 2])
@pytest.mark.parametrize("study", [threshold, starting_torque, life, lives, ensemble, coating_map])
def test_ctrl_c_ends_a_study_and_says_how_to_resume(study, jobs, ctrl_c, tmp_path):
    with pytest.raises(gd.Interrupted, match="--resume"):
        study(jobs=jobs, archive=tmp_path / "out.nc")
    assert 4 <= len(ctrl_c) < SOON


def test_calls_in_an_executor_of_the_users_are_dropped(ctrl_c):
    short = LOW.replace({"run.duration": 2e-3})
    with ThreadPoolExecutor(1) as executor, pytest.raises(gd.Interrupted):
        gd.studies.sensitivity(short, "drive.torque", of="max_gear_speed", executor=executor)
