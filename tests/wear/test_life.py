"""The life of a coating: rates from windows, resuming, and what the dataset says."""

import json
import sys

import numpy as np
import pytest

import gearidae as gd
from gearidae.archive.exposures import flank_areas, gear_flank_areas
from gearidae.engine.observers.exposures.bins import ROWS
from gearidae.wear.lives.coverage import coverage_of
from gearidae.wear.lives.window import Cycles, run_window, steady_exposures, window_scene

LOW = gd.preset("teodorescu2009_low_speed").replace({"coating.sam_fraction": 0.7})
LAW = gd.wear.loss_law("adhesion_work", energy=1e-6)
SHORT = {"cycles": 3, "settle": 1, "starts": 1, "places": 4, "frequency": False}


@pytest.fixture(scope="module")
def short():
    return gd.studies.life(LOW, LAW, **SHORT, fraction=0.69)


def test_exposures_of_a_window_are_those_of_its_cycles():
    """One cycle and then three: what four have added up to, less the first."""
    scene = window_scene(LOW, Cycles(1, 3), 4)
    window, word = run_window(scene, Cycles(1, 3), "native")
    assert word == "turns"
    whole, _ = run_window(window_scene(LOW, Cycles(0, 4), 4), Cycles(0, 4), "native")
    first, _ = run_window(window_scene(LOW, Cycles(0, 1), 4), Cycles(0, 1), "native")
    sums = [
        np.array(solution.extremes.exposures).reshape(2, 19, -1, 4)[:, :, :-1].sum()
        for solution in (window, whole, first)
    ]
    assert sums[0] == pytest.approx(sums[1] - sums[2], rel=1e-3)
    assert window.extremes.mesh_exits == 4


def test_a_window_with_friction_goes_on_over_all_its_parts():
    """Its first part ends where one pair pulls."""
    cycles = Cycles(1, 2)
    scene = LOW.replace({"coating.sam_fraction": 0.6, "contact.friction": 0.1})
    window, word = run_window(window_scene(scene, cycles, 4), cycles, "native")
    assert (word, window.extremes.mesh_exits) == ("turns", 3)


def test_a_window_goes_on_until_the_motion_is_steady():
    """At 66 % the gear loses speed for some tens of cycles; 19 cycles after 6 show 14 % less than the steady ones."""
    scene = LOW.replace({"coating.sam_fraction": 0.66})

    def contacts(cycles):
        window, word = run_window(window_scene(scene, cycles, 4), cycles, "native")
        assert word == "turns"
        table = np.array(window.extremes.exposures).reshape(2, 19, -1, 4)[0, :, :3]
        return table.sum() / cycles.count, window.extremes.mesh_exits

    truth, _ = contacts(Cycles(80, 19))
    early, _ = contacts(Cycles(6, 19))
    steady, mesh_cycles = contacts(Cycles(6, 19, 3e-3))
    assert early < 0.9 * truth
    assert steady == pytest.approx(truth, rel=3e-3)
    assert mesh_cycles in (6 + 3 * 19, 6 + 4 * 19)


def test_blocks_that_fluctuate_are_averaged(monkeypatch):
    """No drift where the last two changes have different signs; of a drift what is still to come is estimated."""
    seen = []

    def blocks(*contacts):
        seen[:] = [np.full((2, ROWS.per_tooth(rubs=False), 4), number) for number in contacts]
        return steady_exposures(seen, 0.01)

    assert blocks(1.0) is None
    assert blocks(1.0, 1.1) is None
    assert blocks(1.0, 1.1, 1.15) is None  # 0.05 more and half of it
    np.testing.assert_array_equal(blocks(1.0, 1.1, 1.101), seen[-1])
    np.testing.assert_allclose(blocks(1.0, 1.1, 1.04), 1.07)
    np.testing.assert_array_equal(blocks(1.0, 1.001), seen[-1])
    assert blocks(*(1.2**number for number in range(7))) is None
    np.testing.assert_array_equal(blocks(*(1.2**number for number in range(8))), seen[-1])


def test_a_gear_that_stops_sticks():
    scene = window_scene(LOW.replace({"coating.sam_fraction": 0.4}), Cycles(1, 5), 4)
    assert run_window(scene, Cycles(1, 5), "native")[1]


def test_a_life_follows_its_rate(short):
    assert short.attrs["ending"] == "coverage"
    assert float(short.coverage[-1, 0]) == pytest.approx(0.69, abs=1e-6)
    assert (np.diff(short.coverage[:, 0]) < 0.0).all()
    # Q and the work on coated flank give the rate
    expected = short.coverage * short.passage_adhesion_work / 1e-6
    np.testing.assert_allclose(short.coverage_loss, expected, rtol=1e-12)
    assert set(short.verdict.values) == {"turns"}
    assert short.mean_gear_speed[0] == pytest.approx(1.5, abs=0.01)
    assert short.attrs["mesh_cycles_simulated"] >= 7 * short.attrs["windows"]  # one and two blocks of three
    assert short.attrs["mesh_cycles_direct"] == 0
    assert json.loads(short.attrs["law"]) == {"name": "adhesion_work", "energy": 1e-6}


def test_ten_times_the_energy_lasts_ten_times_as_long(short):
    slow = gd.studies.life(LOW, gd.wear.loss_law("adhesion_work", energy=1e-5), **SHORT, fraction=0.69)
    np.testing.assert_allclose(slow.passages, 10 * short.passages, rtol=1e-4)  # last digits of the states
    np.testing.assert_allclose(slow.coverage, short.coverage, rtol=1e-4)


def test_a_life_that_was_cut_off_is_resumed(short, tmp_path, monkeypatch):
    path = tmp_path / "life.nc"
    run, seen = run_window, []

    def cut(*args):
        seen.append(args)
        if len(seen) == 4:
            raise KeyboardInterrupt
        return run(*args)

    monkeypatch.setattr(sys.modules["gearidae.wear.lives.rates"], "run_window", cut)
    with pytest.raises(gd.Interrupted, match="resume") as stopped:
        gd.studies.life(LOW, LAW, **SHORT, fraction=0.69, archive=path)
    kept = gd.studies.open_life(path)
    assert (kept.attrs["ending"], kept.sizes["passages"]) == ("interrupted", 1)
    for ds in (kept, stopped.value.dataset):
        np.testing.assert_array_equal(ds.coverage_loss, short.coverage_loss[:1])
    with pytest.raises(gd.SceneError, match="cut off"):
        gd.studies.life(LOW, LAW, **SHORT, fraction=0.69, archive=path)
    resumed = gd.studies.life(LOW, LAW, **SHORT, fraction=0.69, archive=path, resume=True)
    for name in ("coverage", "coverage_loss", "passage_adhesion_work", "min_gear_speed"):
        np.testing.assert_array_equal(resumed[name], short[name])
    assert len(seen) - 1 == short.attrs["windows"]  # none was computed twice but for the one that was cut off
    assert path.exists()
    assert not path.with_name("life.nc.journal").exists()


def test_a_life_that_is_cut_off_in_its_last_cycles_is_resumed(tmp_path):
    """The law is so fast that no jump is worth its windows: cycle by cycle, which is done again."""
    law, path = gd.wear.loss_law("adhesion_work", energy=2e-10), tmp_path / "life.nc"
    whole = gd.studies.life(LOW, law, **SHORT, fraction=0.69)
    assert whole.attrs["mesh_cycles_direct"] > 10
    said = []

    def cut(done, of):
        said.append(done)
        if len(said) == 8:
            raise KeyboardInterrupt

    with pytest.raises(gd.Interrupted, match="resume"):
        gd.studies.life(LOW, law, **SHORT, fraction=0.69, archive=path, progress=cut)
    kept = gd.studies.open_life(path)
    assert kept.attrs["ending"] == "interrupted"
    np.testing.assert_array_equal(kept.coverage, whole.coverage[: kept.sizes["passages"]])
    resumed = gd.studies.life(LOW, law, **SHORT, fraction=0.69, archive=path, resume=True)
    for name in ("passages", "coverage", "coverage_loss", "passage_adhesion_work", "mean_gear_speed"):
        np.testing.assert_array_equal(resumed[name], whole[name])


def test_coverage_along_the_flank():
    scene = LOW.replace({"contact.bodies": "rigid"})
    life = gd.studies.life(scene, LAW, **SHORT, resolved="place", fraction=0.68)
    by_place = life.coverage_by_place.isel(side=0, tooth=0)
    assert by_place.dims == ("passages", "place")
    np.testing.assert_allclose(by_place[0], 0.7)
    assert float(by_place[-1].max() - by_place[-1].min()) > 1e-3  # it does not go evenly
    np.testing.assert_allclose(by_place.mean("place"), life.coverage.isel(side=0), rtol=1e-12)
    assert gd.plot.coverage_along_flank(life).get_xlabel() == "place along the path of contact (µm)"


def test_both_sides_of_independent_ones():
    """The gear's flank has the larger curvature and four times as many teeth: it loses less in the same time."""
    scene = LOW.replace({"coating.pairing": "independent", "coating.sam_fraction": 0.9})
    life = gd.studies.life(scene, LAW, **SHORT, fraction=0.89)
    assert life.side.values.tolist() == ["pinion", "gear"]
    lost = life.coverage[0] - life.coverage[-1]
    assert 0.0 < float(lost.sel(side="gear")) < 0.5 * float(lost.sel(side="pinion"))


@pytest.mark.parametrize("resolved", ["place", "tooth"])
def test_sides_by_place_add_up_to_uniform_ones(resolved):
    """Where all places are covered alike, they lose on average what uniform flanks lose."""
    changes = {"coating.pairing": "independent", "coating.pinion_fraction": 0.9, "coating.gear_fraction": 0.7}
    scene = LOW.replace({**changes, "contact.bodies": "rigid"})
    losses = []
    for resolution in ("uniform", resolved):
        coverage = coverage_of(scene, resolution, 4)
        window = window_scene(scene, Cycles(0, 2), 4).replace(coverage.changes(coverage.start))
        solution, _ = run_window(window, Cycles(0, 2), "native")
        rate = LAW.rate(coverage.start, coverage.exposure(window, solution, 2, coverage.start))
        areas = (flank_areas(window), gear_flank_areas(window))
        assert all(np.isfinite(rate))
        losses.append(
            [
                (part.mean(axis=0) * (area if part.shape[1] > 1 else 1.0)).sum()
                / (area.sum() if part.shape[1] > 1 else 1.0)
                for part, area in zip(coverage.split(rate), areas, strict=True)
            ]
        )
    assert losses[1] == pytest.approx(
        losses[0], rel=1e-3
    )  # motions by table and by fraction differ by rounding


def test_a_side_by_place_has_one_row_for_the_gear():
    scene = LOW.replace({"coating.pairing": "independent", "contact.bodies": "rigid"})
    table = np.full((76, 4), 0.5).tolist()
    with pytest.raises(gd.SceneError, match="one tooth") as error:
        coverage_of(scene.replace({"coating.gear_table": table}), "place", 4)
    assert error.value.key == "coating.gear_table"


def test_each_tooth_has_its_own_share():
    scene = LOW.replace({"contact.bodies": "rigid"})
    scene = scene.replace({"coating.pinion_table": np.linspace(0.7, 0.9, 19)[:, None].tolist()})
    coverage = coverage_of(scene, "tooth", 4)
    assert coverage.shapes == ((19, 4),)
    np.testing.assert_allclose(coverage.start.reshape(19, 4)[:, 2], np.linspace(0.7, 0.9, 19))
    again = scene.replace(coverage.changes(coverage.start))
    np.testing.assert_allclose(np.array(again.coating.pinion_table)[:, 0], np.linspace(0.7, 0.9, 19))


def test_the_picture(short):
    ax = gd.plot.life(short)
    np.testing.assert_allclose(ax.lines[0].get_ydata(), 100 * short.coverage[:, 0])
    assert ax.get_ylabel() == "coverage (%)"
    ringing = short.assign(characteristic_frequency=("passages", [1300.0, 2600.0]))
    _, right = gd.plot.life(ringing).figure.axes
    assert right.get_ylabel() == "characteristic frequency (kHz)"
    assert right.yaxis.get_major_formatter()(1300.0) == "1.3"
    with pytest.raises(gd.SceneError, match="coverage_by_place"):
        gd.plot.coverage_along_flank(short)


@pytest.mark.parametrize(
    ("changes", "key"),
    [
        ({"fraction": 1.0}, "fraction"),
        ({"passages": 0.0}, "passages"),
        ({"cycles": 0}, "cycles"),
        ({"places": 1}, "places"),
        ({"tolerance": 1.0}, "tolerance"),
        ({"resolved": "flank"}, "resolved"),
    ],
)
def test_settings_are_checked(changes, key):
    with pytest.raises(gd.SceneError) as error:
        gd.studies.life(LOW, LAW, **{**SHORT, **changes})
    assert error.value.key == key


def test_scenes_are_checked():
    with pytest.raises(gd.SceneError, match="gears"):
        gd.studies.life(gd.preset("roller_slow"), LAW)
    with pytest.raises(gd.SceneError, match=r"its windows stand for all passages.*use sweep"):
        gd.studies.life(gd.preset("start_up"), LAW)
    with pytest.raises(gd.SceneError, match="loss law"):
        gd.studies.life(LOW, "contacts")
    held = {"drive.torque": 1e-18, "load.torque": 1e-17, "initial.gear_speed": 0.0}
    with pytest.raises(gd.SceneError, match=r"drive.torque .* must turn the gear"):
        gd.studies.life(LOW.replace(held), LAW, **SHORT)


def test_signals_along_a_life_follow_its_coverage(short):
    """A sensor with some noise, and a map none of whose fractions is that of a state but the first."""
    chart = gd.studies.coating_map(LOW, [0.74, 0.72, 0.7, 0.68, 0.66, 0.64, 0.62])
    assessed = gd.studies.assess_life(short, chart, noise=0.002)
    assert set(assessed.assessed_verdict.values) == {"clear"}
    truth = assessed.coverage.isel(side=0)
    assert (assessed.assessed_low <= truth).all()
    assert (truth <= assessed.assessed_high).all()
    np.testing.assert_allclose(assessed.assessed_coverage, truth, rtol=0, atol=0.004)  # as in the closed loop
    assert len(gd.plot.life(assessed).containers) == 1
    with pytest.raises(gd.SceneError, match="noise"):
        gd.studies.assess_life(short, chart, noise=-1.0)
