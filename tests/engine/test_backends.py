"""Both drivers over one residual: the same steps, the same events, the same samples."""

from functools import partial
from pathlib import Path

import numpy as np
import pytest

import gearidae as gd
from gearidae.engine import choose_backend, solve
from gearidae.engine import native as native_driver
from gearidae.engine.sundials import names as sundials
from gearidae.errors import SceneError
from gearidae.records import EventKind

CASES = Path(__file__).parents[2] / "cases"
SHORT = {
    "low_speed": 0.03,
    "high_speed": 1e-4,
    "roller_slow": None,
    "roller_fast": None,
    "start_up": 2e-3,
    "braking": 1.5e-4,
    "alternating": 2e-4,
}


@pytest.mark.parametrize("name", SHORT)
def test_every_case_runs_the_same_in_both(name, monkeypatch):
    """With IDA's own formulas, iteration and interpolant, as the portable driver has them."""
    choose_backend("native", "auto")  # with its self-test, which has to see the driver as it is
    monkeypatch.setattr(native_driver, "run", partial(native_driver.run, as_ida=True))
    scene = gd.load_case(CASES / f"{name}.toml")
    if name in ("low_speed", "high_speed"):
        scene = scene.replace({"coating.sam_fraction": 0.5})
    if scene.roller is not None:  # the elastic contact's linear systems are solved in another way in each
        scene = scene.replace({"contact.bodies": "rigid"})
    duration = SHORT[name] or scene.run.duration
    runs = [solve(scene, backend=b, t_end=duration, samples=501) for b in ("native", "sksundae")]
    native, portable = runs
    assert native.status == portable.status == "finished"
    # the same SUNDIALS with the same callbacks: the events agree to the last bit
    for field in ("time", "kind", "pair", "flank", "gap_rate"):
        np.testing.assert_array_equal(getattr(native.events, field), getattr(portable.events, field))
    assert native.statistics.residual_evaluations == portable.statistics.residual_evaluations
    assert native.statistics.jacobian_evaluations == portable.statistics.jacobian_evaluations
    assert native.statistics.restarts == portable.statistics.restarts
    for column, values in native.samples.items():
        if column == "pairs_in_contact":
            continue
        # between steps the portable driver interpolates for itself, within the tolerance of 1e-6 per step; forces are
        # steep in the gap
        steep = 1e3 if "force" in column or "torque" in column else 10
        np.testing.assert_allclose(
            portable.samples[column], values, atol=steep * scene.run.rtol * (np.ptp(values) + 1e-300)
        )


def test_auto_prefers_the_native_driver():
    assert choose_backend("auto", "auto") == "native"


def test_auto_falls_back_and_says_why(monkeypatch, caplog):
    monkeypatch.setattr("gearidae.engine.backend.unavailable", lambda: "SUNDIALS is of another kind")
    assert choose_backend("auto", "auto") == "sksundae"
    assert "SUNDIALS is of another kind" in caplog.text
    with pytest.raises(SceneError, match="another kind"):
        choose_backend("native", "auto")


def test_other_builds_of_sundials_are_refused(monkeypatch):
    from sksundae import _cy_common

    sundials.unavailable.cache_clear()
    monkeypatch.setitem(_cy_common.config, "SUNDIALS_INT_TYPE", "long int")
    try:
        assert "long int" in sundials.unavailable()
    finally:
        sundials.unavailable.cache_clear()


def test_unknown_backend():
    with pytest.raises(SceneError, match=r"backend = fortran"):
        solve(gd.preset("roller_slow"), backend="fortran")


@pytest.mark.parametrize("name", ["low_speed", "roller_fast", "start_up"])
def test_idas_own_formulas_come_to_the_same_motion(name, monkeypatch):
    """To their error over a run, some hundreds of tolerances.

    At rest the gap rate is nothing but rounding, and where it is zero is anybody's guess.
    """
    scene = gd.load_case(CASES / f"{name}.toml")
    if scene.roller is not None:
        scene = scene.replace({"contact.bodies": "rigid"})
    duration = SHORT[name] or scene.run.duration
    ordinary = solve(scene, backend="native", t_end=duration, samples=501)
    monkeypatch.setattr(native_driver, "run", partial(native_driver.run, as_ida=True))
    as_ida = solve(scene, backend="native", t_end=duration, samples=501)
    happened = [e.kind[e.kind != EventKind.TURNING_POINT] for e in (ordinary.events, as_ida.events)]
    np.testing.assert_array_equal(*happened)
    for column in ("gear_speed", "transmission_error", "height", "speed"):
        if column in ordinary.samples:
            values = as_ida.samples[column]
            error = np.abs(ordinary.samples[column] - values).max()
            assert error <= 1e3 * scene.run.rtol * np.ptp(values)
