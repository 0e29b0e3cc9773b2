"""Convergence of quantities: against a closed form and runs made by hand, and its judgement of known sequences."""

from __future__ import annotations

import numpy as np
import pytest

import gearidae as gd
from gearidae.cli import main
from gearidae.studies.declared.convergence import LADDER, judge

RUNGS = np.array(LADDER)
ELASTIC = gd.preset("roller_slow").replace({"contact.asperity": "hertz", "contact.bodies": "rigid"})
"""Nothing is lost: the roller leaves as fast as it has come."""
SHORT = (1e-4, 1e-6, 1e-8)


def scattered(scatter, seed=1):
    """Nine runs at each tolerance, about 2, with a relative standard deviation for each tolerance."""
    random = np.random.default_rng(seed)
    return 2.0 * (
        1.0 + np.broadcast_to(scatter, RUNGS.shape)[:, None] * random.standard_normal((RUNGS.size, 9))
    )


@pytest.fixture(scope="module")
def elastic():
    return gd.studies.convergence(ELASTIC, ["final_speed", "height"], target=1e-4, rtols=SHORT)


def test_errors_are_those_of_a_closed_form(elastic):
    speed = elastic.sel(figure="final_speed")
    exact = ELASTIC.roller.speed
    true = np.sqrt(((np.abs(speed["value"]) / abs(exact) - 1.0) ** 2).mean("run"))
    assert abs(abs(float(speed["reference"])) / abs(exact) - 1.0) <= float(speed["error"][-1])
    # the reference is out by the error at the tightest tolerance, a hundredth of the others or less
    np.testing.assert_allclose(speed["error"][:-1], true[:-1], rtol=0.05)
    assert float(true[-1]) <= 3.0 * float(speed["error"][-1])


def test_values_are_those_of_runs_made_by_hand(elastic):
    for number, rtol in enumerate(SHORT):
        run = gd.simulate(ELASTIC, rtol=rtol, samples=2)
        first = elastic["value"].isel(rtol=number, run=0)
        assert float(first.sel(figure="final_speed")) == float(run["final_speed"])
        assert float(first.sel(figure="height")) == float(run["height"][-1])


def test_tighter_tolerances_take_more_steps(elastic):
    assert (np.diff(elastic["steps"]) > 0).all()
    assert (elastic["unfinished"] == 0).all()


def test_the_verdict_is_the_loosest_tolerance_within_the_target(elastic):
    speed = elastic.sel(figure="final_speed")
    assert speed["verdict"].item() == "converges"
    loosest = max(rtol for rtol, error in zip(SHORT, speed["error"].values, strict=True) if error <= 1e-4)
    assert float(speed["rtol_to_take"]) == loosest
    assert float(speed["time_to_take"]) == float(speed["wall_time"].sel(rtol=loosest))


def test_a_scatter_that_falls_with_the_tolerance_converges():
    judgement = judge(scattered(5.0 * RUNGS), RUNGS, 1e-3)
    assert (judgement["verdict"], judgement["rtol_to_take"]) == ("converges", 1e-4)
    # nine runs know a standard deviation to a quarter; the tightest tolerance has the reference for its mean
    np.testing.assert_allclose(judgement["scatter"], 5.0 * RUNGS, rtol=0.75)
    np.testing.assert_allclose(judgement["error"][:-1], 5.0 * RUNGS[:-1], rtol=0.75)


def test_an_error_without_scatter_is_the_distance_to_the_tightest():
    values = np.repeat((1.0 + 50.0 * RUNGS)[:, None], 9, axis=1)
    judgement = judge(values, RUNGS, 1e-3)
    np.testing.assert_allclose(judgement["error"][:-1], 50.0 * (RUNGS[:-1] - RUNGS[-1]), rtol=1e-6)
    assert judgement["rtol_to_take"] == 1e-5
    # of the first order, a tenth of the last difference is what remains, but for a tenth of that
    assert judgement["error"][-1] == pytest.approx(50.0 * RUNGS[-1], rel=0.11)


def test_a_scatter_that_stays_is_chaos_and_says_how_many_starts_a_mean_needs():
    judgement = judge(scattered(0.005), RUNGS, 1e-3)
    assert judgement["verdict"] == "chaotic"
    # (0.005 / 0.001)^2 = 25; eighteen runs know the deviation to 17 %, its square to 34 %
    assert 25.0 * (1.0 - 3 * 0.17) ** 2 < judgement["starts"] < 25.0 * (1.0 + 3 * 0.17) ** 2
    assert np.isnan(judgement["rtol_to_take"])


def test_a_scatter_that_falls_but_not_far_enough_is_not_yet():
    assert judge(scattered(1e5 * RUNGS), RUNGS, 1e-6)["verdict"] == "not yet"


def test_outcomes_that_differ_between_neighbours_are_chaos():
    values = scattered(1e-6)
    values[-1, 4] = np.nan
    judgement = judge(values, RUNGS, 1e-3)
    assert judgement["verdict"] == "chaotic"
    assert np.isnan(judgement["starts"])


def test_a_value_that_loose_runs_lack_and_tight_ones_have_converges():
    values = scattered(1e-6)
    values[0, 4] = np.nan
    judgement = judge(values, RUNGS, 1e-3)
    assert (judgement["verdict"], judgement["rtol_to_take"]) == ("converges", 1e-4)


def test_no_value_at_all():
    assert judge(np.full((RUNGS.size, 9), np.nan), RUNGS, 1e-3)["verdict"] == "none"


def test_a_quantity_that_is_zero_converges():
    judgement = judge(np.zeros((RUNGS.size, 9)), RUNGS, 1e-3)
    assert (judgement["verdict"], judgement["rtol_to_take"]) == ("converges", 1e-3)


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"of": ["loss_of_nerve"]}, "of = loss_of_nerve"),
        ({"of": ["events"]}, "of = events"),
        ({"target": 0.0}, "target = 0"),
        ({"rtols": [1e-4, 1e-5]}, "rtols = .*three tolerances"),
        ({"rtols": [1e-4, 1e-5, 1e-20]}, "run.rtol"),
    ],
)
def test_bad_input_is_named_before_anything_is_run(settings, words, monkeypatch):
    monkeypatch.setattr("gearidae.engine.solve", None)
    with pytest.raises(gd.SceneError, match=words):
        gd.studies.convergence(ELASTIC, **settings)


def test_the_command(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    of = ["--of", "final_speed", "largest_mesh_force", "--target", "0.1 %"]
    assert main(["convergence", "roller_slow", *of]) == 0
    shown = capsys.readouterr().out
    assert "Convergence of roller_slow: 63 runs, with tolerances from 0.001 to 1e-09" in shown
    assert "To 0.1 %: final_speed converges at rtol" in shown
    assert "largest_mesh_force converges at rtol" in shown
    assert (tmp_path / "roller_slow_convergence.nc").exists()
    assert main(["convergence", "roller_slow", *of, "--resume"]) == 0


def test_a_line_for_each_quantity(elastic):
    ax = gd.plot.convergence(elastic)
    assert [text.get_text() for text in ax.get_legend().get_texts()] == [
        "final_speed: converges", f"height: {elastic['verdict'].sel(figure='height').item()}", "target"
    ]  # fmt: skip
    np.testing.assert_allclose(ax.lines[0].get_ydata(), 100.0 * elastic["error"].sel(figure="final_speed"))
