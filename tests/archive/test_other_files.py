"""Archives of other things than runs, and of runs from which somebody has taken something."""

from __future__ import annotations

import pytest

import gearidae as gd
from gearidae.archive import open_archive, save, to_dataset

LOW = gd.preset("teodorescu2009_low_speed").replace({"run.samples": 11})


@pytest.fixture
def single(make_solution):
    return to_dataset(LOW, make_solution(LOW))


def test_the_file_of_a_study_is_called_what_it_is(single, tmp_path):
    """A study's file has a scene and a version, and no variable of a run but those that it shares."""
    study = single.drop_vars(list(single.data_vars)).drop_dims("event", errors="ignore")
    study = study.assign(limit=("time", study.time.values)).assign_attrs(
        title="low_speed: threshold of exits"
    )
    save(study, tmp_path / "study.nc")
    with pytest.raises(gd.SceneError, match='is no archive of runs but "low_speed: threshold of exits"'):
        open_archive(tmp_path / "study.nc")


def test_a_run_without_its_events_opens(single, tmp_path):
    without = single.drop_dims("event")
    save(without, tmp_path / "run.nc")
    opened = open_archive(tmp_path / "run.nc")
    assert opened.identical(without)
    verdicts = opened.gearidae.verdicts()
    assert verdicts["verdict"].tolist() == single.gearidae.verdicts()["verdict"].tolist()
    assert verdicts["impacts"].isna().all()  # and not 0
