"""Ensembles: each member is the run it says it is, whatever happens on the way."""

from __future__ import annotations

from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor

import numpy as np
import pytest
import xarray as xr
from scipy import stats

import gearidae as gd
from gearidae.analysis.verdict import outcomes
from gearidae.analysis.verdict.codes import VerdictCode, sticking, verdict_codes
from gearidae.analysis.verdict.judge import verdict_of
from gearidae.archive import to_dataset
from gearidae.cli import main
from gearidae.cli.study_commands import Request
from gearidae.errors import Interrupted
from gearidae.records import EventKind
from gearidae.runs import batch
from gearidae.runs.running import solve, unsolved
from gearidae.scene.prefixes import with_prefix
from gearidae.studies.declared.ensemble import _rows, _sentence
from sweeps import without_times

LOW = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 2e-3, "run.samples": 11})
VARY = {"coating.sam_fraction": "uniform(0.5, 1)", "drive.torque": stats.norm(4.5e-18, 1e-19)}
STICKING = gd.preset("teodorescu2009_low_speed").replace(
    {"drive.torque": 4.2e-18, "run.rtol": 1e-4}  # stuck teeth ring: a tenth of the steps
)


@pytest.fixture(scope="module")
def ensemble():
    return gd.studies.ensemble(LOW, VARY, 8, of="min_gear_speed", seed=3)


@pytest.fixture(scope="module")
def stuck():
    return gd.studies.ensemble(STICKING, {"coating.sam_fraction": "uniform(0.4, 0.65)"}, 24)


def test_a_member_is_the_run_of_its_scene(ensemble):
    assert ensemble.sizes["member"] == 8 * 4
    for number in (0, 13, 31):
        drawn = ensemble.isel(member=number)
        scene = LOW.replace(
            {"coating.sam_fraction": float(drawn.sam_fraction), "drive.torque": float(drawn.torque)}
        )
        assert drawn.gearidae.scene == scene.replace({"run.samples": "off"})
        alone = gd.simulate(scene)
        assert float(drawn.min_gear_speed) == float(alone.min_gear_speed)
        assert float(drawn.largest_mesh_force) == float(alone.largest_mesh_force)
        (outcome,) = outcomes(alone)
        assert (drawn.verdict.item(), drawn.impacts.item()) == (outcome.verdict, outcome.impacts)
        assert VerdictCode(drawn.verdict_code.item()).word == outcome.verdict


def test_members_of_other_coefficients_of_friction():
    """More friction, less speed: within half a per cent of the closed form, which knows no start."""
    scene = gd.preset("teodorescu2009").replace({"drive.harmonic": None, "run.duration": 2e-4})
    ensemble = gd.studies.ensemble(scene, {"contact.friction": "uniform(0, 0.3)"}, 2, of="settled_gear_speed")
    coefficients, where = np.unique(ensemble.friction.values, return_index=True)
    speeds = ensemble.settled_gear_speed.values[where]
    assert where.size > 3
    assert (np.diff(speeds) < 0.0).all()
    expected = [gd.studies.steady_speed(scene.replace({"contact.friction": mu})) for mu in coefficients]
    np.testing.assert_allclose(speeds, expected, rtol=5e-3)


def test_a_run_is_judged_alike_with_and_without_a_dataset():
    for scene in (
        LOW,
        gd.preset("roller_slow").replace({"contact.bodies": "rigid"}),
        gd.preset("start_up").replace({"run.duration": "10 ms"}),
    ):
        solution = solve(scene.replace({"run.samples": "off"}), "auto")
        (outcome,) = outcomes(to_dataset(scene.replace({"run.samples": "off"}), solution))
        changes = int((solution.events.kind == EventKind.FLANK_CHANGE).sum())
        assert verdict_of(scene, solution) == (outcome.verdict, outcome.impacts, changes)
    assert verdict_of(LOW, unsolved("failed", "of a test")) == ("unfinished", 0, 0)


def test_codes_stand_for_words():
    words = np.array([["sticks", "turns smoothly"], ["runs back", "unfinished"]])
    codes = verdict_codes(words)
    assert [[VerdictCode(code).word for code in row] for row in codes.tolist()] == words.tolist()
    np.testing.assert_array_equal(sticking(codes), [[1.0, 0.0], [1.0, np.nan]])


def test_indices_are_those_of_the_figure(ensemble):
    """The speed falls where adhesion or a weaker drive holds the gear: both keys, and nothing else, matter."""
    assert ensemble.attrs["index_of"] == "min_gear_speed"
    assert ensemble.attrs["index_rows"] == 8
    assert ensemble.parameter.values.tolist() == list(VARY)
    assert float(ensemble.total_order.sum()) > 0.5
    assert (ensemble.total_order_uncertainty.values > 0.0).all()
    assert ensemble.matrix.values[::8].tolist() == ["A", "B", "AB0", "AB1"]


def test_executors_and_the_archive_do_not_matter(ensemble, tmp_path):
    target = tmp_path / "out.nc"
    with ThreadPoolExecutor(1) as executor:
        other = gd.studies.ensemble(
            LOW, VARY, 8, of="min_gear_speed", seed=3, executor=executor, archive=target
        )
    xr.testing.assert_identical(without_times(other), without_times(ensemble))
    again = gd.open_archive(target)
    xr.testing.assert_identical(without_times(again), without_times(ensemble))
    assert again.gearidae.verdicts().equals(other.gearidae.verdicts())
    whole = gd.studies.ensemble(LOW, VARY, 8, of="min_gear_speed", seed=3, archive=target, resume=True)
    assert whole.attrs["date_created"] == other.attrs["date_created"]  # nothing has been run
    with pytest.raises(gd.SceneError, match="of another sweep"):
        gd.studies.ensemble(LOW, VARY, 8, of="max_gear_speed", seed=3, archive=target, resume=True)
    assert main(["info", str(target)]) == 0


def test_members_that_ctrl_c_has_cut_off_are_unfinished():
    def cut_off(done, total):
        if done >= 12:  # the twelfth run is reported while it is under way, too
            raise KeyboardInterrupt

    with pytest.raises(Interrupted) as interrupted:
        gd.studies.ensemble(LOW, VARY, 8, of="min_gear_speed", seed=3, progress=cut_off, jobs=1)
    part = interrupted.value.dataset
    assert 11 <= (part.status == "finished").sum() < 32
    assert np.isfinite(part.sticks).sum() == (part.status == "finished").sum()


def test_members_that_fail_are_named_and_kept(monkeypatch, tmp_path):
    """Every run below a coverage of 0.6 dies with its worker."""

    def deed(scene, backend, keep, on_progress=None):
        if scene.coating.sam_fraction < 0.6:
            raise MemoryError("of a test")
        return solved(scene, backend, keep, on_progress)

    solved = batch.solve_and_leave
    monkeypatch.setattr(batch, "solve_and_leave", deed)
    ds = gd.studies.ensemble(LOW, {"coating.sam_fraction": "uniform(0.5, 1)"}, 16, of="min_gear_speed")
    failed = ds.sam_fraction.values < 0.6
    assert 0 < failed.sum() < 48
    assert (ds.status.values[failed] == "crashed").all()
    assert (ds.message.values[failed] == "MemoryError: of a test").all()
    assert (ds.verdict_code.values[failed] == VerdictCode.UNFINISHED).all()
    assert np.isnan(ds.sticks.values[failed]).all()
    assert (ds.status.values[~failed] == "finished").all()
    assert ds.attrs["index_rows"] == 8  # of 16, some of which are incomplete
    counted = int(gd.studies.sticking_probability(ds).members)
    assert _sentence(ds).startswith(f"0 of {counted} members stick")
    assert _sentence(ds).endswith(f"; {failed.sum()} of 48 are unfinished and do not count.")
    gd.save(ds, tmp_path / "failed.nc")
    assert (gd.open_archive(tmp_path / "failed.nc").status.values == ds.status.values).all()


def test_members_without_the_figure_are_counted(caplog):
    """A gear that turns has no time at which it sticks: the indices rest on the rows in which all members stick."""
    vary = {"coating.sam_fraction": "uniform(0.3, 0.6)"}
    ds = gd.studies.ensemble(STICKING, vary, 8, of="stick_time")
    none = np.isnan(ds.stick_time.values)
    assert 0 < none.sum() < none.size
    table = ds.stick_time.values.reshape(3, 8)
    complete = int(np.isfinite(table).all(axis=0).sum())
    assert ds.attrs["index_rows"] <= complete < 8
    assert f"{none.sum()} of {none.size} members have no stick_time" in caplog.text
    assert np.isnan(ds.total_order).all()  # of less than eight rows
    (row,) = [row for row in _rows(ds) if row[0] == "stick time"]
    assert row[2].endswith(f"of the {(~none).sum()} members that have one")
    middle = np.nanquantile(ds.stick_time.values, 0.5)
    assert row[1] == with_prefix(float(middle), "s", 4)


def test_draws_outside_of_a_key_are_refused_with_their_number():
    with pytest.raises(gd.SceneError) as refused:
        gd.studies.ensemble(LOW, {"coating.sam_fraction": "normal(0.9, 0.1)"}, 64)
    assert refused.value.key == "coating.sam_fraction"
    beyond = int((stats.norm(0.9, 0.1).ppf((np.arange(64) + 0.5) / 64) > 1.0).sum())
    assert f"{beyond} of 64" in str(refused.value)
    assert "truncnormal" in str(refused.value)
    assert "normal(0.9, 0.1)" in str(refused.value)


@pytest.mark.parametrize(
    ("settings", "key"),
    [
        ({"size": 12}, "size"),
        ({"of": "min_gear_sped"}, "of"),
        ({"design": "latin"}, "design"),
        ({"executor": 3}, "executor"),
        ({"resume": True}, "resume"),
        ({"jobs": 0}, "jobs"),
    ],
)
def test_bad_requests_are_refused(settings, key):
    with pytest.raises(gd.SceneError) as refused:
        gd.studies.ensemble(LOW, VARY, **({"size": 8, "of": "sticks"} | settings))
    assert refused.value.key == key


def test_a_roller_has_ensembles_too():
    roller = gd.preset("roller_slow").replace({"contact.bodies": "rigid"})
    ds = gd.studies.ensemble(roller, {"roller.speed": "uniform(5 mm/s, 15 mm/s)"}, 4, of="largest_mesh_force")
    assert set(ds.verdict.values) <= {"rebounds", "sticks", "flies"}
    assert "min_gear_speed" not in ds


def test_probability_of_sticking_is_the_share_of_members(stuck):
    """Bins of equal counts; Wilson's interval by its closed form."""
    whole = gd.studies.sticking_probability(stuck)
    share, n, z = float(stuck.sticks.mean()), 24, stats.norm.ppf(0.975)
    assert 0.1 < share < 0.9
    assert float(whole.probability) == share
    middle, half = share + z**2 / (2 * n), z * np.sqrt(share * (1 - share) / n + z**2 / (4 * n**2))
    assert float(whole.low) == pytest.approx((middle - half) / (1 + z**2 / n), rel=1e-9)
    assert float(whole.high) == pytest.approx((middle + half) / (1 + z**2 / n), rel=1e-9)
    bins = gd.studies.sticking_probability(stuck, "coating.sam_fraction", bins=4)
    assert bins.members.values.tolist() == [6] * 4
    assert int(bins.stuck.sum()) == int(stuck.sticks.sum())
    assert float(bins.probability[0]) > 0.8 > 0.2 > float(bins.probability[-1])
    inside = (stuck.sam_fraction >= bins.lowest[1]) & (stuck.sam_fraction <= bins.highest[1])
    assert float(bins.probability[1]) == float(stuck.sticks.values[inside.values].mean())


def test_mixed_members_do_not_count_as_drawn(ensemble):
    assert int(gd.studies.sticking_probability(ensemble).members) == 16


def test_probabilities_that_cannot_be_had(ensemble, stuck):
    for ds, over, bins, key in (
        (LOW and gd.sweep(LOW, {"coating.sam_fraction": [1.0]}), None, None, "dataset"),
        (stuck, "drive.torque", None, "over"),
        (stuck, "coating.sam_fraction", 0, "bins"),
        (ensemble.assign(sticks=ensemble.sticks * np.nan), None, None, "dataset"),
    ):
        with pytest.raises(gd.SceneError) as refused:
            gd.studies.sticking_probability(ds, over, bins=bins)
        assert refused.value.key == key


def test_pictures(ensemble, stuck):
    ax = gd.plot.sobol_indices(ensemble)
    assert [text.get_text() for text in ax.get_yticklabels()][-1] == str(
        ensemble.parameter.values[np.argmax(ensemble.total_order.values)]
    )
    ax.figure.canvas.draw()
    ax = gd.plot.sticking_probability(stuck, bins=5)
    assert ax.get_xlabel() == "SAM (%)"
    assert ax.get_lines()[0].get_ydata().tolist() == (
        gd.studies.sticking_probability(stuck, "coating.sam_fraction", bins=5).probability.values.tolist()
    )
    ax.figure.canvas.draw()
    one = gd.studies.sticking_probability(stuck, "coating.sam_fraction", bins=1)
    (bar,) = gd.plot.sticking_probability(stuck, bins=1).collections
    assert bar.get_segments()[0][:, 1].tolist() == [one.low.item(), one.high.item()]
    with pytest.raises(gd.SceneError, match="of=figure"):
        gd.plot.sobol_indices(stuck)


@pytest.mark.parametrize(
    ("key", "members", "workers", "kind"),
    [
        ("surface.asperity_radius", 64, 2, ProcessPoolExecutor),
        ("coating.energy", 64, 2, ProcessPoolExecutor),
        ("surface.asperity_radius", 64, 1, type(None)),
        ("surface.asperity_radius", 8, 2, type(None)),
        ("coating.sam_fraction", 64, 2, type(None)),
    ],
)
def test_the_command_takes_processes_where_each_member_needs_tables_of_its_own(key, members, workers, kind):
    request = Request(jobs=workers)
    with request.executor([key], members) as executor:  # no process is started before the first run
        assert type(executor) is kind


def test_the_command(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    command = [
        *("ensemble", "teodorescu2009_low_speed", "--set", "run.duration=2 ms", "--size", "4"),
        *("--vary", "coating.sam_fraction=uniform(0.5, 1)", "drive.torque=normal(4.5e-18 N m, 1e-19 N m)"),
        *("--of", "min_gear_speed", "--seed", "3"),
    ]
    assert main(command) == 0
    printed = capsys.readouterr().out
    assert "probability of sticking" in printed
    assert "turns smoothly" in printed
    target = "teodorescu2009_low_speed_ensemble.nc"
    ds = gd.open_archive(target)
    assert ds.sizes["member"] == 16
    assert main(command) == 2
    assert main([*command, "--resume"]) == 0
    assert main(["plot", target]) == 0
    assert (tmp_path / "teodorescu2009_low_speed_ensemble.png").exists()
    capsys.readouterr()
    wrong = ["--vary", "coating.sam_fraction=normal(0.9)", "--size", "4", "-o", "other.nc"]
    assert main([*command[:4], *wrong]) == 2
    assert "normal(mean, standard deviation)" in capsys.readouterr().err
