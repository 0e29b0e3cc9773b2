"""Errors of single teeth and runout in the engine: reference runs, and what such errors are equal to."""

import numpy as np
import pytest
from scipy.optimize import brentq

import gearidae as gd
from balances import assert_closes
from gearidae.engine import solve
from gearidae.engine.model.state import COAST, DRIVE, PHASE, U
from gearidae.engine.motion.pair_forces import force_of_one
from gearidae.engine.pairs.tooth_pairs import pair_gap
from gearidae.engine.setup.build import make_problem
from gearidae.engine.teeth import states_at
from gearidae.records import EventKind, Flank

REALISTIC = gd.Scene.from_dict(
    {
        "gears": {
            "pinion_inertia": 9.6e-21,
            "gear_inertia": 4.2e-18,
            "pinion_base_radius": 34.715e-6,
            "pinion_teeth": 19,
            "gear_teeth": 76,
            "pressure_angle": "20 deg",
            "face_width": 2.25e-6,
        },
        "mesh": {
            "backlash": 0.5e-6,
            "tip_relief_radius": 10e-6,
            "radius_force": False,
            "damping": 3e-6,
        },
        "surface": {
            "youngs_modulus": 161e9,
            "poisson_ratio": 0.23,
            "energy": 1.2,
            "asperity_density": 169e12,
            "asperity_radius": 130e-9,
            "roughness": 6e-9,
        },
        "coating": {"sam_fraction": 1.0, "energy": 0.02, "thickness": 1e-9},
        "contact": {"asperity": "hertz", "bodies": "rigid"},
        "drive": {"torque": 1.2e-11},
        "load": {"torque": 3e-11, "drag": 8e-18},
        "initial": {"gear_speed": 940.0, "gap": 36e-9, "mesh_phase": 0.3},
        "run": {"duration": 150e-6, "samples": 4, "rtol": 1e-11},
    }
)
"""A drive gear of 64 um and a load gear of 300 um, of which an independent integrator (DOP853 at 1e-11) has solved the
equations of motion: the numbers below are its."""
ONE_OF_EACH = {
    "mesh.pinion_pitch_error": [0.0, -15e-9, *[0.0] * 17],
    "mesh.gear_pitch_error": [0.0, 0.0, 10e-9, *[0.0] * 73],
}
RUNOUT = {
    "mesh.pinion_runout": {"amplitude": "20 nm", "phase": 0.5},
    "mesh.gear_runout": {"amplitude": "60 nm", "phase": -1.0},
}
EXPECTED = [
    (ONE_OF_EACH, 2, (4594.793035, 1148.782711, 3.437748e-7)),
    (ONE_OF_EACH, 3, (4902.481457, 1225.655132, 3.441513e-7)),
    ({"mesh.pinion_runout": RUNOUT["mesh.pinion_runout"]}, 1, (4217.044491, None, None)),
    (RUNOUT, 1, (4219.194823, 1054.987567, 3.432789e-7)),
    (RUNOUT, 2, (4597.399499, 1149.584568, 3.436172e-7)),
    (RUNOUT, 3, (4903.587997, 1226.239744, 3.439778e-7)),
    ({}, 1, (4219.527791, 1054.995671, 3.434303e-7)),
    ({}, 2, (4598.397598, 1149.646831, None)),
]
BACKENDS = ["native", "sksundae"]


def in_both(cases, also):
    """Each case with the native driver, and with the portable one, by hand those that are not in `also`."""
    return [
        pytest.param(
            *case, backend, marks=pytest.mark.by_hand if backend != "native" and case[0] not in also else ()
        )
        for case in cases
        for backend in BACKENDS
    ]


HALF = {"run.duration": 60e-6, "run.samples": 61, "run.rtol": 1e-9}


@pytest.fixture(scope="module")
def runs():
    """Runs of the scene with changes, each made once."""
    made = {}

    def run(changes, backend="native"):
        key = repr(changes), backend
        if key not in made:
            made[key] = solve(REALISTIC.replace(changes), backend=backend)
        return made[key]

    return run


# -- numbers of an independent integrator ----------------------------------------------------------------------------


@pytest.mark.parametrize(("changes", "sample", "expected", "backend"), in_both(EXPECTED, also=(RUNOUT,)))
def test_motion_is_that_of_an_independent_integrator(runs, changes, sample, expected, backend):
    """To the digits that are given: of speeds a few tolerances, of forces half of the last digit."""
    samples = runs(changes, backend).samples
    for name, value, allowed in zip(
        ("pinion_speed", "gear_speed", "mesh_force"), expected, (1e-9, 1e-9, 2e-7), strict=True
    ):
        if value is not None:
            assert samples[name][sample] == pytest.approx(value, rel=allowed), name


@pytest.mark.parametrize(
    ("changes", "samples", "backend"),
    in_both(
        [
            (ONE_OF_EACH, {2: {0: 1.9438e-12, 1: 3.43808e-7}, 3: {1: 3.44166e-7}}),
            ({}, {2: {0: 1.97517e-7, 1: 1.46285e-7}}),
            (
                RUNOUT,
                {
                    1: {0: 3.43326e-7},
                    2: {0: 1.97423e-7, 1: 1.46214e-7},
                    3: {1: 2.10086e-7, 2: 1.33914e-7},
                },
            ),
        ],
        also=({},),
    ),
)
def test_pairs_share_the_force_as_their_teeth_stand(changes, samples, backend):
    states = states_at(REALISTIC.replace(changes), list(samples), backend=backend)
    for state, expected in zip(states, samples.values(), strict=True):
        forces = {c.pair: c.force for c in state.contacts if c.flank == Flank.DRIVE and c.force != 0.0}
        loaded = {pair: force for pair, force in forces.items() if force > 1e-13}
        assert loaded == pytest.approx(expected, rel=2e-5)


@pytest.mark.parametrize(
    ("error", "expected"),
    [
        (2e-9, (19.656268e-9, 2.298553e-7, 3.714471e-8)),
        (0.0, (20.171229e-9, 1.626605e-7, 1.043395e-7)),
    ],
)
def test_two_pairs_at_rest_carry_a_force_by_their_gaps(error, expected):
    scene = REALISTIC.replace({"mesh.pinion_pitch_error": [error, *[0.0] * 18]})
    m = make_problem(scene).model
    length, force, clearance = (
        float(x) for x in (m.scene.length_unit, m.scene.force_unit, m.scene.clearance[DRIVE])
    )

    def forces(gap):
        y = np.zeros(4)
        y[U], y[PHASE] = clearance - gap / length, 0.3
        return [force_of_one(m, 0.0, y, DRIVE, pair) * force for pair in (-1, 0)]

    gap = brentq(lambda gap: sum(forces(gap)) - 2.67e-7, 10e-9, 30e-9, xtol=1e-17)
    assert (gap, *forces(gap)) == pytest.approx(expected, rel=5e-7)


# -- what errors are equal to ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("side", ["pinion", "gear"])
def test_errors_that_are_all_equal_shift_the_backlash(runs, side):
    """By q on one flank and -q on the other: u moves by q, and nothing else changes, from the same gap."""
    teeth, q = {"pinion": 19, "gear": 76}[side], 7e-9
    plain, shifted = runs(HALF).samples, runs(HALF | {f"mesh.{side}_pitch_error": [q] * teeth}).samples
    for name in ("pinion_speed", "gear_speed", "mesh_force", "drive_gap", "coast_gap"):
        scale = np.abs(plain[name]).max()  # forces change by e^6 in a roughness
        np.testing.assert_allclose(shifted[name], plain[name], atol=1e-7 * scale, rtol=0, err_msg=name)
    moved = shifted["transmission_error"] - plain["transmission_error"]
    np.testing.assert_allclose(moved, q, rtol=1e-6)


def test_a_sum_that_is_the_same_for_all_pairs_changes_nothing(runs):
    opposite = {"mesh.pinion_pitch_error": [4e-9] * 19, "mesh.gear_pitch_error": [-4e-9] * 76}
    plain, both = runs(HALF).samples, runs(HALF | opposite).samples
    for name in ("pinion_speed", "gear_speed", "mesh_force", "drive_gap", "coast_gap", "transmission_error"):
        np.testing.assert_allclose(both[name], plain[name], rtol=1e-9, err_msg=name)


def test_errors_of_the_pinion_are_asperities_that_stand_lower():
    """On the drive flanks, which alone are in reach here."""
    scene = REALISTIC.replace(
        {
            "contact.roughness": "discrete",
            "mesh.damping": 3e-6,
            "initial.gap": 22e-9,
            "run.duration": 40e-6,
            "run.samples": 41,
            "run.rtol": 1e-9,
        }
    )
    drawn = gd.population(scene)
    errors = np.zeros(19)
    errors[[1, 2]] = -6e-9, 3e-9
    keep = np.flatnonzero((drawn["flank"].to_numpy() == DRIVE) & np.isin(drawn["tooth"], [17, 18, 0, 1, 2]))
    columns = {
        "arc": drawn["arc"].to_numpy()[keep],
        "height": drawn["height"].to_numpy()[keep],
        "tooth": drawn["tooth"].to_numpy()[keep],
        "flank": ["drive"] * keep.size,
    }
    lower = columns | {"height": columns["height"] - errors[columns["tooth"]]}
    by_errors = solve(
        scene.replace({"contact.asperities": columns, "mesh.pinion_pitch_error": errors.tolist()})
    )
    by_heights = solve(scene.replace({"contact.asperities": lower}))
    assert_closes(scene, by_errors)
    for name in ("pinion_speed", "gear_speed", "mesh_force"):
        scale = np.abs(by_heights.samples[name]).max()
        np.testing.assert_allclose(
            by_errors.samples[name], by_heights.samples[name], atol=1e-6 * scale, err_msg=name
        )
    assert by_errors.extremes.asperity_onsets == by_heights.extremes.asperity_onsets > 0


def test_an_error_is_constant_within_a_tooth():
    """Sampled at the teeth a wave is no static error: the gap of a pair is shifted alike all along the path."""
    wave = (5e-9 * np.cos(2.0 * np.pi * 3 * np.arange(19) / 19)).tolist()
    plain, waved = (
        make_problem(scene).model
        for scene in (REALISTIC, REALISTIC.replace({"mesh.pinion_pitch_error": wave}))
    )
    for flank, sign in ((DRIVE, 1.0), (COAST, -1.0)):
        for pair in (-1, 0, 1):
            moved = [
                (
                    pair_gap(waved, flank, pair, 2.0, 0.0, x, 0.0)[0],
                    pair_gap(plain, flank, pair, 2.0, 0.0, x, 0.0)[0],
                )
                for x in np.linspace(-0.4, 1.9, 9)
            ]
            shift = np.array([a - b for a, b in moved]) * float(plain.scene.length_unit)
            np.testing.assert_allclose(shift, sign * wave[pair % 19], atol=1e-20)


def test_the_coast_flank_of_a_space_belongs_to_the_next_tooth_of_the_gear():
    scene = REALISTIC.replace({"mesh.gear_pitch_error": [0.0, 8e-9, *[0.0] * 74]})
    m = make_problem(scene).model
    shift = {
        flank: [
            (
                pair_gap(m, flank, pair, 0.0, 0.0, 0.5, 0.0)[0]
                - pair_gap(m, flank, pair + 2, 0.0, 0.0, 2.5, 0.0)[0]
            )
            * float(m.scene.length_unit)
            for pair in (0, 1)
        ]
        for flank in (DRIVE, COAST)
    }
    assert shift[DRIVE] == pytest.approx([0.0, 8e-9], abs=1e-20)
    assert shift[COAST] == pytest.approx([-8e-9, 0.0], abs=1e-20)


# -- what follows ----------------------------------------------------------------------------------------------------


def test_the_initial_gap_is_the_smallest_of_the_pairs_on_the_path():
    errors = np.linspace(-8e-9, 9e-9, 19)
    scene = REALISTIC.replace({"mesh.pinion_pitch_error": errors.tolist()})
    (start,) = states_at(scene, [0], backend="native")
    gaps = {c.pair: c.gap for c in start.contacts if c.flank == Flank.DRIVE}
    assert min(gaps.values()) == pytest.approx(36e-9, rel=1e-12)
    assert gaps[0] - gaps[-1] == pytest.approx(errors[0] - errors[-1], rel=1e-9)


def test_a_tooth_that_stands_out_touches_before_it_enters(runs):
    """Where its tip relief d^2 / 2 rho opens as much more as it stands out: by 60 nm at 1.2 um, a tenth of a pitch."""
    out, rho = 60e-9, 10e-6
    speed = 139e-6 * runs({}).samples["gear_speed"][1]

    def reliefs(changes):
        events = runs(changes).events
        of_pair = (events.pair == 1) & (events.flank == Flank.DRIVE)
        onset, entry = (
            events.time[of_pair & (events.kind == kind)][0]
            for kind in (EventKind.ONSET, EventKind.MESH_ENTRY)
        )
        return (speed * (entry - onset)) ** 2 / (2.0 * rho)

    early, late = reliefs({"mesh.pinion_pitch_error": [0.0, -out, *[0.0] * 17]}), reliefs({})
    # by the speed of one time, and with the gap of the other pairs, which breathes by a roughness
    assert early - late == pytest.approx(out, rel=0.2)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    "changes",
    [
        {"mesh.pitch_error_rms": 10e-9, "mesh.pitch_error_seed": 1},
        RUNOUT,
        RUNOUT | {"mesh.pitch_error_rms": 10e-9, "mesh.static_error": [{"order": 19, "amplitude": 2e-9}]},
    ],
)
@pytest.mark.parametrize("law", ["hertz", "jkr"])
def test_energy_is_kept(runs, changes, law, backend):
    changes = changes | {"contact.asperity": law, "run.rtol": 1e-8}
    assert_closes(REALISTIC.replace(changes), runs(changes, backend))


def test_runout_of_a_gear_that_is_held_at_speed_is_seen_once_in_its_turn():
    """Closed form: with stiff teeth ``R2 w2 (1 + a/R2 sin) = R1 w1``: speeds differ by a/R2 once a turn of the gear."""
    amplitude, duration = 2e-6, 2.0 * np.pi / 940.0
    scene = REALISTIC.replace(
        {
            "mesh.gear_runout": {"amplitude": amplitude},
            "mesh.damping": 3e-4,
            "initial.mesh_phase": 0.0,
            "run.duration": duration,
            "run.samples": 257,
            "run.rtol": 1e-6,
        }
    )
    samples = solve(scene).samples
    ratio = samples["pinion_speed"] / samples["gear_speed"] / 4.0
    angle = samples["gear_angle"]
    wave = np.linalg.lstsq(np.stack([np.cos(angle), np.sin(angle)], 1)[9:], (ratio - 1.0)[9:], rcond=None)[0]
    radius = scene.geometry.base_radius_gear
    # the gap breathes by some nanometres with pairs and load
    assert wave == pytest.approx([0.0, -amplitude / radius], abs=0.02 * amplitude / radius)


def test_turns_of_both_gears_are_counted_for_their_teeth(runs):
    """A run that starts a turn of the gear later, 76 pitches, is the same; half a turn later other teeth meet."""
    drawn = {"mesh.pitch_error_rms": 6e-9, "mesh.pitch_error_seed": 4}
    first = runs(HALF | drawn).samples["gear_speed"]
    turned = runs(HALF | drawn | {"initial.mesh_phase": 76.3}).samples["gear_speed"]
    other = runs(HALF | drawn | {"initial.mesh_phase": 38.3}).samples["gear_speed"]
    np.testing.assert_allclose(turned, first, rtol=1e-8)
    assert np.abs(other - first).max() > 1e-5 * np.abs(first).max()


def test_a_flank_s_nearest_gap_is_no_larger_than_that_of_any_pair():
    scene = REALISTIC.replace({"mesh.pitch_error_rms": 10e-9, "mesh.pitch_error_seed": 2})
    m = make_problem(scene).model
    for flank, u in ((DRIVE, -1.0), (COAST, 1.0)):
        least = min(
            pair_gap(m, flank, pair, 0.0, 0.0, pair + 0.5 if flank == DRIVE else pair + 0.9, 0.0)[0]
            for pair in range(76)
        )
        assert float(m.scene.nearest[flank]) == pytest.approx(least, rel=1e-12), u


def test_a_tooth_that_stands_out_elsewhere_changes_nothing():
    """The bound of a flank's gaps is that tooth's, also where it is not in mesh; bodies may deflect."""
    scene = gd.preset("teodorescu2009").replace({"run.duration": "3 us", "run.samples": 3001})
    other = gd.simulate(scene.replace({"mesh.pinion_pitch_error": [0.0, -3e-8] + [0.0] * 17}))
    alike = gd.simulate(scene)
    assert other.attrs["steps"] < 2 * alike.attrs["steps"]
    np.testing.assert_allclose(other.gear_speed, alike.gear_speed, rtol=1e-5)  # runs of a tolerance of 1e-6
    nearest = min(float(other.drive_gap.min()), float(other.coast_gap.min()))
    assert float(other.smallest_separation) == pytest.approx(nearest, rel=0, abs=1e-11)
