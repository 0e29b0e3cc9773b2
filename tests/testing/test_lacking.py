"""A run that has lost something is no run that agrees with its reference."""

import pytest

import gearidae as gd
from gearidae.testing import assert_runs_close

SCENE = gd.preset("teodorescu2009").replace({"run.duration": 1e-4, "run.samples": 101})


@pytest.fixture(scope="module")
def reference():
    return gd.simulate(SCENE)


def lost(ds, *names):
    return ds.drop_vars(names)


def without_rows(ds, dim):
    return ds.isel({dim: slice(0, 0)})


@pytest.mark.parametrize(
    ("change", "name"),
    [
        (lambda ds: lost(ds, "gear_speed"), "gear_speed"),
        (lambda ds: without_rows(ds, "event"), "events"),
        (lambda ds: without_rows(ds, "passage"), "passages"),
        (lambda ds: ds.drop_dims("event"), "events"),
        (lambda ds: ds.assign(gear_speed=ds.gear_speed.assign_attrs(units="rpm")), "gear_speed"),
        (lambda ds: lost(ds, "event_kind"), "event_kind"),
        (lambda ds: lost(ds, "event_force"), "event_force"),
        (lambda ds: lost(ds, "event_time"), "event_time"),
        (lambda ds: lost(ds, "passage_pair"), "passage_pair"),
        (lambda ds: ds.assign(event_force=ds.event_force.assign_attrs(units="nN")), "event_force"),
        (lambda ds: ds.assign_coords(time=ds.time.assign_attrs(units="ms")), "time"),
        (lambda ds: ds.assign_coords(time=(1e3 * ds.time).assign_attrs(units="ms")), "time"),
    ],
)
def test_what_a_run_has_lost_is_named(reference, change, name):
    with pytest.raises(AssertionError, match=rf"  {name}: "):
        assert_runs_close(change(reference), reference)


def test_what_may_be_missing_is_ignored(reference):
    assert_runs_close(lost(reference, "gear_speed"), reference, ignore=["gear_speed"])
    assert_runs_close(
        without_rows(reference, "passage"), reference, ignore=["passages"], per={"passages": float("inf")}
    )


@pytest.mark.parametrize("ignore", [["gear_sped"], ["event"], "gear_sped", [3]])
def test_what_is_ignored_is_something(reference, ignore):
    with pytest.raises(gd.SceneError, match=r"^ignore = .*is nothing that the reference has"):
        assert_runs_close(reference, reference, ignore=ignore)


def test_a_run_may_have_more_than_its_reference(reference):
    assert_runs_close(reference, lost(reference, "gear_speed"))
