"""What physics demands of every run, whatever features its scene combines, over drawn scenes.

A loss takes energy. Work less losses less the change of energy vanishes within the bound of the balance, which falls
with the tolerance. The momentum of both shafts changes by their torques. A dry load opposes the motion. A run that is
cut in two and continued is the whole run. Each of these holds for any torque and any law of contact, so that a scene
needs no reference solution.
"""

import numpy as np
import pytest

import gearidae as gd
from reference.own_pair import OWN_PAIR

FEW, MANY = 40, 2_000
LOSSES = (
    "drag_loss", "dry_loss", "damping_loss", "film_loss", "adhesion_loss", "drive_friction_loss", "coast_friction_loss",
    "pinion_hub_loss", "gear_hub_loss", "pin_loss",
)  # fmt: skip
HIGH = gd.preset("teodorescu2009").replace({"contact.bodies": "rigid"})
SLOW = gd.Scene.from_dict(
    {
        **OWN_PAIR,
        "surface": HIGH.to_dict()["surface"],
        "coating": {"sam_fraction": 1.0, "energy": 0.1},
        "contact": {"bodies": "rigid"},
        "drive": {"torque": 3e-18},
        "run": {"duration": 1.2},
    }
)


def drawn(seed):
    """Draw a scene: gears at speed for 20 us, or slow ones that start under a dry load which begins while they ring."""
    rng = np.random.default_rng(seed)
    is_fast = rng.random() < 0.5
    scene = _fast(rng) if is_fast else _slow(rng)
    changes = {"coating.sam_fraction": float(rng.choice([0.0 if is_fast else 0.5, 0.35, 0.6, 1.0]))}
    if rng.random() < 0.5:
        width = 2e-6 if "teodorescu" in scene.name else 1e-5
        changes |= {
            "mesh.film_damping": float(width * 10 ** rng.uniform(-1, 0)),
            "mesh.film_gap": float(rng.choice([3e-8, 3e-7])),
        }
    if rng.random() < 0.5 and is_fast:  # of slow gears that ring on single asperities a run takes minutes
        changes["contact.roughness"] = "discrete"
    elif rng.random() < 0.3:
        changes |= {
            "contact.asperity": "meniscus",
            "surface.humidity": float(rng.uniform(0.3, 0.9)),
            "surface.bridged": 0.5,
        }
    elif rng.random() < 0.3 and is_fast:
        changes |= {"surface.hamaker": 5e-20, "coating.hamaker": 2e-20}
    if rng.random() < 0.3:
        changes["mesh.radius_force"] = True
    if rng.random() < 0.3:
        changes["mesh.static_error"] = [{"order": 19, "amplitude": 1e-9, "phase": 0.3}]
    if rng.random() < 0.3:
        changes |= {"gears.hub_friction": 0.2, "gears.pinion_hub_radius": 3e-6, "gears.gear_hub_radius": 6e-6}
    return scene.replace(changes)


def _fast(rng):
    scene = HIGH.replace(
        {"run.duration": 2e-5, "run.samples": 4001, "initial.gap": float(rng.uniform(1.5e-8, 1.8e-7))}
    )
    if rng.random() < 0.4:
        scene = scene.replace({"load.viscous": 2e-15})
    if rng.random() < 0.4:
        scene = scene.replace({"load.torque": 0.0, "load.schedule": [[5e-6, 0.0], [1.5e-5, 6e-11]]})
    return scene


def _slow(rng):
    start = float(rng.uniform(0.1, 0.3))
    end = start + float(rng.uniform(0.05, 0.2))
    return SLOW.replace(
        {
            "gears.pinion_teeth": 27,
            "gears.gear_teeth": 50,
            "gears.module": 3.09e-6,
            "drive.torque": float(rng.uniform(2.5e-18, 6e-18)),
            "load.torque": float(rng.choice([0.0, 1e-21])),
            "load.schedule": [[0.0, 0.0], [start, 0.0], [end, float(rng.uniform(2e-18, 8e-18))]],
            "run.duration": end + 0.05,
            "run.samples": 8001,
        }
    )


def check(seed):
    scene = drawn(seed)
    runs = [gd.simulate(scene, rtol=rtol) for rtol in (1e-6, 1e-7)]
    bounds = []
    for ds in runs:
        balance = ds.gearidae.energy_balance
        bounds.append(balance["residual_bound"])
        assert abs(balance["residual"]) <= balance["residual_bound"], "the balance"
        for name in LOSSES:
            assert balance[name] >= -balance["residual_bound"], name
    assert bounds[1] < bounds[0], "the bound falls with the tolerance"
    _opposes(scene, runs[1])
    _changes_by_torques(scene, runs[1])
    _continues(scene, *runs)


def _dry(scene, ds):
    """The dry part of the load's torque: what is left without both drags."""
    w = ds.gear_speed.values
    return ds.load_torque.values - scene.load.drag * w * np.abs(w) - scene.load.viscous * w


def _opposes(scene, ds):
    """But for the step in which the speed passes zero: where it is faster than a thousandth of the fastest."""
    w = ds.gear_speed.values
    moves = np.abs(w) > 1e-3 * np.abs(w).max()
    size = max(np.abs(ds.load_torque.values).max(), 1e-30)
    assert (_dry(scene, ds)[moves] * np.sign(w[moves]) >= -1e-9 * size).all(), "a dry load opposes"


def _changes_by_torques(scene, ds):
    """``n I1 w1 + I2 w2``, with the force of the tip relief on the gear alone; hubs have torques of their own."""
    if scene.gears.hub_friction > 0.0:
        return
    pinion, gear = scene.geometry.base_radius_pinion, scene.geometry.base_radius_gear
    momentum = (
        gear / pinion * scene.gears.pinion_inertia * ds.pinion_speed
        + scene.gears.gear_inertia * ds.gear_speed
    )
    force = ds.gear_contact_torque - gear * ds.mesh_force
    rate = gear / pinion * ds.drive_torque - ds.load_torque + force
    if scene.mesh.static_error:  # the lever of the pinion changes by e'
        return
    impulse = np.trapezoid(rate.values, ds.time.values)
    size = np.trapezoid(np.abs(rate.values), ds.time.values) + float(np.abs(momentum).max())
    # samples miss what lies between them: a thousandth
    assert abs(float(momentum[-1] - momentum[0]) - impulse) <= 2e-3 * size, "torques change the momentum"


def _continues(scene, looser, ds):
    """Ringing multiplies what a restart changes: a thousandth of the swing, or what the tolerance changes."""
    changes = {"run.duration": 0.5 * scene.run.duration, "run.samples": 3}
    half = gd.simulate(scene.replace(changes), rtol=1e-7)
    rest = gd.simulate(scene.replace(changes), rtol=1e-7, start=half)
    last = float(ds.gear_speed[-1])
    allowed = max(1e-3 * float(np.ptp(ds.gear_speed.values)), abs(last - float(looser.gear_speed[-1])))
    assert abs(float(rest.gear_speed[-1]) - last) <= allowed, "a continued run is the whole"


@pytest.mark.parametrize("seed", range(FEW))
def test_a_drawn_run(seed):
    check(seed)


@pytest.mark.by_hand
@pytest.mark.parametrize("block", range(MANY // 100))
def test_many_drawn_runs(block):
    for seed in range(1000 + 100 * block, 1100 + 100 * block):
        check(seed)
