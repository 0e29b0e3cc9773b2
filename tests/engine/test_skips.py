"""What a scene does not need is skipped, said in the statistics, and changes nothing."""

import numpy as np
import pytest

import gearidae as gd
from gearidae.engine import solve
from gearidae.engine.model import build_contact

LOW = gd.preset("teodorescu2009_low_speed").replace(
    {"run.duration": 0.02, "run.samples": 201, "run.rtol": 1e-8}
)
HIGH = gd.preset("teodorescu2009").replace(
    {"contact.model": "asperity", "run.duration": 4e-5, "run.samples": 201, "run.rtol": 1e-8}
)


def assert_same_motion(run, other, times_rtol=1e3):
    """Within some hundred times the tolerance per step: what two runs with other steps differ by."""
    for name in ("gear_speed", "transmission_error"):
        swing = np.ptp(run.samples[name])
        np.testing.assert_allclose(other.samples[name], run.samples[name], atol=times_rtol * 1e-8 * swing)


@pytest.mark.parametrize(("fraction", "kept"), [(1.0, "coated"), (0.0, "bare")])
def test_a_material_that_is_not_there(fraction, kept):
    scene = LOW.replace({"coating.sam_fraction": fraction, "run.duration": 0.02 if fraction else 0.003})
    run = solve(scene)
    gone = "bare" if kept == "coated" else "coated"
    assert run.statistics.skipped[f"{gone}_surface"] == 1
    assert run.statistics.skipped[f"{gone}_hysteresis"] == 1
    assert run.statistics.skipped[f"{kept}_surface"] == 0
    almost = solve(scene.replace({"coating.sam_fraction": abs(fraction - 1e-13)}))
    assert almost.statistics.skipped[f"{gone}_surface"] == 0
    assert_same_motion(run, almost)


def test_negligible_hysteresis(monkeypatch):
    """A monolayer of hardly any energy stretches by 2e-5 roughnesses: following that changes nothing."""
    scene = LOW.replace({"coating.energy": 1e-6})
    run = solve(scene)
    assert run.statistics.skipped["coated_hysteresis"] == 1
    from gearidae.contact.kernels import law

    monkeypatch.setattr(law, "NEGLIGIBLE_STRETCH", 0.0)
    law.law_table.cache_clear()
    followed = solve(scene)
    law.law_table.cache_clear()
    assert followed.statistics.skipped["coated_hysteresis"] == 0
    assert_same_motion(run, followed)


@pytest.mark.parametrize(
    ("skip", "change"),
    [
        ("static_error", {"mesh.static_error": [{"order": 1, "amplitude": 1e-20, "phase": 0.0}]}),
        ("harmonics", {"drive.harmonic": [{"amplitude": 1e-30, "frequency": 1e4, "phase": 0.0}]}),
        ("dry_resistance", {"load.torque": 1e-30}),
    ],
)
def test_terms_that_are_absent(skip, change):
    run, other = solve(LOW), solve(LOW.replace(change))
    assert run.statistics.skipped[skip] == 1
    assert other.statistics.skipped[skip] == 0
    assert_same_motion(run, other)


def test_flight_and_pairs_out_of_reach(monkeypatch):
    """Forces below 1e-13 of the load are not worked out; a cut-off at 1e-15 changes nothing."""
    # strong enough to make the teeth rattle
    scene = HIGH.replace({"drive.harmonic.amplitude": 6e-11, "run.duration": 1.2e-4, "run.rtol": 1e-10})
    run = solve(scene)
    assert 0 < run.statistics.skipped["flight_steps"] < run.statistics.steps
    monkeypatch.setattr(build_contact, "FORCE_FLOOR", 1e-15)
    wider = solve(scene)
    assert_same_motion(run, wider)


def test_contact_that_never_ends_is_no_flight():
    assert solve(LOW).statistics.skipped["flight_steps"] < 100  # before the first contact


def test_skips_save_work():
    """Fewer material laws, fewer residuals' worth of work: counted, not timed."""
    coated, mixed = solve(LOW), solve(LOW.replace({"coating.sam_fraction": 0.999}))
    assert sum(coated.statistics.skipped.values()) > sum(mixed.statistics.skipped.values())
