"""Ensembles over the seeds of a population: gears of one design, their means, and what keys vary beside them."""

from __future__ import annotations

import math
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest
import xarray as xr

import gearidae as gd
from gearidae.cli import main
from gearidae.studies.products import answer
from sweeps import without_times

GEARS = gd.preset("teodorescu2009").replace(
    {"contact.roughness": "discrete", "contact.seed": 5, "run.duration": 10e-6, "run.samples": 11}
)
SEEDS = {"contact.seed": "seeds"}


@pytest.fixture(scope="module")
def specimens():
    return gd.studies.ensemble(GEARS, SEEDS, 6)


def test_seeds_are_numbered_from_the_scene_s_own_on(specimens):
    assert specimens.seed.values.tolist() == [5, 6, 7, 8, 9, 10]
    alone = gd.simulate(GEARS.replace({"contact.seed": 8}))
    specimen = specimens.isel(member=3)
    for name in ("max_gear_speed", "largest_mesh_force", "asperity_onsets"):
        assert float(specimen[name]) == float(alone[name])
    assert float(specimen.adhesion_loss) == alone.gearidae.energy_balance["adhesion_loss"]
    assert np.unique(specimens.max_gear_speed).size == 6


def test_processes_do_not_matter(specimens):
    with ProcessPoolExecutor(1) as executor:
        other = gd.studies.ensemble(GEARS, SEEDS, 6, executor=executor)
    xr.testing.assert_identical(without_times(other), without_times(specimens))


def test_means_have_standard_errors(specimens):
    rows = {name: (value, remark) for name, value, remark in answer(specimens, "ensemble").rows}
    value, remark = rows["settled gear speed"]
    mean, error = (float(part) for part in value.removesuffix(" rad/s").split(" +- "))
    speeds = specimens.settled_gear_speed.values
    scatter = np.std(speeds, ddof=1)
    assert error == pytest.approx(scatter / math.sqrt(6.0), rel=0.05)
    assert mean == pytest.approx(speeds.mean(), rel=0, abs=0.05 * error)
    assert f"{scatter:.2g}" in remark
    assert "adhesion loss over drive work" in rows
    assert "one specimen" in rows["Means over the seeds"][1]


def test_keys_vary_beside_seeds_which_have_no_index():
    vary = {**SEEDS, "drive.torque": "normal(2.4e-11, 1e-12)"}
    ds = gd.studies.ensemble(GEARS, vary, 8, of="max_gear_speed", seed=2)
    a, b, ab = np.split(ds.seed.values, 3)
    assert a.tolist() == ab.tolist() == list(range(5, 13))
    assert b.tolist() == list(range(13, 21))
    assert ds.parameter.values.tolist() == ["drive.torque"]
    assert "no continuous input" in ds.attrs["index_comment"]
    rows = {name: (value, remark) for name, value, remark in answer(ds, "ensemble").rows}
    assert rows["contact.seed"][0] == "no index"
    # the same seeds and torques as without a key that is not there: rows of B have other ones
    plain = gd.studies.ensemble(GEARS, vary, 8, seed=2)
    assert plain.seed.values.tolist() == a.tolist()


def test_errors_of_teeth_are_drawn_anew_for_each_member():
    teeth = gd.preset("teodorescu2009").replace(
        {"mesh.pitch_error_rms": 1e-8, "mesh.pitch_error_seed": 2, "run.duration": 10e-6, "run.samples": 11}
    )
    ds = gd.studies.ensemble(teeth, {"mesh.pitch_error_seed": "seeds"}, 4)
    assert ds.pitch_error_seed.values.tolist() == [2, 3, 4, 5]
    alone = gd.simulate(teeth.replace({"mesh.pitch_error_seed": 4}))
    assert float(ds.isel(member=2).largest_mesh_force) == float(alone.largest_mesh_force)
    assert np.unique(ds.largest_mesh_force).size == 4
    assert "Means over the seeds" in {name for name, _, _ in answer(ds, "ensemble").rows}
    both = {**SEEDS, "mesh.pitch_error_seed": "seeds"}
    ds = gd.studies.ensemble(GEARS.replace({"mesh.pitch_error_rms": 1e-8}), both, 2)
    assert ds.seed.values.tolist() == [5, 6]
    assert ds.pitch_error_seed.values.tolist() == [0, 1]


def test_wrong_seeds_are_named():
    cases = (
        (GEARS, {"contact.seed": "uniform(0, 9)"}, {}, 'must be "seeds"'),
        (gd.preset("teodorescu2009"), SEEDS, {}, 'needs contact.roughness = "discrete"'),
        (GEARS, {"mesh.pitch_error_seed": "seeds"}, {}, "needs mesh.pitch_error_rms above 0"),
        (GEARS, SEEDS, {"of": "sticks"}, "needs keys beside"),
        (GEARS, {}, {}, "must be a table"),
        (GEARS, {**SEEDS, "drive.torque": "seeds"}, {}, "must be one of normal"),
    )
    for scene, vary, more, words in cases:
        with pytest.raises(gd.SceneError, match=words):
            gd.studies.ensemble(scene, vary, 4, **more)


def test_the_command_takes_seeds(tmp_path, capsys):
    out, case = str(tmp_path / "out.nc"), tmp_path / "own.toml"
    case.write_text(gd.dump_case(GEARS), encoding="utf-8")
    assert main(["ensemble", str(case), "--vary", "contact.seed=seeds", "--size", "4", "-o", out]) == 0
    assert "+-" in capsys.readouterr().out
    assert main(["report", out, "-o", str(tmp_path / "out.html")]) == 0
    assert "one specimen" in (tmp_path / "out.html").read_text(encoding="utf-8")
    assert main(["plot", out, "-o", str(tmp_path / "out.png")]) == 0


def test_probability_of_sticking_over_seeds_and_coverage():
    """Of a sweep and of an ensemble by one study; the seed itself is no axis."""
    still = GEARS.replace({"initial.gear_speed": 0.0, "drive.torque": 1e-12, "load.torque": 0.0})
    still = still.replace({"run.duration": "0.5 ms", "contact.seed": 0, "mesh.damping": 7e-6})
    over = {"coating.sam_fraction": [1.0, 0.0], "contact.seed": [0, 1, 2, 3, 4, 5]}
    ds = gd.sweep(still, over, keep=["verdict"])
    along = gd.studies.sticking_probability(ds, "coating.sam_fraction")
    assert along.sam_fraction.values.tolist() == [0.0, 1.0]
    assert along.members.values.tolist() == [6, 6]
    stuck = np.isin(ds.verdict.values, ["sticks", "runs back"]).sum(axis=1)
    assert along.stuck.values.tolist() == stuck[::-1].tolist()
    assert stuck[1] > stuck[0]  # bare teeth hold the gear, coated ones do not
    assert int(gd.studies.sticking_probability(ds).members) == 12
    with pytest.raises(gd.SceneError, match=r"coating\.sam_fraction"):
        gd.studies.sticking_probability(ds, "contact.seed")
    ax = gd.plot.sticking_probability(ds)
    assert ax.get_lines()[0].get_ydata().tolist() == along.probability.values.tolist()
    ensemble = gd.studies.ensemble(still.replace({"coating.sam_fraction": 0.0}), SEEDS, 6)
    assert ensemble.sticks.sum() == stuck[1]


def test_a_picture_has_the_mean_of_the_specimens(specimens):
    ax = gd.plot.specimens(specimens)
    ax.figure.canvas.draw()
    steps, mean = ax.get_lines()[:2]
    assert steps.get_xdata().tolist() == sorted(specimens.settled_gear_speed.values)
    assert mean.get_xdata()[0] == pytest.approx(float(specimens.settled_gear_speed.mean()), rel=1e-14)
    with pytest.raises(gd.SceneError, match="figure"):
        gd.plot.specimens(specimens, of="verdict_words")


def test_one_run_is_called_one_specimen(tmp_path, capsys):
    case, out = tmp_path / "own.toml", str(tmp_path / "out.nc")
    case.write_text(gd.dump_case(GEARS), encoding="utf-8")
    assert main(["run", str(case), "-o", out]) == 0
    printed = capsys.readouterr().out
    assert "one specimen" in printed
    assert "contact.seed=seeds" in printed
    assert "mean over many gears" not in printed
    assert main(["check", str(case)]) == 0
    assert "one specimen" in capsys.readouterr().out
    ds = gd.open_archive(out)
    assert gd.plot.overview(ds).get_suptitle().endswith("one specimen, seed 5")
    assert main(["report", out, "-o", str(tmp_path / "out.html")]) == 0
    assert "This is one specimen" in (tmp_path / "out.html").read_text(encoding="utf-8")


def test_a_probability_over_seeds_alone_names_those_that_were_drawn():
    teeth = gd.preset("teodorescu2009").replace(
        {"mesh.pitch_error_rms": "3 nm", "run.duration": 10e-6, "run.samples": 11}
    )
    ds = gd.studies.ensemble(teeth, {"mesh.pitch_error_seed": "seeds"}, 2)
    for ask in (gd.studies.sticking_probability, gd.plot.sticking_probability):
        with pytest.raises(gd.SceneError, match=r"over = mesh\.pitch_error_seed: .*seeds alone"):
            ask(ds, "mesh.pitch_error_seed")
    with pytest.raises(gd.SceneError, match=r"over = mesh\.pitch_error_seed: "):
        gd.plot.sticking_probability(ds)
