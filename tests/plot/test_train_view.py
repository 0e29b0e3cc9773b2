"""Pictures of whole trains: teeth that meet where the engine says so, arrows of hubs, moving pictures, refusals."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from matplotlib.path import Path as Outline
from PIL import Image
from tests.reference.trains import chain, compound, split

import gearidae as gd
from gearidae.archive.select import run_scene
from gearidae.cli import main
from gearidae.plot.train_shape import pitch_point, train_gears
from gearidae.plot.train_view import TrainView, train_run, train_states
from gearidae.scene import Scene

TRAINS = {"chain": chain(hubs=0.3), "split": split(), "compound": compound()}


@pytest.fixture(scope="module", params=TRAINS)
def run(request):
    return gd.simulate(Scene.from_dict(TRAINS[request.param]), t_end=100e-6)


@pytest.fixture(scope="module")
def three():
    return gd.simulate(Scene.from_dict(TRAINS["chain"]).replace({"run.duration": 100e-6}))


def outline(gear, angle, centre, reach):
    """Points of a gear's outline near a point [um], some 20 nm apart, and the whole outline as a path."""
    points = 1e6 * gear.outline(angle)
    steps = np.linspace(0.0, 1.0, 12)[:, None, None]
    fine = ((1.0 - steps) * points[:-1] + steps * points[1:]).reshape(-1, 2)
    return fine[np.hypot(*(fine - centre).T) < reach], Outline(points)


def distances(points, others):
    return np.hypot(*(points[:, None, :] - others[None, :, :]).transpose(2, 0, 1)).min(axis=1)


@pytest.mark.parametrize("share", [0.2, 1.0])
def test_teeth_meet_where_the_engine_says_that_they_touch(run, share):
    """Rough flanks that carry are some 20 nm apart, and nowhere do teeth lie in each other."""
    train, k = run_scene(run).train, int(share * (run.sizes["time"] - 1))
    gears = {gear.name: gear for gear in train_gears(train, run["transmission_error"][:, 0].values)}
    for number, mesh in enumerate(train.meshes):
        centre = 1e6 * pitch_point(train, mesh)
        (points, path), (others, other) = (
            outline(gears[name], float(run["shaft_angle"][shaft, k]), centre, 9.0)
            for name, shaft in ((mesh.driver, mesh.a), (mesh.driven, mesh.b))
        )
        apart, gap = distances(points, others), 1e6 * float(run["drive_gap"][number, k])
        assert abs(apart.min() - gap) < 0.015, mesh.name
        for inside, of, all_points in ((other, points, others), (path, others, points)):
            deep = of[inside.contains_points(of)]
            assert not deep.size or distances(deep, all_points).max() < 0.015, mesh.name


def test_arrows_are_the_loads_of_the_hubs(three):
    """From the centre along the load; the longest is that of the largest load."""
    run = train_run(three)
    states = train_states(run, [20e-6, 100e-6])
    view = TrainView(run, states)
    largest = (
        run["hub_load"].values[:, [round(s.time / 100e-6 * (run.sizes["time"] - 1)) for s in states]].max()
    )
    lengths = []
    for state in states:
        view.draw(state)
        for shaft, (arrow, words) in zip(run_scene(run).train.shafts, view._hubs, strict=True):
            begin, end = np.array(arrow._posA_posB)
            np.testing.assert_allclose(begin, 1e6 * np.array(shaft.centre), atol=1e-9)
            at = {"shaft": shaft.name}
            load = run.sel(at).sel(time=state.time, method="nearest")
            angle = float(load["hub_load_angle"])
            turned = math.remainder(math.atan2(*(end - begin)[::-1]) - angle, 2.0 * math.pi)
            assert abs(turned) < 1e-9
            lengths.append(math.hypot(*(end - begin)) / float(load["hub_load"]))
            assert words.get_text().startswith(shaft.name)
    np.testing.assert_allclose(lengths, lengths[0], rtol=1e-9)
    assert lengths[0] * largest == pytest.approx(view._longest, rel=1e-9)


def test_teeth_that_only_damping_holds_do_not_touch(three):
    """Damping of the transmission error acts in flight, too: its force is no push."""
    apart = three.assign(pairs_in_contact=0 * three["pairs_in_contact"])
    assert np.abs(apart["mesh_force"].isel(time=-1)).min() > 0.0
    whites = [
        sum(line.get_markerfacecolor() == "white" for ax in gd.plot.train(ds).axes for line in ax.lines)
        for ds in (three, apart)
    ]
    assert whites[1] - whites[0] == three.sizes["mesh"]


def test_a_hub_without_a_load_has_no_arrow(three):
    run = train_run(three)
    (state,) = train_states(run, [50e-6])
    state.load[1] = 0.0
    view = TrainView(run, [state])
    view.draw(state)
    assert [arrow.get_visible() for arrow, _ in view._hubs] == [True, False, True]


def test_a_time_is_the_nearest_sample(three):
    time = three["time"].values
    (state,) = train_states(train_run(three), [0.5 * (time[40] + time[41]) + 0.1 * (time[41] - time[40])])
    assert state.time == time[41]
    assert train_states(train_run(three), [math.inf])[0].time == time[-1]


def test_a_moving_picture_turns(three, tmp_path):
    path = gd.plot.animate_train(three, tmp_path / "train.gif", stop=50e-6, frames=3, dpi=40)
    with Image.open(path) as film:
        assert film.n_frames == 3
        shown = []
        for k in range(3):
            film.seek(k)
            shown.append(np.asarray(film.convert("L"), dtype=float))
    assert all(np.abs(one - other).max() > 50.0 for one, other in pairwise(shown))


def test_one_run_of_a_sweep_is_drawn():
    scene = Scene.from_dict(TRAINS["chain"]).replace({"run.duration": 20e-6, "run.samples": 21})
    swept = gd.sweep(scene, {"shafts.idler.inertia": [1.5e-19, 3e-19]})
    gd.plot.train(swept.sel(inertia=3e-19))
    with pytest.raises(gd.SceneError, match="single run"):
        gd.plot.train(swept)


@pytest.mark.parametrize(
    ("options", "key"),
    [
        ({"start": 60e-6, "stop": 50e-6}, "stop"),
        ({"stop": 1.0}, "time"),
        ({"frames": 1}, "frames"),
        ({"rate": 0}, "rate"),
    ],
)
def test_bad_options_of_a_moving_picture_are_refused(three, tmp_path, options, key):
    with pytest.raises(gd.SceneError) as caught:
        gd.plot.animate_train(three, tmp_path / "train.gif", **options)
    assert caught.value.key == key
    assert not [*tmp_path.iterdir()]


def test_what_is_no_run_of_a_train_is_refused(three):
    pair = gd.simulate(gd.preset("teodorescu2009"), t_end=1e-6)
    with pytest.raises(gd.SceneError, match="must be a run of a train of several meshes"):
        gd.plot.train(pair)
    with pytest.raises(gd.SceneError, match="must lie in"):
        gd.plot.train(three, time=1.0)
    silent = gd.simulate(Scene.from_dict(TRAINS["chain"]).replace({"run.samples": "off"}), t_end=1e-6)
    with pytest.raises(gd.SceneError, match="no samples"):
        gd.plot.train(silent)


def test_the_command_draws_a_train(three, tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    gd.save(three, "run.nc")
    plot = ["plot", "run.nc", "--picture", "train"]
    assert main([*plot, "--time", "50 us"]) == 0
    assert main([*plot, "--from", "10 us", "--to", "20 us", "--frames", "2", "--dpi", "40"]) == 0
    assert capfd.readouterr().out == "Picture: run_train.png\nPicture: run_train.gif\n"
    assert main(["plot", "run.nc", "--time", "50 us"]) == 2
    assert "needs --picture teeth or --picture train" in capfd.readouterr().err
