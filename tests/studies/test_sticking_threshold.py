"""The sticking threshold against runs of its own, and what may not matter to it."""

from __future__ import annotations

import math

import numpy as np
import pytest
import xarray as xr

import gearidae as gd
from gearidae.analysis.verdict import outcomes
from gearidae.cli import main
from gearidae.runs.running import unsolved
from gearidae.studies import sticking_threshold as study
from gearidae.studies import threshold_run
from gearidae.studies.declared import threshold

LOW = gd.preset("teodorescu2009_low_speed").replace(
    {"run.rtol": 1e-4}
)  # stuck teeth ring: a tenth of the steps
BETWEEN = (0.4, 0.6)
WIDTH = 0.0125


@pytest.fixture(scope="module")
def brackets():
    return gd.studies.sticking_threshold(LOW, between=BETWEEN, exits=5, width=WIDTH)


def test_runs_of_their_own_stick_and_turn_at_the_bracket(brackets):
    """Six exits take 0.33 s at the steady speed of 1.5 rad/s: a run at either end says what the bracket says."""
    bracket = brackets.sel(exits=5)
    assert 0.0 < float(bracket.passes - bracket.sticks) <= WIDTH
    assert float(bracket.limit) == pytest.approx(0.5 * float(bracket.sticks + bracket.passes), rel=1e-15)
    pitch = 2.0 * math.pi / (76 * 1.5)
    for name, passed in (("sticks", False), ("passes", True)):
        scene = LOW.replace({"coating.sam_fraction": float(bracket[name]), "run.duration": 9.0 * pitch})
        (outcome,) = outcomes(gd.simulate(scene))
        assert (outcome.mesh_exits >= 5) is passed


def test_a_run_answers_for_all_numbers_of_exits(brackets):
    assert brackets.exits.values.tolist() == [1, 2, 5]
    assert np.isnan(brackets.limit.values[:2]).all()  # none sticks at the first two
    later = gd.studies.sticking_threshold(LOW, between=(0.6, 0.4), exits=10, width=WIDTH)
    assert float(later.limit.sel(exits=5)) == pytest.approx(float(brackets.limit[-1]), abs=WIDTH)
    assert (
        float(later.limit[-1]) > float(later.limit.sel(exits=5)) + 0.05
    )  # the longer one waits the more sticks
    stuck = later.exits_passed.values < 10
    assert np.isfinite(later.stick_time.values[stuck]).all()
    assert (later.stick_time.values[stuck] < later.simulated_time.values[stuck]).all()


def failing(monkeypatch, module, name, fails):
    """Let runs of some scenes fail."""
    usual = getattr(module, name)
    monkeypatch.setattr(
        module,
        name,
        lambda scene, *more: unsolved("failed", "of a test") if fails(scene) else usual(scene, *more),
    )


def test_a_run_that_fails_is_left_out_and_named(brackets, monkeypatch, caplog):
    """The first point between the ends fails: the bracket is found all the same, beside it."""
    failing(monkeypatch, threshold_run, "solve_any_to_end", lambda scene: scene.coating.sam_fraction == 0.45)
    other = gd.studies.sticking_threshold(LOW, between=BETWEEN, exits=5, width=WIDTH)
    assert "one run is left out: the run at 0.45 could not be finished: of a test" in caplog.text
    assert other.attrs["left_out"] == 1
    assert 0.45 not in other.value.values
    bracket = other.sel(exits=5)
    assert float(bracket.sticks) <= float(bracket.passes)
    assert float(bracket.limit) == pytest.approx(float(brackets.limit.sel(exits=5)), abs=0.05)
    assert ("runs", str(other.sizes["run"]), "1 more could not be finished") in tuple(threshold._rows(other))


def test_a_bracket_whose_inner_runs_all_fail_stays_as_it_is(monkeypatch):
    failing(
        monkeypatch, threshold_run, "solve_any_to_end", lambda scene: 0.4 < scene.coating.sam_fraction < 0.6
    )
    bracket = gd.studies.sticking_threshold(LOW, between=BETWEEN, exits=5, width=0.01).sel(exits=5)
    assert (float(bracket.sticks), float(bracket.passes)) == BETWEEN


def test_an_end_that_fails_is_an_error(monkeypatch):
    failing(monkeypatch, threshold_run, "solve_any_to_end", lambda scene: scene.coating.sam_fraction == 0.6)
    with pytest.raises(gd.SolverError, match=r"the run at 0\.6 could not be finished: of a test"):
        gd.studies.sticking_threshold(LOW, between=BETWEEN, exits=5, width=0.01)


@pytest.mark.parametrize(
    ("settings", "key"),
    [
        ({"between": (0.9, 1.0)}, "between"),  # turns at both
        ({"between": (0.5, 0.5)}, "between"),
        ({"over": "contact.bodies", "between": ("elastic", "rigid")}, "over"),
        ({"exits": 0}, "exits"),
        ({"width": 0.0}, "width"),
        ({"executor": 3}, "executor"),
        ({"resume": True}, "resume"),
    ],
)
def test_bad_requests_are_refused(settings, key):
    with pytest.raises(gd.SceneError) as refused:
        study(LOW, **({"between": BETWEEN, "exits": 2} | settings))
    assert refused.value.key == key


def test_scenes_without_a_threshold_are_refused():
    with pytest.raises(gd.SceneError):
        study(gd.preset("roller_slow"), between=BETWEEN)
    with pytest.raises(gd.SceneError, match="schedule"):
        study(LOW.replace({"drive.schedule": [[0.0, 0.0], [0.1, 1e-18]]}), between=BETWEEN)


HEAVY = LOW.replace(
    {
        "coating.sam_fraction": 1.0,
        "load.torque": 3e-18,
        "load.viscous": 1e-17,
        "drive.torque": 5e-18,
        "initial.gear_speed": 0.0,
    }
)
"""A dry load, which the drive overcomes above a quarter of it, 7.5e-19 N m; the speed is that of the excess over c."""


def test_gears_that_are_only_slow_do_not_count_as_sticking(caplog):
    """Close above the dry load a gear needs more time than it gets: it does not narrow the bracket."""
    between, width = (7e-19, 1e-18), 5e-20
    ds = gd.studies.sticking_threshold(HEAVY, "drive.torque", between, exits=2, width=width)
    assert (ds.sticks <= 7.5e-19).all()
    assert (ds.passes > 7.5e-19).all()
    slow = ds.value.values[(ds.exits_passed.values < 2) & (ds.value.values > 7.5e-19)]
    assert len(slow) == caplog.text.count("one run says nothing of more mesh exits: at ") > 0
    assert (float(ds.passes[0]) <= slow).any()  # it has passed one exit, and counts for it
    assert "of 2 mesh exits and does not stick" in caplog.text
    with pytest.raises(gd.SceneError, match=r"between .* the gear is slow"):
        gd.studies.sticking_threshold(HEAVY, "drive.torque", (slow[0], 1e-18), exits=2, width=width)


def test_the_command_prints_the_brackets(brackets, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(threshold, "_WIDTH", 0.25)
    command = [
        "threshold",
        "teodorescu2009_low_speed",
        "--over",
        "coating.sam_fraction=0.4,0.6",
        "--exits",
        "5",
    ]
    assert main(command) == 0
    printed = capsys.readouterr().out
    with xr.open_dataset("teodorescu2009_low_speed_threshold.nc") as kept:
        limit = float(kept.limit[-1])
    assert limit == pytest.approx(float(brackets.limit[-1]), abs=0.05)
    assert "within 5 mesh exits" in printed
    assert f"{limit:.4g}" in printed
    assert "no run has stuck so early" in printed
    assert main([*command[:-1], "0", "--overwrite"]) == 2


def test_each_gear_of_a_design_has_a_limit_of_its_own():
    """That of a gear is what a search of its own finds; mean and deviation are those of the limits."""
    teeth = LOW.replace({"mesh.pitch_error_rms": "3 nm", "mesh.pitch_error_seed": 4})
    options = {"between": (0.3, 0.8), "exits": 2, "width": 0.1}
    found = gd.studies.sticking_threshold(teeth, seeds=2, **options)
    assert found.seed.values.tolist() == [4, 5]
    alone = gd.studies.sticking_threshold(teeth.replace({"mesh.pitch_error_seed": 5}), **options)
    for name in ("limit", "sticks", "passes"):
        np.testing.assert_array_equal(found[name].sel(seed=5), alone[name])
    assert (found.gear.values == 5).sum() == alone.sizes["run"]
    limits = found.limit.values[:, -1]
    assert float(found["mean"][-1]) == pytest.approx(limits.mean(), rel=1e-12)
    assert float(found.deviation[-1]) == pytest.approx(limits.std(ddof=1), rel=1e-9, abs=1e-15)


def test_gears_that_do_alike_at_both_ends_have_no_limit_and_say_so(monkeypatch):
    teeth = LOW.replace({"mesh.pitch_error_rms": "3 nm"})
    usual = threshold._check_ends

    def alike(pool, ends):
        usual(pool, ends if pool.scene.mesh.pitch_error_seed else (ends[1], ends[1]))

    monkeypatch.setattr(threshold, "_check_ends", alike)
    found = gd.studies.sticking_threshold(teeth, between=(0.3, 0.8), exits=2, width=0.5, seeds=2)
    assert np.isnan(found.limit.sel(seed=0)).all()
    assert "at both it passes them" in str(found.message.sel(seed=0).values)
    assert int(found.stuck[-1]) == 1
    for wrong, words in ((0, "seeds = 0"), (2, r"seeds = 2: needs .*mesh\.pitch_error_rms")):
        with pytest.raises(gd.SceneError, match=words):
            gd.studies.sticking_threshold(teeth if wrong == 0 else LOW, between=(0.3, 0.8), seeds=wrong)
