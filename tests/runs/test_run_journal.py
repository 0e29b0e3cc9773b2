"""The file of finished runs without samples: what is in it comes back as it was, what is damaged does not."""

from __future__ import annotations

import json
import signal
import subprocess
import sys

import numpy as np
import pytest
import xarray as xr

import gearidae as gd
from gearidae import engine
from gearidae.runs.kept_runs import KeptRuns, folder_beside
from gearidae.runs.run_journal import RunJournal
from sweeps import without_times

KEYS = [f"{number:064x}" for number in range(4)]
LOW = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 2e-3})
VARY = {"coating.sam_fraction": "uniform(0.4, 1)"}

SHOT = """
import os, pathlib, signal, sys
import gearidae as gd

low = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 2e-3})

def shoot(done, total):
    path = pathlib.Path(sys.argv[1] + ".runs", "runs.jsonl")
    if path.exists() and len(path.read_text().splitlines()) >= 3:
        os.kill(os.getpid(), signal.SIGKILL)

gd.studies.ensemble(low, {"coating.sam_fraction": "uniform(0.4, 1)"}, 8, jobs=int(sys.argv[2]),
                    archive=sys.argv[1], progress=shoot)
"""


@pytest.fixture
def journal(tmp_path):
    journal = RunJournal(tmp_path / "runs.jsonl")
    for number, key in enumerate(KEYS):
        journal.append(key, json.dumps({"number": number, "text": "\u00b5"}))
    return journal


def test_lines_are_json_and_come_back(journal):
    lines = [json.loads(line) for line in journal.path.read_text().splitlines()]
    assert [line["key"] for line in lines] == KEYS
    assert [line["run"]["number"] for line in lines] == [0, 1, 2, 3]
    for same in (journal, RunJournal(journal.path)):
        assert same.keys() == set(KEYS)
        assert [json.loads(same.read(key))["number"] for key in KEYS] == [0, 1, 2, 3]
        assert same.read("f" * 64) is None


def test_the_last_line_of_a_key_counts(journal):
    journal.append(KEYS[1], "[]")
    assert journal.read(KEYS[1]) == RunJournal(journal.path).read(KEYS[1]) == "[]"
    assert len(journal) == 4


def test_what_is_left_after_some_went_is_as_it_was(journal):
    journal.remove(set(KEYS[:3]))
    assert journal.keys() == {KEYS[3]}
    journal.append(KEYS[0], "[]")
    assert json.loads(journal.read(KEYS[3]))["number"] == 3
    journal.remove(set(KEYS))
    assert not journal.path.exists()


def flipped(journal, place):
    """Return the journal of another process, after one bit of the first line was turned over."""
    damaged = bytearray(journal.path.read_bytes())
    damaged[place] ^= 1
    journal.path.write_bytes(damaged)
    return RunJournal(journal.path)


@pytest.mark.parametrize("place", [120, 175])
def test_a_flipped_bit_of_checksum_or_text_is_found(journal, place):
    again = flipped(journal, place)
    with pytest.raises(ValueError, match="checksum"):
        again.read(KEYS[0])
    assert [json.loads(again.read(key))["number"] for key in KEYS[1:]] == [1, 2, 3]


@pytest.mark.parametrize("place", [12, 78, 155])
def test_with_a_flipped_bit_of_the_key_or_between_the_run_is_not_there(journal, place):
    again = flipped(journal, place)
    if place != 12:
        with pytest.warns(UserWarning, match="1 damaged lines"):
            assert again.read(KEYS[0]) is None
    assert again.read(KEYS[0]) is None
    assert [json.loads(again.read(key))["number"] for key in KEYS[1:]] == [1, 2, 3]


def test_a_line_that_was_cut_off_takes_no_other_along(journal):
    whole = journal.path.read_bytes()
    journal.path.write_bytes(whole[:-40])
    again = RunJournal(journal.path)
    with pytest.warns(UserWarning, match="1 damaged lines"):
        again.append(KEYS[3], "[3]")
    with pytest.warns(UserWarning, match="1 damaged lines"):
        assert RunJournal(journal.path).keys() == set(KEYS)
    assert again.read(KEYS[3]) == "[3]"


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


def test_members_are_lines_of_one_file_and_damaged_ones_are_computed_again(cut_off):
    (path,) = folder_beside(cut_off).iterdir()
    assert len(path.read_text().splitlines()) == 5
    text = path.read_text()
    path.write_text(text.replace('"status": "finished"', '"status": "finishes"', 1))
    with pytest.warns(UserWarning, match="ignored and its run computed again .*checksum"):
        ds = gd.studies.ensemble(LOW, VARY, 8, jobs=1, archive=cut_off, resume=True)
    xr.testing.assert_identical(without_times(ds), without_times(gd.studies.ensemble(LOW, VARY, 8, jobs=1)))
    assert list(cut_off.parent.iterdir()) == [cut_off]


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_killed_ensemble_goes_on_and_equals_one_that_was_not(tmp_path, monkeypatch, jobs):
    """The process shoots itself as soon as three members are kept; none of these is computed again."""
    archive = tmp_path / "out.nc"
    shot = subprocess.run([sys.executable, "-c", SHOT, archive, str(jobs)], capture_output=True, check=False)
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
    (path,) = folder_beside(cut_off).iterdir()
    assert len(path.read_text().splitlines()) == 5
    kept = KeptRuns(cut_off, LOW, "native")
    assert kept.count() == 5
    kept.remove()
    assert not folder_beside(cut_off).exists()


def test_numbers_are_kept_to_the_last_bit(cut_off):
    """JSON has the shortest decimals that give the same double, and NaN."""
    before = gd.studies.ensemble(LOW, VARY, 8, jobs=1)
    after = gd.studies.ensemble(LOW, VARY, 8, jobs=1, archive=cut_off, resume=True)
    for name in ("min_gear_speed", "largest_mesh_force", "stick_time"):
        assert before[name].values.tobytes() == after[name].values.tobytes()
    assert np.isnan(after["stick_time"]).any()
