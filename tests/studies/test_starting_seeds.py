"""Starting torques of a population: one barrier by statics, then their distribution as a prototype found it."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from scipy.optimize import brentq

import gearidae as gd
from gearidae.engine import solve
from gearidae.populations.first_touch import first_touch
from gearidae.studies import _starting_seeds, starting_ramp
from gearidae.studies._starting_seeds import quantiles
from gearidae.studies.products import answer, kind_of
from reference.population import Contact, Tip

GEARS = gd.preset("teodorescu2009").replace({"contact.roughness": "discrete", "load.torque": 0.0})
BARE = GEARS.replace({"coating.sam_fraction": 0.0})
FEW = {"seeds": 2, "jobs": 1}


def _barrier(seed, half=50e-9):
    """Two bare asperities `half` before and behind the start, among lower ones on every tooth that do not adhere."""
    whole, phase = divmod(starting_ramp.phase_of_seed(GEARS, seed), 1.0)
    arc = Contact(GEARS).at(phase * GEARS.geometry.base_pitch)["arc"]
    low = np.arange(-0.5e-6, 7.2e-6, 100e-9)
    listed = {
        "arc": [arc - half, arc + half, *low],
        "height": [15e-9] * 2 + [3e-9] * low.size,
        "q": [1.0] * 2 + [0.0] * low.size,
        "tooth": [int(whole)] * 2 + [None] * low.size,
    }
    changes = {"contact.asperities": listed, "coating.sam_fraction": 0.5, "coating.energy": 0.0}
    return GEARS.replace(changes), phase


def _largest_static_torque(scene, phase):
    """Largest torque at which both asperities hold the gear: W (1 - D) of both vanishes, and M = R1 W."""
    contact, tip = Contact(scene), Tip(scene.surface, scene.surface.asperity_radius)
    arcs, height = scene.contact.asperities.columns["arc"][:2], 15e-9
    torques = []
    for xi in phase * scene.geometry.base_pitch + np.linspace(0.0, 1.2e-6, 601):
        lowest = min(contact.overlap(xi, 0.0, arc, height)[0] for arc in arcs)

        def loads(gap, xi=xi):
            met = [contact.overlap(xi, gap, arc, height) for arc in arcs]
            return [(float(tip.load(max(delta, -tip.detach))), along) for delta, along in met]

        def held(gap, loads=loads):
            return sum(load * (1.0 - along) for load, along in loads(gap))

        widest = lowest + tip.detach
        if held(widest) > 0.0:  # the one behind detaches before the gear is held
            break
        gap = brentq(held, widest - 10e-9, widest, xtol=1e-18)
        torques.append(scene.geometry.base_radius_pinion * sum(load for load, _ in loads(gap)))
    return max(torques)


def test_two_asperities_hold_a_gear_as_statics_says():
    """Statics knows no ramp: 1 % is what the torque rises while the last barrier is passed.

    From half of the torque on the ringing decides at what moment the gear comes to the barrier, and by that whether it
    passes.
    """
    scene, phase = _barrier(3)
    assert 0.1 < phase < 0.6
    at = starting_ramp.seated(scene, {"contact.seed": 3})
    wanted = _largest_static_torque(scene, phase)
    scale = float(starting_ramp.run_from_rest(starting_ramp.probe(at), "auto")[1])
    torque = float(starting_ramp.run_from_rest(starting_ramp.ramp(at, scale, 0), "auto")[1])
    assert torque == pytest.approx(wanted, rel=0.01, abs=0)
    assert scale == pytest.approx(wanted, rel=0.1, abs=0)
    for share, turns in ((0.3, False), (1.2, True)):
        word = starting_ramp.run_from_rest(starting_ramp.constant(at, scale, share * wanted), "auto")[1]
        assert (word != starting_ramp.RESTS) is turns


def test_a_gear_is_laid_down_where_the_first_asperity_is_about_to_join():
    patches = {"coating.sam_fraction": 0.5}
    teeth = {"coating.pairing": "independent", "coating.gear_table": [[0.0], [1.0]] * 38}
    for seed, covered in ((0, patches), (4, patches), (0, teeth), (4, teeth), (7, teeth)):
        scene = BARE.replace({"coating.thickness": "2 nm", **covered, "run.exposures": 4})
        at = starting_ramp.seated(scene, {"contact.seed": seed})
        assert first_touch(at) == at.initial.gap
        joined = []
        for nearer in (0.0, 1e-12):
            moved = {"initial.gap": at.initial.gap - nearer, "run.duration": 1e-12, "run.samples": 2}
            joined.append(solve(at.replace(moved)).samples["asperities_in_contact"][0])
        assert joined == [0.0, 1.0]


def test_whole_pitches_choose_the_tooth_and_nothing_else():
    listed = {"arc": np.arange(0.0, 7e-6, 50e-9).tolist()}
    listed["height"] = (12e-9 * np.sin(np.arange(len(listed["arc"])))).tolist()
    scene = BARE.replace(
        {"contact.asperities": listed, "run.duration": 40e-6, "run.samples": 21, "initial.mesh_phase": 0.25}
    )
    first = gd.simulate(scene)
    assert first.sizes["event"] > 20
    later = gd.simulate(scene.replace({"initial.mesh_phase": 20.25}))
    assert np.array_equal(first.gear_speed, later.gear_speed)
    assert np.array_equal(first.event_time, later.event_time)
    flanks = first.event_flank.values >= 0
    assert np.array_equal((first.event_tooth.values[flanks] + 1) % 19, later.event_tooth.values[flanks])
    # angles count from the start of a run, wherever that is
    np.testing.assert_allclose(later.gear_angle, first.gear_angle, rtol=0, atol=1e-15)


def test_quantiles_count_gears_that_did_not_start():
    np.testing.assert_allclose(quantiles(np.arange(11.0)), [1.0, 5.0, 9.0], rtol=1e-15)
    found = quantiles(np.array([4.0, math.inf, 1.0, 2.0, math.inf]))
    assert found.tolist() == [pytest.approx(1.4), 4.0, math.inf]


def test_a_gear_that_cannot_be_followed_is_left_out_and_named(caplog):
    """One of three fails in each run: the others' torques are 2 and 4, and 1 of 2 starts."""
    words = itertools.cycle(["2.0", "fails: the steps became too small", "4.0"])
    runs = _starting_seeds._Runs(lambda run, scenes: ((None, next(words)) for _ in scenes))
    torques = runs.torques([GEARS] * 3)
    np.testing.assert_array_equal(torques, [2.0, math.nan, 4.0])
    assert "one gear is left out: the steps became too small" in caplog.text
    assert quantiles(torques)[1] == 3.0
    design = _starting_seeds._Design(GEARS, [], 1.0, 0, torques, 0.0, np.array([1.0, math.nan, 0.0]))
    columns = _starting_seeds._columns([design])
    assert columns["failed"].tolist() == [[False, True, False]]
    assert (columns["chance"], columns["not_started"].tolist()) == ([0.5], [0.0])


@pytest.fixture(scope="module")
def starting_torques():
    return gd.studies.starting_torque(BARE, **FEW)


def test_each_gear_is_found_alone(starting_torques):
    assert starting_torques.starting_torque.dims == ("sam_fraction", "seed")
    at = starting_ramp.seated(BARE, {"contact.seed": 1})
    assert float(starting_torques.place[1]) == at.initial.mesh_phase
    scale, (rate,) = starting_torques.ramp_end.item() / 8.0, starting_torques.rate.values
    assert rate == pytest.approx(
        starting_ramp.ramp_rate(starting_ramp.pitch_of(at), scale, 1), rel=1e-12, abs=0
    )
    assert starting_torques.median_change.item() < 0.1


def test_bare_teeth_hold_more_and_dry_resistance_adds_to_them():
    """A dry resistance presses the teeth before they start: not much, as it is a tenth of what adhesion takes."""
    weak = GEARS.replace({"drive.torque": 1e-13})
    free = gd.studies.starting_torque(weak, [1.0, 0.0], seeds=1)
    coated, bare = free.starting_torque.values[:, 0]
    assert bare > 10.0 * coated
    assert free.chance.values.tolist() == [float(coated < 1e-13), 0.0]
    assert (free.not_started == 0.0).all()
    dry = gd.studies.starting_torque(BARE.replace({"load.torque": 0.4 * bare}), seeds=1)
    assert float(dry.starting_torque[0, 0]) == pytest.approx(1.1 * bare, rel=0.1, abs=0)
    said = answer(dry, kind_of(dry))
    assert said.sentence.startswith("SAM 0 %: one gear of this design starts at ")
    assert said.rows[0][0] == "Starting torque of 1 gear, SAM 0 %"


@pytest.mark.by_hand
def test_bare_gears_start_as_those_of_a_prototype():
    """A tenth is what half of its own rate may have changed the prototype's median, 1.1e-11 N m, by.

    Eight of its gears started at 1e-11 N m at once. One more or less may: of those close to their limit, what is left
    of the motion decides.
    """
    ds = gd.studies.starting_torque(BARE.replace({"drive.torque": 1e-11}), seeds=10)
    assert float(ds.quantiles.sel(quantile=0.5)[0]) == pytest.approx(1.1e-11, rel=0.1, abs=0)
    assert abs(int(ds.starts.sum()) - 8) <= 1


def test_what_a_population_does_not_take_is_named():
    cases = (
        ({"impacts": 2}, "impacts"),
        ({"lowest": 1e-20}, "lowest"),
        ({"simulated": False}, "simulated"),
        ({"tolerance": 0.5}, "tolerance"),
        ({"seeds": 0}, "seeds"),
        ({"sam_fraction": "all"}, "sam_fraction"),
    )
    for settings, name in cases:
        with pytest.raises(gd.SceneError, match=name):
            gd.studies.starting_torque(BARE, **settings)
    with pytest.raises(gd.SceneError, match="discrete"):
        gd.studies.starting_torque(gd.preset("teodorescu2009"), seeds=3)
