"""Discrete asperities of the meshes of a train: each mesh against the pair that it is alone, and both drivers.

The gears of the chain ring in their contacts, which grows errors: runs are short enough that a hundred tolerances are
left of the motion, and that all events are the same.
"""

from __future__ import annotations

import json
from functools import cache

import numpy as np
import pytest
from tests.mesh.test_slow_train import idle
from tests.reference.trains import chain, split

import gearidae as gd
from gearidae.archive.specimen import has_seeds, specimen_label, specimen_note
from gearidae.engine import solve
from gearidae.engine.train import end_of_train, solve_train
from gearidae.engine.train import solve as solving
from gearidae.mesh.involute import flank_arc
from gearidae.records import EventKind
from gearidae.scene import Scene

SPEED, FORCE = 5e-6, 1e-4
"""Joining asperities multiply rounding, which other processors do otherwise: speeds by up to 1.2e-6, times by 5 ps."""
DISCRETE = {
    "contact.roughness": "discrete",
    "contact.asperity": "jkr",
    "coating.thickness": 0.0,
    "coating.sam_fraction": 0.6,
}
_ACROSS = np.linspace(1e-7, 6.7e-6, 30)
"""Arcs on the flank of the driver of 19 teeth."""
LAWS = {
    "jkr": {},
    "maugis": {"contact.asperity": "maugis"},
    "dmt": {"contact.asperity": "dmt"},
    "hertz": {"contact.asperity": "hertz"},
    "attraction": {"surface.hamaker": 1e-19},
    "friction": {"contact.friction": 0.3},
    "spread of radii": {"contact.radius_spread": 0.3},
    "independent sides": {"coating.pairing": "independent"},
    "a list": {
        "meshes.first.contact.asperities": {
            "arc": _ACROSS.tolist(),
            "height": (12e-9 + 4e-9 * np.sin(7.0 * np.arange(30))).tolist(),
        }
    },
    "another seed": {"meshes.first.contact.seed": 7},
}
JOINING = (EventKind.ASPERITY_ONSET, EventKind.ASPERITY_DETACHMENT)


def discrete(tables, **changes):
    return Scene.from_dict(tables).replace({**DISCRETE, **changes})


def as_pair(scene):
    """The first mesh of a chain with the load on its driven shaft, as a pair."""
    drive, load = ({**scene.to_dict().get(table, {})} for table in ("drive", "load"))
    load.pop("shaft")
    return scene.pair("first").replace({"drive": drive, "load": load})


@cache
def alone(law):
    """The first mesh of a chain whose second never touches, and its pair."""
    scene = discrete(idle(), **LAWS[law]).replace(
        {"run.rtol": 1e-11, "run.duration": 20e-6, "run.samples": 5}
    )
    return solve_train(scene), solve(as_pair(scene))


@pytest.mark.parametrize("law", LAWS)
def test_a_mesh_moves_as_the_pair_does(law):
    train, pair = alone(law)
    assert train.status == pair.status == "finished"
    for i, name in enumerate(("pinion_speed", "gear_speed")):
        np.testing.assert_allclose(train.samples["shaft_speed"][i], pair.samples[name], rtol=SPEED)
    largest = np.abs(pair.samples["mesh_force"]).max()
    np.testing.assert_allclose(
        train.samples["mesh_force"][0], pair.samples["mesh_force"], rtol=0.0, atol=FORCE * largest
    )
    np.testing.assert_allclose(
        train.samples["transmission_error"][0], pair.samples["transmission_error"], rtol=1e-6
    )
    for name in ("asperities_in_contact", "pairs_in_contact"):
        np.testing.assert_array_equal(train.samples[name][0], pair.samples[name])
        np.testing.assert_array_equal(train.samples[name][1], 0)


@pytest.mark.parametrize("law", LAWS)
def test_a_mesh_has_the_events_of_the_pair(law):
    train, pair = alone(law)
    ours, theirs = train.events, pair.events
    mine = ours["mesh"] == 0
    assert np.isin(theirs.kind, JOINING).sum() > 20
    for name in ("kind", "pair", "flank", "asperity"):
        np.testing.assert_array_equal(ours[name][mine], getattr(theirs, name))
    np.testing.assert_allclose(ours["time"][mine], theirs.time, rtol=0.0, atol=2e-11)
    assert (ours["asperity"][~mine] == -1).all()


@pytest.mark.parametrize("law", LAWS)
def test_a_mesh_has_the_energies_of_the_pair(law):
    train, pair = alone(law)
    own, balance, energy = train.mesh_totals, pair.balance, train.energy
    assert own["adhesion_loss"][0] == pytest.approx(
        balance.adhesion_loss, rel=1e-6, abs=1e-9 * balance.throughput
    )
    assert own["damping_loss"][0] == pytest.approx(balance.damping_loss, rel=1e-6, abs=0.0)
    assert energy["drive_work"] == pytest.approx(balance.drive_work, rel=2e-7, abs=0.0)
    assert energy["kinetic_change"] == pytest.approx(balance.kinetic_change, rel=2e-7, abs=0.0)
    assert energy["radius_work"] == 0.0  # asperities pay for what they do along the path
    assert abs(energy["residual"]) < energy["residual_bound"] < 1e-7 * energy["throughput"]
    for name in ("largest_mesh_force", "smallest_mesh_force", "smallest_separation"):
        assert own[name][0] == pytest.approx(pair.extremes[name], rel=FORCE, abs=0.0), name
    for name in ("asperity_onsets", "asperity_detachments"):
        assert own[name].tolist() == [pair.extremes[name], 0]


@pytest.mark.parametrize(
    "tables", [chain(hubs=0.1), chain(contact={"bodies": "rigid", "friction": 0.3}), split()]
)
def test_the_balance_of_many_meshes_closes_within_a_bound_that_falls(tables):
    bounds = []
    for rtol in (1e-7, 1e-9):
        solution = solve_train(discrete(tables, **{"run.rtol": rtol}), t_end=40e-6, samples=2)
        energy = solution.energy
        assert solution.status == "finished"
        assert (solution.mesh_totals["asperity_onsets"] > 10).all()
        assert abs(energy["residual"]) < energy["residual_bound"]
        bounds.append(energy["residual_bound"] / energy["throughput"])
    assert bounds[0] > 50.0 * bounds[1] > 0.0


def test_each_asperity_joins_and_lets_go_in_turn():
    solution = solve_train(discrete(chain()), t_end=40e-6, samples=2)
    joined, events = set(), solution.events
    for i in np.flatnonzero(events["asperity"] >= 0):
        which = tuple(int(events[name][i]) for name in ("mesh", "pair", "flank", "asperity"))
        assert (which in joined) == (events["kind"][i] == EventKind.ASPERITY_DETACHMENT)
        joined ^= {which}
    per_mesh = [sum(which[0] == mesh for which in joined) for mesh in range(2)]
    assert per_mesh == solution.samples["asperities_in_contact"][:, -1].tolist()
    totals = solution.mesh_totals
    assert per_mesh == (totals["asperity_onsets"] - totals["asperity_detachments"]).tolist()


def test_shorter_steps_find_the_same_events():
    """Of bare teeth without damping; steps are a tenth as long, which changes the motion by some tolerances.

    Ringing multiplies the change: in twice the time to 7e-11 s.
    """
    bare = {"coating.sam_fraction": 0.0, "mesh.damping": 0.0, "run.rtol": 1e-10}
    scene = discrete(chain(), **bare).replace({"run.duration": 7.5e-6, "run.samples": 2})
    usual = solve_train(scene)
    short = solve_train(scene.replace({"run.largest_step": 7.5e-6 / (10 * usual.statistics.steps)}))
    assert short.statistics.steps > 10 * usual.statistics.steps
    for name in ("kind", "mesh", "pair", "asperity"):
        np.testing.assert_array_equal(usual.events[name], short.events[name])
    np.testing.assert_allclose(usual.events["time"], short.events["time"], rtol=0.0, atol=1e-11)


@pytest.mark.parametrize("backend", ["native", "sksundae"])
@pytest.mark.parametrize("depth", [-1e-13, 1e-13])
def test_an_asperity_that_is_grazed_between_two_steps_is_not_missed(backend, depth):
    """Teeth turn back where a second asperity has been overlapped by 0.1 pm, for a moment far shorter than a step.

    Asperities are Hertzian, so that the largest force of a first one tells how far it is pressed.
    """
    geometry = Scene.from_dict(idle()).train.mesh("first").geometry
    # where the pair that is there at the start touches some 0.9 us later
    place = float(flank_arc(geometry, 0.3 * geometry.base_pitch + 0.12e-6))
    height = 15e-9
    spring = {"arc": [place], "height": [height], "tooth": [0], "flank": ["drive"]}
    scene = discrete(
        idle(),
        **{
            "contact.asperity": "hertz",
            "mesh.damping": 0.0,
            "meshes.first.contact.asperities": spring,
            "run.rtol": 1e-10,
            "run.duration": 1.3e-6,
            "run.samples": 2,
        },
    )
    alone = solve_train(scene, backend=backend)
    assert alone.mesh_totals["asperity_detachments"][0] == 1
    surface = scene.surface
    modulus = 0.5 * surface.youngs_modulus / (1.0 - surface.poisson_ratio**2)
    stiffness = 4.0 / 3.0 * modulus * np.sqrt(surface.asperity_radius)
    pressed = (alone.mesh_totals["largest_mesh_force"][0] / stiffness) ** (2.0 / 3.0)
    both = {
        "arc": [place, place + 1e-12],
        "height": [height, height - pressed + depth],
        "radius": [surface.asperity_radius, 1e-10],
        "tooth": [0, 0],
        "flank": ["drive", "drive"],
    }
    events = solve_train(scene.replace({"meshes.first.contact.asperities": both}), backend=backend).events
    kinds = events["kind"][events["asperity"] == 1].tolist()
    assert kinds == ([int(kind) for kind in JOINING] if depth > 0.0 else [])


# -- surfaces --------------------------------------------------------------------------------------------------------


def test_meshes_have_surfaces_of_their_own():
    scene = discrete(chain())
    first, second = (scene.pair(name).contact.seed for name in ("first", "second"))
    assert first == scene.contact.seed == 0
    assert second != first
    other = scene.replace({"contact.seed": 1})
    assert len({first, second, *(other.pair(name).contact.seed for name in ("first", "second"))}) == 4
    assert scene.replace({"meshes.second.contact.seed": 3}).pair("second").contact.seed == 3
    # statistical teeth draw nothing: their pairs are as they were
    assert scene.replace({"contact.roughness": "statistical"}).pair("second").contact.seed == 0
    drawn = [gd.population(scene.pair(name)) for name in ("first", "second")]
    assert drawn[0].attrs["asperities_sha256"] != drawn[1].attrs["asperities_sha256"]
    ds = gd.simulate(scene.replace({"run.duration": 1e-7, "run.samples": 2}))
    assert ds.attrs["asperities_sha256"].split() == [part.attrs["asperities_sha256"] for part in drawn]


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        (
            "meshes.second.contact.asperities",
            {"arc": [1e-6], "height": [1e-8], "tooth": [38]},
            r"^meshes\.second\.contact\.asperities = \(row 1, tooth 38\): must be below 38",
        ),
        (
            "contact.asperities",
            {"arc": [1e-6], "height": [1e-8], "tooth": [20]},
            r"^contact\.asperities = \(row 1, tooth 20\): must be below 19",
        ),
        (
            "contact.asperities",
            {"x": [1e-6], "height": [1e-8]},
            r"^contact\.asperities = .*must have the column arc",
        ),
        (
            "meshes.first.contact.asperity",
            "hertz",
            r"^meshes\.first\.contact\.asperity = hertz: unknown key",
        ),
        (
            "surface.asperity_density",
            1e18,
            r"^meshes\.first\.surface\.asperity_density = .*has 5e\+06 at most",
        ),
    ],
)
def test_what_no_mesh_can_have_is_refused(key, value, message):
    with pytest.raises(gd.SceneError, match=message):
        discrete(chain(), **{key: value})


def test_a_list_of_a_mesh_is_written_and_read_again(tmp_path):
    listed = {"arc": [1e-6, 2e-6], "height": [1e-8, 2e-8], "tooth": [5, 7]}
    scene = discrete(chain(), **{"meshes.second.contact": {"seed": 4, "asperities": listed}})
    assert Scene.from_dict(scene.to_dict()) == scene
    case = tmp_path / "case.toml"
    case.write_text(gd.dump_case(scene))
    assert gd.load_case(case) == scene


def test_a_population_is_of_one_mesh():
    with pytest.raises(gd.SceneError, match=r"scene\.pair\(NAME\) is a stage of the train"):
        gd.population(discrete(chain()))


# -- drivers, and runs that go on --------------------------------------------------------------------------------------


def test_the_other_driver_gives_the_same():
    scene = discrete(chain(hubs=0.1), **{"run.rtol": 1e-9})
    native, portable = (solve_train(scene, t_end=5e-6, samples=4, backend=b) for b in ("native", "sksundae"))
    np.testing.assert_allclose(portable.samples["shaft_speed"], native.samples["shaft_speed"], rtol=1e-5)
    largest = np.abs(native.samples["mesh_force"]).max()
    np.testing.assert_allclose(
        portable.samples["mesh_force"], native.samples["mesh_force"], rtol=0.0, atol=1e-4 * largest
    )
    for name in ("kind", "mesh", "asperity"):
        np.testing.assert_array_equal(portable.events[name], native.events[name])
    assert abs(portable.energy["residual"]) < portable.energy["residual_bound"]


def numbers(solution):
    tables = (solution.samples, solution.events, solution.shaft_totals, solution.mesh_totals, solution.rests)
    return {name: values for table in tables for name, values in table.items()} | solution.energy


@pytest.mark.parametrize("backend", ["native", "sksundae"])
def test_a_resumed_run_is_the_whole_run_to_the_last_bit(backend, monkeypatch):
    monkeypatch.setattr(solving, "STEPS", 100)
    monkeypatch.setattr(solving, "PORTABLE_STEPS", 400)
    blocks, scene = [], discrete(chain(hubs=0.1))
    end = {"native": 40e-6, "sksundae": 3e-6}[backend]
    scene = scene.replace({"run.duration": end, "run.samples": 31})
    whole = numbers(solve_train(scene, backend=backend, on_block=blocks.append))
    assert len(blocks) > 2
    for count in (1, len(blocks) // 2, len(blocks) - 1):
        again = numbers(solve_train(scene, backend=backend, blocks=blocks[:count]))
        assert [name for name in whole if not np.array_equal(whole[name], again[name], equal_nan=True)] == []


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_a_continued_run_is_the_whole_run(friction):
    """The steps are others, which costs a tolerance each; what rings has grown that by some thousand."""
    changes = {"contact.friction": friction, "run.rtol": 1e-10}
    scene = discrete(chain(hubs=0.1), **changes).replace({"run.duration": 15e-6, "run.samples": 16})
    whole = solve_train(scene.replace({"run.duration": 30e-6, "run.samples": 31}))
    first = solve_train(scene)
    second = solve_train(scene, start=end_of_train(scene, first.checkpoint, 0.0))
    for name in ("shaft_speed", "transmission_error"):
        joined = np.concatenate([first.samples[name], second.samples[name][:, 1:]], axis=1)
        np.testing.assert_allclose(joined, whole.samples[name], rtol=1e-6)
    for name in ("kind", "mesh", "pair", "asperity"):
        both = np.concatenate([first.events[name], second.events[name]])
        np.testing.assert_array_equal(both, whole.events[name])
    for name in ("adhesion_loss", "asperity_onsets", "largest_mesh_force"):
        np.testing.assert_allclose(second.mesh_totals[name], whole.mesh_totals[name], rtol=1e-4)
    assert abs(second.energy["residual"]) < second.energy["residual_bound"]


@pytest.mark.parametrize(
    "changes",
    [
        {"drive.torque": 2e-12},
        {"meshes.second.coating.sam_fraction": 0.2},
        {"coating.energy": 0.03},
        {"run.balance": False},
    ],
)
def test_other_torques_and_coatings_go_on_from_the_same_motion(changes):
    scene = discrete(chain(hubs=0.1)).replace({"run.duration": 20e-6, "run.samples": 21})
    first = solve_train(scene)
    second = solve_train(scene.replace(changes), start=end_of_train(scene, first.checkpoint, 0.0))
    assert second.status == "finished"
    for name in ("shaft_speed", "shaft_angle", "transmission_error"):
        np.testing.assert_array_equal(second.samples[name][:, 0], first.samples[name][:, -1])
    if "run.balance" not in changes:
        assert abs(second.energy["residual"]) < second.energy["residual_bound"]


def test_other_surfaces_do_not_go_on():
    scene = discrete(chain()).replace({"run.duration": 1e-6, "run.samples": 2})
    start = end_of_train(scene, solve_train(scene).checkpoint, 0.0)
    for key in ("contact.seed", "meshes.second.contact"):
        value = 5 if key == "contact.seed" else {"seed": 5}
        with pytest.raises(gd.SceneError, match="as in the run to go on from") as error:
            solve_train(scene.replace({key: value}), start=start)
        assert error.value.key == key


def test_altered_asperities_of_a_checkpoint_are_refused():
    """The block of the last mesh stands at the end: digest, count and indices, each of which is bounded."""
    scene = discrete(chain()).replace({"run.duration": 20e-6, "run.samples": 2})
    solution = solve_train(scene)
    words, joined = solution.checkpoint, int(solution.samples["asperities_in_contact"][1, -1])
    assert joined > 0
    block = words.size - 64
    assert words[block + 4] == joined
    for at, value in ((0, 1.0), (4, 1e9), (4, -1.0), (4, 0.5), (5, 1e12), (5, -1.0), (5, 0.5), (5, np.nan)):
        other = words.copy()
        other[block + at] = value
        with pytest.raises(gd.SceneError, match="checkpoint"):
            end_of_train(scene, other, 0.0)


# -- datasets --------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def ds():
    return gd.simulate(discrete(chain(hubs=0.1)).replace({"run.duration": 30e-6, "run.samples": 31}))


def test_a_dataset_has_asperities_by_mesh(ds):
    assert ds["asperities_in_contact"].dims == ("mesh", "time")
    assert ds["asperity_onsets"].dims == ("mesh",)
    single = ds["event_asperity"].values >= 0
    assert single.sum() == int((ds["asperity_onsets"] + ds["asperity_detachments"]).sum())
    teeth = np.array([19, 38])[ds["event_mesh"].values[single]]
    np.testing.assert_array_equal(ds["event_tooth"].values[single], ds["event_pair"].values[single] % teeth)
    assert ds.attrs["contact_roughness"] == "discrete"
    without = gd.simulate(Scene.from_dict(chain()).replace({"run.duration": 1e-7, "run.samples": 2}))
    for name in ("asperities_in_contact", "asperity_onsets", "event_asperity", "event_tooth"):
        assert name in ds
        assert name not in without


def test_events_of_single_asperities_can_be_left_out(ds):
    scene = discrete(chain(hubs=0.1)).replace(
        {"run.duration": 30e-6, "run.samples": 31, "run.asperity_events": False}
    )
    without = gd.simulate(scene)
    assert (without["event_asperity"].values == -1).all()
    kept = ds["event_asperity"].values < 0
    np.testing.assert_array_equal(without["event_time"].values, ds["event_time"].values[kept])
    np.testing.assert_array_equal(without["asperity_onsets"], ds["asperity_onsets"])


def test_a_picture_shows_the_asperities_of_the_judged_mesh(ds):
    judged = ds.attrs["judged_mesh"]
    ax = gd.plot.asperity_events(ds)
    assert f"of mesh {judged}" in ax.get_ylabel()
    labels = [text.get_text() for text in ax.get_legend().get_texts()]
    counts = [int(label[label.index("(") + 1 : -1]) for label in labels]
    own = ds["event_mesh"].values == ds["mesh"].values.tolist().index(judged)
    assert sum(counts) == ((ds["event_asperity"].values >= 0) & own).sum()


def test_a_run_is_one_specimen_of_its_train(ds):
    assert "another contact.seed is another train" in specimen_note(ds)
    assert specimen_label(ds).startswith("one specimen, seed")
    own = json.loads(ds.attrs["scene"])
    own["meshes"]["second"]["contact"] = {"seed": 4}
    assert specimen_label(ds.assign_attrs(scene=json.dumps(own))) == "one specimen"
    assert has_seeds(ds.assign_attrs(swept=json.dumps({"meshes.second.contact.seed": "seed"})))


def test_seeds_of_an_ensemble_are_other_trains():
    scene = discrete(chain()).replace({"run.duration": 10e-6, "run.samples": 2})
    members = gd.studies.ensemble(scene, {"contact.seed": "seeds"}, 3)
    assert len({tuple(row) for row in members["asperity_onsets"].values.tolist()}) == 3
