"""Work of friction among the exposures: against the energy balance and the sliding work, and through interruptions."""

import itertools

import numpy as np
import pytest

import gearidae as gd
from gearidae.engine.backend import solve
from gearidae.engine.observers.exposures.bins import ROWS

SMOOTH = gd.preset("teodorescu2009").replace(
    {"contact.bodies": "rigid", "run.exposures": 8, "run.duration": 6e-5, "run.samples": "off"}
)
HUBS = {"gears.hub_friction": 0.3, "gears.pinion_hub_radius": "3 um", "gears.gear_hub_radius": "6 um"}
SHEAR = {
    "contact.friction_law": "shear",
    "contact.shear_strength": "10 MPa",
    "coating.shear_strength": "1 MPa",
}
RUBBING = SMOOTH.replace({"contact.friction": 0.3})
SCENES = {
    "one coefficient": {"contact.friction": 0.3},
    "two coefficients": {"contact.friction": 0.3, "coating.friction": 0.1, "coating.sam_fraction": 0.5},
    "by tooth": {
        "contact.friction": 0.3,
        "coating.friction": 0.1,
        "coating.pinion_table": [[0.2, 0.9], [0.6, 0.4]] * 9 + [[0.5, 0.5]],
    },
    "shear": SHEAR | {"coating.sam_fraction": 0.5},
    "with hubs": HUBS | {"contact.friction": 0.3},
    "both flanks": {
        "contact.friction": 0.3,
        "load.torque": 0.0,
        "mesh.backlash": "60 nm",
        "initial.gap": "24 nm",
    },
    "asperities": {
        "contact.roughness": "discrete",
        "contact.friction": 0.3,
        "coating.friction": 0.1,
        "coating.sam_fraction": 0.5,
    },
    "elastic bodies": {
        "contact.bodies": "elastic",
        "contact.friction": 0.3,
        "coating.friction": 0.1,
        "coating.sam_fraction": 0.5,
        "run.duration": 2e-5,
    },
    "flanks that attract": HUBS | {"contact.friction": 0.3, "coating.hamaker": 5e-20},
    "asperities and hubs": HUBS | {"contact.roughness": "discrete", "contact.friction": 0.3},
    "asperities and shear": SHEAR | {"contact.roughness": "discrete", "coating.sam_fraction": 0.5},
}


def losses(ds):
    """Losses of the drive and the coast flank to friction, from the energy balance [J]."""
    balance = ds.gearidae.energy_balance
    return [balance["drive_friction_loss"], balance["coast_friction_loss"]]


def sums(ds):
    """Work of friction of the drive and the coast flank [J], from the values per area."""
    return (ds.friction_work * ds.flank_area).sum(("tooth", "place")).values


@pytest.mark.parametrize("name", SCENES)
def test_all_places_together_lose_what_the_balance_says(name):
    """To rounding: it is the balance's quadrature, added up by places."""
    ds = gd.simulate(SMOOTH.replace(SCENES[name]))
    assert losses(ds)[0] > 0.0
    np.testing.assert_allclose(sums(ds), losses(ds), rtol=1e-12, atol=0)
    assert float(ds.friction_work.min()) >= 0.0
    if name == "both flanks":
        assert losses(ds)[1] > 0.0


def test_each_place_loses_the_coefficient_times_its_sliding_work():
    """That is an independent integral, over other intervals, and leaves the normal vibration out of the speed."""
    ds = gd.simulate(RUBBING.replace({"run.duration": 3e-4}))
    work, sliding = ds.friction_work.values, 0.3 * ds.sliding_work.values
    assert work.sum() == pytest.approx(sliding.sum(), rel=1e-3, abs=0)
    # a step belongs to one place: the first and the last in it may be wrong by half of one of some hundred
    np.testing.assert_allclose(work, sliding, rtol=0, atol=5e-3 * work.max())
    assert (work > 0.0).sum() > 16


def test_places_only_divide():
    """More places keep the work of a tooth, and the motion to the last bit."""
    few, many = (gd.simulate(RUBBING.replace({"run.exposures": places})) for places in (8, 40))
    ours, other = ((ds.friction_work * ds.flank_area).sum("place").values for ds in (few, many))
    np.testing.assert_allclose(ours, other, rtol=1e-12, atol=0)
    none = gd.simulate(RUBBING.replace({"run.exposures": 0}))
    assert float(none.final_speed) == float(few.final_speed) == float(many.final_speed)


@pytest.mark.parametrize("changes", [{}, {"gears.hub_friction": 0.3, "gears.gear_hub_radius": "6 um"}])
def test_flanks_without_friction_keep_no_work_of_it(changes):
    ds = gd.simulate(SMOOTH.replace(changes))
    assert "friction_work" not in ds
    numbers = len(solve(SMOOTH.replace(changes)).extremes.exposures)
    assert numbers == 2 * 19 * ROWS.per_tooth(rubs=False) * 8
    rubbing = solve(RUBBING)
    assert len(rubbing.extremes.exposures) == 2 * 19 * ROWS.per_tooth(rubs=True) * 8


def test_archives_and_resumed_runs_have_it(tmp_path, monkeypatch):
    from gearidae.engine import native

    monkeypatch.setattr(native, "BLOCK_STEPS", 500)
    scene = RUBBING.replace({"run.checkpoints": [2e-5, 4e-5]})
    whole, path, asked = gd.simulate(scene), tmp_path / "run.nc", itertools.count()

    def stop(block):
        if block.time > 4.5e-5 and next(asked) == 0:
            raise KeyboardInterrupt

    with pytest.raises(gd.Interrupted):
        gd.simulate(scene, archive=path, on_block=stop)
    resumed = gd.simulate(scene, archive=path, resume=True)
    np.testing.assert_array_equal(resumed.friction_work, whole.friction_work)
    np.testing.assert_array_equal(gd.open_archive(path).friction_work, whole.friction_work)


@pytest.mark.parametrize("name", ["one coefficient", "asperities"])
def test_continued_runs_go_on_with_it(name):
    scene = SMOOTH.replace(SCENES[name])
    first = gd.simulate(scene)
    for changes in ({}, {"drive.torque": 4e-11}):  # of the second, units of force and time differ
        second = gd.simulate(scene.replace(changes), start=first)
        np.testing.assert_allclose(sums(second), losses(second), rtol=1e-12, atol=0)
        assert sums(second)[0] > 1.1 * sums(first)[0]


def test_a_continued_run_may_begin_with_friction_or_end_it():
    """The coating's friction may change: other exposures go on."""
    scene = SMOOTH.replace({"coating.sam_fraction": 1.0})
    rubbing = scene.replace({"coating.friction": 0.3})
    smooth = gd.simulate(scene)
    second = gd.simulate(rubbing, start=smooth)
    np.testing.assert_allclose(sums(second), losses(second), rtol=1e-12, atol=0)
    assert (second.sliding_work >= smooth.sliding_work).all()
    third = gd.simulate(scene, start=second)
    assert "friction_work" not in third
    assert (third.sliding_work >= second.sliding_work).all()


def test_sweeps_and_joined_runs_have_it(tmp_path):
    path = tmp_path / "sweep.nc"
    ds = gd.sweep(SMOOTH, {"contact.friction": [0.0, 0.3]}, keep=["exposures", "scene"], archive=path)
    assert ds.friction_work.dims == ("friction", "flank", "tooth", "place")
    assert float(ds.friction_work.isel(friction=0).sum()) == 0.0
    alone = gd.simulate(RUBBING)
    np.testing.assert_array_equal(ds.friction_work.isel(friction=1), alone.friction_work)
    np.testing.assert_array_equal(gd.open_archive(path).friction_work, ds.friction_work)
    other = gd.simulate(RUBBING.replace({"contact.friction": 0.2}))
    joined = gd.concat([alone, other], "contact.friction")
    np.testing.assert_array_equal(joined.friction_work.sel(friction=0.3), alone.friction_work)
    older = gd.concat([alone.drop_vars("friction_work"), other], "contact.friction")
    assert "friction_work" not in older
    assert "sliding_work" in older


def test_a_life_by_friction_is_that_by_sliding_with_its_coefficient():
    """With one coefficient, by windows and cycle by cycle; the work of both is the same to 1e-3, as above."""
    short = {"cycles": 1, "settle": 0, "starts": 1, "frequency": False, "tolerance": 0.1, "jobs": 1}
    short["passages"] = 10.0
    scene = RUBBING.replace({"coating.sam_fraction": 0.8, "run.exposures": 0})
    by_friction, by_sliding = (
        gd.studies.life(scene, gd.wear.loss_law(name, coefficient=k), **short)
        for name, k in (("friction_work", 1.0), ("sliding_work", 0.3))
    )
    lost = by_friction.coverage[0] - by_friction.coverage[-1]
    other = by_sliding.coverage[0] - by_sliding.coverage[-1]
    np.testing.assert_allclose(lost, other, rtol=2e-3)
    ratio = by_friction.passage_friction_work / by_friction.passage_sliding_work
    np.testing.assert_allclose(ratio, 0.3, rtol=1e-3)
    smooth = gd.studies.life(SMOOTH, gd.wear.loss_law("sliding_work", coefficient=0.3), **short)
    assert "passage_friction_work" not in smooth
