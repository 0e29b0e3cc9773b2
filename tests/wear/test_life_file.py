"""The life of a coating is read back from its file, and nothing else is taken for one."""

import json

import numpy as np
import pytest
import xarray as xr

import gearidae as gd
from gearidae.archive import save
from gearidae.cli import main

LINE = ("passages", [1.0, 1.0, 1.0])


@pytest.fixture
def whole():
    """What a life consists of, without a run."""
    return xr.Dataset(
        {
            "coverage": (("passages", "side"), np.array([[0.9], [0.8], [0.7]])),
            "verdict": ("passages", ["turns", "turns", "sticks"]),
            "mean_gear_speed": LINE,
            "min_gear_speed": LINE,
        },
        coords={"passages": [0.0, 1e6, 2e6], "side": ["interface"]},
        attrs={
            "ending": "sticks",
            "passages_to_sticking": 2.1e6,
            "scene": json.dumps(gd.preset("teodorescu2009").to_dict()),
        },
    )


def test_a_life_is_read_back_and_drawn(whole, tmp_path):
    path = tmp_path / "life.nc"
    save(whole, path)
    xr.testing.assert_equal(gd.studies.open_life(path), whole)
    assert main(["plot", str(path), "-o", str(tmp_path / "life.png")]) == 0
    assert (tmp_path / "life.png").stat().st_size > 1000


@pytest.mark.parametrize("spoil", [lambda ds: ds.drop_vars("verdict"), lambda ds: ds.isel(passages=slice(0))])
def test_what_is_no_life_is_refused(whole, tmp_path, spoil):
    path = tmp_path / "other.nc"
    save(spoil(whole), path)
    with pytest.raises(gd.SceneError, match=r"other\.nc.*no life of a coating"):
        gd.studies.open_life(path)


def test_other_files_are_refused(tmp_path):
    (tmp_path / "note.txt").write_text("mine")
    with pytest.raises(gd.SceneError, match="another kind of file"):
        gd.studies.open_life(tmp_path / "note.txt")
    with pytest.raises(gd.SceneError, match="no such file"):
        gd.studies.open_life(tmp_path / "none.nc")
