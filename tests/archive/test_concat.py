"""Datasets joined along a swept key are the sweep that would have been run at once; chains are one run."""

from __future__ import annotations

import json

import numpy as np
import pytest
import xarray as xr
from hypothesis import given, settings
from hypothesis import strategies as st

import gearidae as gd
from sweeps import without_times

LOW = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 2e-3, "run.samples": 11})
FRACTIONS, TORQUES = [1.0, 0.5, 0.7], [4e-18, 5e-18]
KEY = "coating.sam_fraction"


@pytest.fixture(scope="module")
def whole():
    return gd.sweep(LOW, {KEY: FRACTIONS, "drive.torque": TORQUES})


@pytest.fixture(scope="module")
def run():
    return gd.simulate(LOW.replace({KEY: 0.5}))


def same(joined, wanted):
    xr.testing.assert_identical(without_times(joined), without_times(wanted))


@pytest.mark.parametrize("dim", ["sam_fraction", KEY])
def test_single_runs_make_the_sweep(dim):
    parts = [gd.simulate(LOW.replace({KEY: fraction})) for fraction in FRACTIONS]
    joined, swept = gd.concat(parts, dim), gd.sweep(LOW, {KEY: FRACTIONS})
    same(joined, swept)
    assert np.array_equal(joined.wall_time, [part.attrs["wall_time"] for part in parts])
    assert joined.attrs["wall_time"] == pytest.approx(
        sum(part.attrs["wall_time"] for part in parts), rel=1e-12
    )
    assert len(joined.attrs["history"].splitlines()) == 4 or len({p.attrs["history"] for p in parts}) < 3


@given(st.sampled_from(["sam_fraction", "torque"]), st.integers(1, 2))
@settings(max_examples=2)
def test_parts_of_a_sweep_make_the_sweep(whole, dim, cut):
    cut = min(cut, whole.sizes[dim] - 1)
    parts = [whole.isel({dim: slice(cut)}), whole.isel({dim: slice(cut, None)})]
    same(gd.concat(parts, dim), whole)


def test_a_run_is_added_to_a_sweep(whole):
    line = whole.sel(torque=4e-18)
    joined = gd.concat([line.sel(sam_fraction=[1.0, 0.5]), line.sel(sam_fraction=0.7)], "sam_fraction")
    swept = gd.sweep(LOW.replace({"drive.torque": 4e-18}), {KEY: FRACTIONS})
    # the template is the first part's: that of the whole sweep, in which the torque was another key
    for name in set(swept.variables) - {"wall_time"}:
        assert joined[name].identical(swept[name]), name
    assert joined.gearidae.scenes == swept.gearidae.scenes


def test_a_new_dimension_stands_in_front():
    over = {"drive.torque": TORQUES}
    parts = [gd.sweep(LOW.replace({KEY: fraction}), over) for fraction in FRACTIONS]
    joined = gd.concat(parts, KEY)
    assert joined.gear_speed.dims == ("sam_fraction", "torque", "time")
    swept = gd.sweep(LOW.replace({KEY: 1.0}), {KEY: FRACTIONS, **over})
    same(joined, swept)


def test_a_key_of_two_tables_is_told_by_the_scenes():
    parts = [gd.simulate(LOW.replace({"load.torque": torque})) for torque in (0.0, 1e-19)]
    joined = gd.concat(parts, "torque")
    assert json.loads(joined.attrs["swept"]) == {"load.torque": [0.0, 1e-19]}


def test_zipped_sweeps():
    over = {"drive.torque": [4e-18, 5e-18, 6e-18], "load.drag": [7e-18, 8e-18, 9e-18]}
    ds = gd.sweep(LOW, over, zipped=True)
    same(gd.concat([ds.isel(torque=[0]), ds.isel(torque=[1, 2])], "torque"), ds)


def test_sweeps_that_keep_parts():
    ds = gd.sweep(LOW, {KEY: FRACTIONS}, keep=["min_gear_speed", "energy_balance", "statistics"])
    same(gd.concat([ds.isel(sam_fraction=[0]), ds.isel(sam_fraction=[1, 2])], KEY), ds)


def refused(parts, dim, key, said=None):
    with pytest.raises(gd.SceneError, match=said) as error:
        gd.concat(parts, dim)
    assert error.value.key == key


def test_what_cannot_be_joined_is_named(run, whole):
    other = LOW.replace({KEY: 0.7})
    refused(
        [run, gd.simulate(other.replace({"mesh.backlash": "0.4 um"}))],
        KEY,
        "mesh.backlash",
        "in the first run",
    )
    refused([run, gd.simulate(other, samples=21)], KEY, "run.samples")
    refused([run, run], KEY, KEY, "twice")
    roller = gd.simulate(
        gd.preset("roller_slow").replace({"run.samples": 11, "coating": {"sam_fraction": 0.7}})
    )
    refused([run, roller], KEY, "drive", "in the first run")
    refused([], KEY, "concat")
    refused([run, None], KEY, "dataset 2")
    refused([run], "speeds", "dim")
    refused([whole, whole.isel(torque=[0])], KEY, "drive.torque")
    refused([xr.Dataset()], KEY, "dataset")
    late = gd.simulate(other)
    refused([run, late.assign_coords(time=late.time + 1e-3)], KEY, "time", "one time axis")
    kept = gd.sweep(LOW, {KEY: [0.3]}, keep=["samples"])
    refused([gd.sweep(LOW, {KEY: [0.6]}), kept], KEY, "keep")


def cut_in_two(run, place):
    """A run as two, the second of which goes on where the first has ended: both have the sample between them."""
    time = run.time.values[place]
    events, passages = run.event_time.values <= time, run.passage_time.values <= time
    before = run.isel(time=slice(place + 1), event=events, passage=passages)
    return before, run.isel(time=slice(place, None), event=~events, passage=~passages)


@given(st.integers(1, 9))
@settings(max_examples=3)
def test_a_chain_is_one_run(run, place):
    first, second = cut_in_two(run, place)
    joined = gd.concat([first, second], "time")
    xr.testing.assert_identical(joined.drop_attrs(), run.drop_attrs())
    assert all(joined[name].attrs == run[name].attrs for name in run.variables)
    assert joined.attrs["steps"] == 2 * run.attrs["steps"]
    assert joined.attrs["wall_time"] == 2 * run.attrs["wall_time"]
    assert joined.gearidae.energy_balance == run.gearidae.energy_balance
    links = json.loads(joined.attrs["chain"])
    assert [link["scene"] for link in links] == [json.loads(run.attrs["scene"])] * 2
    assert links[0]["end"] >= links[1]["start"] == run.time[place]


def test_a_chain_of_three_joined_at_once_or_one_by_one(run):
    first, rest = cut_in_two(run, 3)
    second, third = cut_in_two(rest, 4)
    at_once = gd.concat([first, second, third], "time")
    one_by_one = gd.concat([gd.concat([first, second], "time"), third], "time")
    gone = {"history": ""}
    xr.testing.assert_identical(at_once.assign_attrs(gone), one_by_one.assign_attrs(gone))


def test_a_chain_may_change_its_torque_and_is_judged_by_its_last(run):
    first, second = cut_in_two(run, 5)
    scene = json.loads(run.attrs["scene"])
    scene["drive"]["torque"] = 9e-18
    joined = gd.concat([first, second.assign_attrs(scene=json.dumps(scene))], "time")
    assert joined.gearidae.scene.drive.torque == 9e-18
    assert joined.gearidae.verdicts().final_speed[0] == run.final_speed


def test_a_chain_that_says_when_it_began(run):
    """Where runs tell their start, it is believed, and that of the first is the whole's."""
    first, second = cut_in_two(run, 5)
    middle = float(second.time[0])
    joined = gd.concat([first, second.assign_attrs(start_time=middle)], "time")
    assert "start_time" not in joined.attrs
    assert json.loads(joined.attrs["chain"])[1]["start"] == middle
    refused([first, second.assign_attrs(start_time=0.5 * middle)], "time", "time", "does not go on from it")


def test_what_is_no_chain(run, whole):
    first, second = cut_in_two(run, 5)
    refused([second, first], "time", "time", "does not go on from it")
    refused([run, run], "time", "time", "does not go on from it")
    refused(
        [first, second.isel(time=slice(3, None), event=slice(0), passage=slice(0))],
        "time",
        "time",
        "a run is missing",
    )
    fast = second.assign(gear_speed=1.5 * second.gear_speed)
    refused([first, fast], "time", "gear_speed", "as the run before ended")
    refused([first, second.drop_vars("mesh_force")], "time", "dataset 2", "all runs of the chain")
    refused([whole, whole], "time", "dataset", "single run")
    scene = json.loads(run.attrs["scene"])
    scene["mesh"]["backlash"] *= 1.1
    refused([first, second.assign_attrs(scene=json.dumps(scene))], "time", "mesh.backlash")


def test_a_chain_without_samples():
    """Where it is cut, its events tell."""
    run = gd.simulate(LOW.replace({KEY: 0.5}), samples="off")
    middle = run.sizes["event"] // 2
    whole, none = slice(None), slice(0)
    parts = [run.isel(event=slice(middle), passage=none), run.isel(event=slice(middle, None), passage=whole)]
    parts[0]["reached"] = parts[0].event_time[-1]
    joined = gd.concat(parts, "time")
    assert np.array_equal(joined.event_time, run.event_time)


EXPOSED = LOW.replace({"run.exposures": 3, "run.samples": "off"})


def test_exposures_are_joined_and_picked():
    swept = gd.sweep(EXPOSED, {KEY: [0.7, 0.5], "drive.torque": TORQUES})
    assert swept.sliding_work.dims == ("sam_fraction", "torque", "flank", "tooth", "place")
    assert float(swept.sliding_work.sum()) > 0.0
    same(gd.concat([swept.isel(sam_fraction=[0]), swept.isel(sam_fraction=[1])], KEY), swept)
    same(gd.concat([swept.sel(torque=[torque]) for torque in TORQUES], "torque"), swept)
    run = swept.sel(torque=TORQUES[1], sam_fraction=0.5)
    alone = gd.simulate(EXPOSED.replace({KEY: 0.5, "drive.torque": TORQUES[1]}))
    np.testing.assert_array_equal(run.gearidae.run().event_time, alone.event_time)
    for name in ("sliding_work", "adhesion_work", "flank_area", "place"):
        np.testing.assert_array_equal(run[name], alone[name])


def test_a_chain_has_the_exposures_of_its_last_run():
    first = gd.simulate(EXPOSED.replace({"run.samples": 11}))
    second = gd.simulate(EXPOSED.replace({"run.samples": 11}), start=first)
    joined = gd.concat([first, second], "time")
    np.testing.assert_array_equal(joined.sliding_work, second.sliding_work)
    np.testing.assert_array_equal(joined.place, second.place)
    assert joined.sizes["time"] == 21


def test_runs_of_any_scenes_by_name(run, tmp_path):
    """Names label runs and events; keys in which they differ are coordinates, and each run is what it was."""
    others = {
        "fast": gd.simulate(LOW.replace({KEY: 0.5, "drive.torque": "5 aN m"})),
        "pushed": gd.simulate(LOW.replace({"drive.schedule": [[0.0, 0.0], [1e-3, 1e-19]]})),
        "short": gd.simulate(LOW.replace({"run.duration": 1e-3, "run.samples": 6})),
    }
    parts = {"worn": run, **others}
    joined = gd.concat(parts, "name")
    assert joined.gear_speed.dims == ("name", "time")
    assert joined.torque.values.tolist() == [4.5e-18, 5e-18, 4.5e-18, 4.5e-18]
    assert joined.sam_fraction.values.tolist() == [0.5, 0.5, 1.0, 1.0]
    assert joined.sizes["event"] == sum(part.sizes["event"] for part in parts.values())
    table = joined.gearidae.events()
    gd.save(joined, tmp_path / "joined.nc")
    for ds in (joined, gd.open(tmp_path / "joined.nc")):
        for name, part in parts.items():
            alone = ds.gearidae.run(name=name)
            assert alone.gearidae.scene == part.gearidae.scene.replace({"name": name})
            assert alone.event_time.equals(part.event_time)
            assert alone.gear_speed[: part.sizes["time"]].drop_attrs().equals(part.gear_speed.drop_attrs())
            assert table.query("name == @name")["time"].tolist() == part.event_time.values.tolist()
            words = ds.gearidae.verdicts().set_index("name")["words"][name]
            assert words == part.gearidae.verdicts()["words"].item()


def test_runs_by_name_that_cannot_be_joined(run, whole):
    refused([run, run], "name", "name", "name them")
    refused({"whole": whole}, "name", "dataset", "pick one")
    refused({"worn": run}, KEY, "dim")
    roller = gd.simulate(gd.preset("roller_slow").replace({"run.samples": 11, "contact.model": "asperity"}))
    refused({"gears": run, "roller": roller}, "name", "dataset 2", "sampled in all runs")
