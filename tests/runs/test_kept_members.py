"""Members of an ensemble that is cut off are kept, come back as they were, and are not computed again."""

from __future__ import annotations

import signal
import subprocess
import sys

import numpy as np
import pytest
import xarray as xr

import gearidae as gd
from gearidae import engine
from gearidae.archive.journal import journal_of
from gearidae.runs.run_cache import RunCache
from sweeps import without_times

LOW = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 2e-3})
VARY = {"coating.sam_fraction": "uniform(0.4, 1)"}

SHOT = """
import os, pathlib, signal, sys
import gearidae as gd
from gearidae.archive.journal import Journal

low = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 2e-3})

def shoot(done, total):
    path = pathlib.Path(sys.argv[1] + ".journal")
    if path.exists() and sum(1 for frame in Journal(path, "runs").frames()) >= 3:
        os.kill(os.getpid(), signal.SIGKILL)

gd.studies.ensemble(low, {"coating.sam_fraction": "uniform(0.4, 1)"}, 8, jobs=2,
                    archive=sys.argv[1], progress=shoot)
"""


@pytest.fixture
def cut_off(tmp_path):
    """Archive of an ensemble of eight that was cut off after five."""
    archive = tmp_path / "out.nc"

    class CutOffError(Exception):
        pass

    def cut(done, total):
        if done > 5.0:
            raise CutOffError

    with pytest.raises(CutOffError):
        gd.studies.ensemble(LOW, VARY, 8, jobs=1, archive=archive, progress=cut)
    return archive


def test_damaged_members_are_computed_again(cut_off):
    path = journal_of(cut_off)
    content = path.read_bytes()
    path.write_bytes(content.replace(b'"status": "finished"', b'"status": "finishes"', 1))
    assert path.read_bytes() != content
    with pytest.warns(UserWarning, match="ignored and computed again"):
        ds = gd.studies.ensemble(LOW, VARY, 8, jobs=1, archive=cut_off, resume=True)
    xr.testing.assert_identical(without_times(ds), without_times(gd.studies.ensemble(LOW, VARY, 8, jobs=1)))
    assert list(cut_off.parent.iterdir()) == [cut_off]


def test_a_killed_ensemble_goes_on_and_equals_one_that_was_not(tmp_path, monkeypatch):
    """The process shoots itself as soon as three members are kept; none of these is computed again."""
    archive = tmp_path / "out.nc"
    shot = subprocess.run([sys.executable, "-c", SHOT, archive], capture_output=True, check=False)
    assert shot.returncode == -signal.SIGKILL, shot.stderr
    whole = gd.studies.ensemble(LOW, VARY, 8, jobs=1)
    computed, solve = [], engine.solve
    monkeypatch.setattr(
        engine, "solve", lambda scene, **options: computed.append(1) or solve(scene, **options)
    )
    ds = gd.studies.ensemble(LOW, VARY, 8, jobs=1, archive=archive, resume=True)
    assert len(computed) == 8 - 3
    xr.testing.assert_identical(without_times(ds), without_times(whole))
    assert list(tmp_path.iterdir()) == [archive]


def test_members_of_others_stay(cut_off):
    with pytest.warns(UserWarning, match="5 of the runs kept .* left there"):
        gd.studies.ensemble(LOW, VARY, 4, seed=1, jobs=1, archive=cut_off, resume=True)
    kept = RunCache(cut_off, LOW, "native")
    assert kept.count() == 5 + 4
    kept.remove()
    assert not journal_of(cut_off).exists()


def test_numbers_are_kept_to_the_last_bit(cut_off):
    """JSON has the shortest decimals that give the same double, and NaN."""
    before = gd.studies.ensemble(LOW, VARY, 8, jobs=1)
    after = gd.studies.ensemble(LOW, VARY, 8, jobs=1, archive=cut_off, resume=True)
    for name in ("min_gear_speed", "largest_mesh_force", "stick_time"):
        assert before[name].values.tobytes() == after[name].values.tobytes()
    assert np.isnan(after["stick_time"]).any()
