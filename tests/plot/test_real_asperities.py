"""Pictures of a population: joined asperities beside the teeth, and every joining and detachment of a mesh cycle."""

import numpy as np
import pytest

import gearidae as gd
from gearidae.archive.select import run_scene
from gearidae.asperities import tip_law
from gearidae.cli import main
from gearidae.plot.teeth_view import mesh_states
from gearidae.populations.met_flank import met_flank
from gearidae.records import EventKind
from gearidae.records.tooth_states import ContactState
from gearidae.scene import MATERIAL_NAMES

SCENE = gd.preset("teodorescu2009").replace(
    {
        "contact.roughness": "discrete",
        "coating.sam_fraction": 0.5,
        "coating.thickness": 1e-9,
        "initial.gap": 12e-9,
        "run.duration": 80e-6,
        "run.samples": 4001,
    }
)


@pytest.fixture(scope="module")
def run():
    return gd.simulate(SCENE)


def test_joined_asperities_bear_the_recorded_force(run):
    """Also by their overlaps and laws one by one."""
    times = run.time.values[::40]
    states = mesh_states(run, times)
    scale = np.abs(run.mesh_force.values).max()
    scene = run_scene(run)
    surfaces = {material.name: material.surface for material in scene.materials()}
    for state in states:
        total = 0.0
        for contact in state.contacts:
            joined = met_flank(scene, contact.pair, contact.flank).some(list(contact.asperities))
            loads = []
            overlaps = joined.overlaps(scene, contact.place, contact.gap)
            for material, radius, overlap in zip(joined.material, joined.radius, overlaps, strict=True):
                law, length, load = tip_law(
                    scene.contact.asperity, surfaces[MATERIAL_NAMES[material]], radius
                )
                loads.append(load * float(law.load(max(overlap / length, -law.detach))))
            # the tables' own error
            assert contact.force == pytest.approx(sum(loads), rel=1e-8, abs=1e-8 * scale)
            total += contact.force * (1 - 2 * contact.flank)
        assert total == pytest.approx(state.mesh_force, rel=1e-12, abs=1e-14 * scale)
    counted = [sum(len(contact.asperities) for contact in state.contacts) for state in states]
    assert counted == run.asperities_in_contact.values[::40].tolist()
    assert counted[0] > 0
    seen = {contact.state for state in states for contact in state.contacts}
    assert seen == {ContactState.OPEN, ContactState.LOADING, ContactState.PARTLY_STRETCHED}


def test_without_events_the_teeth_are_the_same():
    changes = {"run.duration": 5e-6, "run.samples": 11}
    ds = gd.simulate(SCENE.replace({**changes, "run.asperity_events": False}))
    states = mesh_states(ds, ds.time.values)
    assert states == mesh_states(gd.simulate(SCENE.replace(changes)), ds.time.values)
    assert sum(len(contact.asperities) for contact in states[0].contacts) > 0
    with pytest.raises(gd.SceneError, match=r"run.asperity_events = false: must be true"):
        gd.plot.asperity_events(ds)


def test_the_teeth_have_a_mark_for_each_joined_asperity(run):
    at = float(run.time[int(np.argmax(run.asperities_in_contact.values))])
    figure = gd.plot.teeth(run, time=at)
    marks = [
        line.get_xdata().size for ax in figure.axes for line in ax.get_lines() if line.get_marker() == "v"
    ]
    (state,) = mesh_states(run, [at])
    joined = sum(len(contact.asperities) for contact in state.contacts)
    assert sum(marks) == joined > 3
    assert any("joined asperities:" in ax.get_title(loc="left") for ax in figure.axes)


def test_every_joining_and_detachment_of_a_mesh_cycle_is_marked(run):
    ax = gd.plot.asperity_events(run)
    entries = run.event_time[(run.event_kind == EventKind.MESH_ENTRY) & (run.event_flank == 0)].values
    start, end = entries[-2:]
    assert np.ptp(ax.get_lines()[0].get_xdata()) == pytest.approx((end - start) * 1e6, rel=1e-2)
    for kind, mark in ((EventKind.ASPERITY_ONSET, "^"), (EventKind.ASPERITY_DETACHMENT, "v")):
        (line,) = (artist for artist in ax.get_lines() if artist.get_marker() == mark)
        times = run.event_time[run.event_kind == kind].values
        wanted = times[(times >= start) & (times <= end)]
        np.testing.assert_allclose(line.get_xdata(), wanted * 1e6, rtol=1e-12)
        force = np.interp(wanted, run.time.values, run.mesh_force.values)
        np.testing.assert_allclose(line.get_ydata(), force * 1e6, rtol=1e-12)
        assert wanted.size > 10


def test_the_command_draws_it_and_names_what_it_cannot(run, tmp_path, capsys):
    path = tmp_path / "run.nc"
    gd.simulate(SCENE.replace({"run.duration": 5e-6, "run.samples": 101}), archive=path)
    target = tmp_path / "events.png"
    assert main(["plot", str(path), "--picture", "asperity_events", "-o", str(target)]) == 0
    assert target.stat().st_size > 10_000
    mean = gd.simulate(gd.preset("roller_slow"), samples=11, t_end=1e-7)
    with pytest.raises(gd.SceneError, match=r"contact.roughness = \w+: must be discrete"):
        gd.plot.asperity_events(mean)
    sweep = gd.sweep(SCENE, {"coating.sam_fraction": [0.0, 1.0]}, t_end=1e-7, samples=3)
    with pytest.raises(gd.SceneError, match="must be a single run"):
        gd.plot.asperity_events(sweep)


def test_a_roller_s_run_is_drawn_as_a_whole():
    ds = gd.simulate(gd.preset("roller_slow").replace({"contact.roughness": "discrete", "run.samples": 401}))
    ax = gd.plot.asperity_events(ds)
    assert ax.get_lines()[0].get_xdata()[-1] == pytest.approx(float(ds.time[-1]) * 1e6)
    assert "joins (" in ax.get_legend().get_texts()[0].get_text()
