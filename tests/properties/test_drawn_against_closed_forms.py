"""Dry loads that begin, films, laws that switch and break-away over drawn scenes, against closed forms or own samples.

Each kind has one law that knows nothing of the solver: the dry loss is the integral of the dry torque over the
samples' own way, a film closes the balance, the momentum of both shafts changes by the impulse of a pulse, the energy
of a pinion in flight by the work of sectors of its angle, and gears that their hubs hold break away at the torque of
the closed form. Every scene is run at three tolerances by both methods of the native driver, and once by the portable
driver, which takes some twenty times as long: methods and tolerances in turn.
"""

import itertools
import math

import numpy as np
import pytest

import gearidae as gd
from engine.test_standing import PAIR, held_by_hubs
from gearidae.mesh import friction
from properties.test_what_physics_demands import HIGH, SLOW, _dry
from reference.own_pair import TEETH_27_50

FEW, MANY = 2, 100
RTOLS = (1e-5, 1e-6, 1e-7)
METHODS = ("auto", "bdf")
TURNS = tuple(itertools.product(METHODS, RTOLS))
MOTION = gd.preset("teodorescu2009_low_speed").replace(
    {"load.drag": 0.0, "drive.torque": 0.0, "run.duration": 4e-3, "run.samples": 9}
)


def pulse(t, speed, p):
    return p[0] if p[1] <= t < p[1] + p[2] else 0.0


def pulse_ends(p, t_end):
    return (p[1], p[1] + p[2])


def sectors(t, angle, speed, p):
    return p[0] if math.cos(p[1] * angle) > p[2] else 0.0


def sector_ends(t, angle, speed, p):
    return math.cos(p[1] * angle) - p[2]


LAWS = {
    "drawn_pulse": (pulse, ("torque", "begin", "width"), {}),
    "drawn_pulse_with_knots": (pulse, ("torque", "begin", "width"), {"knots": pulse_ends}),
    "drawn_sectors_of_cosine": (sectors, ("torque", "order", "above"), {}),
    "drawn_sectors_with_switch": (sectors, ("torque", "order", "above"), {"switch": sector_ends}),
}


@pytest.fixture(autouse=True, scope="module")
def _registered():
    register()
    yield
    for name in LAWS:
        gd.unregister_torque(name)


def register():
    for name, (function, parameters, declared) in LAWS.items():
        gd.register_torque(name, parameters=parameters, **declared)(function)


def balanced(ds):
    balance = ds.gearidae.energy_balance
    assert abs(balance["residual"]) <= balance["residual_bound"]
    return balance


def dry_load(seed):
    """A dry load that begins while a slow gear rings in its adhesion."""
    rng = np.random.default_rng([1, seed])
    start = float(rng.uniform(0.02, 0.06))
    end = start + float(rng.uniform(0.01, 0.04))
    scene = SLOW.replace(
        {
            **TEETH_27_50,
            "coating.sam_fraction": float(rng.uniform(0.3, 0.55)),
            "drive.torque": float(rng.uniform(2.5e-18, 6e-18)),
            "load.torque": float(rng.choice([0.0, 1e-21])),
            "load.schedule": [[0.0, 0.0], [start, 0.0], [end, float(rng.uniform(2e-18, 8e-18))]],
            "run.duration": end + 0.01,
            "run.samples": 20_001,
        }
    )

    def holds(ds):
        speed, dry, balance = ds.gear_speed.values, _dry(scene, ds), balanced(ds)
        moves = np.abs(speed) > 1e-3 * np.abs(speed).max()
        assert (dry[moves] * np.sign(speed[moves]) >= -1e-9 * dry.max()).all()
        own = float(np.trapezoid(np.abs(dry * speed), ds.time))
        # a period of the ringing has some tens of samples: 3 %
        assert balance["dry_loss"] == pytest.approx(own, rel=0.03, abs=balance["residual_bound"])
        return balance["dry_loss"] / own - 1.0

    return scene, holds


def film(seed):
    """Gears at speed with a film, on single asperities or statistical ones."""
    rng = np.random.default_rng([2, seed])
    scene = HIGH.replace(
        {
            "run.duration": 1e-5,
            "run.samples": "off",
            "coating.sam_fraction": float(rng.choice([0.0, 0.3, 1.0])),
            "mesh.film_damping": float(2e-6 * 10 ** rng.uniform(-1, 0)),
            "mesh.film_gap": float(10 ** rng.uniform(-8, -6.5)),
            "initial.gap": float(rng.uniform(1.5e-8, 1.8e-7)),
            "contact.roughness": str(rng.choice(["discrete", "discrete", "statistical"])),
            "contact.seed": seed,
        }
    )

    def holds(ds):
        balance = balanced(ds)
        assert balance["film_loss"] >= 0.0
        return balance["residual"] / balance["residual_bound"]

    return scene, holds


def switching_law(seed):
    """A pulse on gears in mesh, or sectors of the angle of a pinion in flight, declared or not."""
    rng = np.random.default_rng([3, seed])
    return _sectors(rng, seed) if seed % 3 == 2 else _pulse(rng, seed)


def _pulse(rng, seed):
    shaft = str(rng.choice(["drive", "load"]))
    torque = float(rng.uniform(0.05, 0.4)) * (3e-16 if shaft == "drive" else 1e-16)
    width = float(10 ** rng.uniform(-5, -3.3))
    law = {"torque": torque, "begin": float(rng.uniform(2e-4, 3e-3)), "width": width}
    changes = {
        f"{shaft}.law": {"name": ("drawn_pulse", "drawn_pulse_with_knots")[seed % 2], **law},
        "coating.sam_fraction": float(rng.choice([0.4, 0.7, 1.0])),
    }
    scene = MOTION.replace(changes)
    ratio = scene.gears.gear_teeth / scene.gears.pinion_teeth

    def holds(ds):
        if float(ds.min_gear_speed) <= 0.0:  # a load that brakes the gear to rest gives less
            assert shaft == "load"
            return 0.0
        momentum = (
            ratio * scene.gears.pinion_inertia * ds.pinion_speed + scene.gears.gear_inertia * ds.gear_speed
        )
        impulse = (ratio if shaft == "drive" else -1.0) * torque * width
        share = float(momentum[-1] - momentum[0]) / impulse
        assert share == pytest.approx(1.0, abs=1e-3)
        return share - 1.0

    return scene, holds


def _sectors(rng, seed):
    torque, order = float(rng.uniform(0.5, 2.0)) * 1e-17, float(rng.uniform(100.0, 600.0))
    above = float(rng.uniform(-0.8, 0.8))
    name = ("drawn_sectors_of_cosine", "drawn_sectors_with_switch")[seed % 2]
    scene = MOTION.replace(
        {
            "drive.law": {"name": name, "torque": torque, "order": order, "above": above},
            "mesh.backlash": 4e-6,  # nothing is touched in 4 ms
            "initial.gap": 2e-6,
            "run.samples": 101,
        }
    )
    half = math.acos(above)

    def within(x):
        whole, rest = divmod(order * x, 2.0 * math.pi)
        return (whole * 2.0 * half + min(rest, half) + max(0.0, rest - (2.0 * math.pi - half))) / order

    def holds(ds):
        angle, speed = ds.pinion_angle.values, ds.pinion_speed.values
        work = np.array([torque * within(x - angle[0]) for x in angle])
        energy = 0.5 * scene.gears.pinion_inertia * (speed**2 - speed[0] ** 2)
        worst = float(np.abs(energy - work).max() / work[-1])
        assert worst <= 1e-3
        return worst

    return scene, holds


def break_away(seed):
    """Hubs hold gears under a dry load and a torque that rises, until they have turned by more than half a pitch."""
    rng = np.random.default_rng([4, seed])
    coefficient = float(rng.uniform(0.1, 0.4))
    radii = (float(rng.uniform(2e-6, 8e-6)), float(rng.uniform(5e-6, 20e-6)))
    dry = float(10 ** rng.uniform(-16.5, -15.3))
    wanted = friction.hub_starting_torque(PAIR.geometry, dry, coefficient, radii)
    ramp, top = float(rng.uniform(0.3, 0.6)), wanted * float(rng.uniform(1.5, 3.0))
    scene = PAIR.replace(held_by_hubs(coefficient, radii, dry, top, ramp))

    def holds(ds):
        share = float(ds.breakaway_torque) / wanted
        assert share == pytest.approx(1.0, abs=2e-3)  # teeth ring by some parts of ten thousand
        return share - 1.0

    return scene, holds


KINDS = {f.__name__: f for f in (dry_load, film, switching_law, break_away)}


def check(kind, seed, backend, method, rtol):
    """What `holds` gives: by how much the run is off."""
    scene, holds = KINDS[kind](seed)
    return holds(gd.simulate(scene.replace({"run.method": method}), rtol=rtol, backend=backend))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(FEW))
def test_a_drawn_scene(kind, seed):
    check(kind, seed, "native", METHODS[seed % 2], 1e-6)


@pytest.mark.by_hand
@pytest.mark.parametrize(("method", "rtol"), TURNS)
@pytest.mark.parametrize("kind", KINDS)
def test_many_drawn_scenes(kind, method, rtol):
    for seed in range(MANY):
        check(kind, seed, "native", method, rtol)


@pytest.mark.by_hand
@pytest.mark.parametrize("kind", KINDS)
def test_many_drawn_scenes_by_the_portable_driver(kind):
    for seed in range(MANY):
        check(kind, seed, "sksundae", *TURNS[seed % len(TURNS)])
