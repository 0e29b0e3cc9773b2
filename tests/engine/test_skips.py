"""What a scene does not need is skipped, said in the statistics, and changes nothing."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest

import gearidae as gd
from gearidae.engine import solve
from gearidae.engine.setup import build_contact

LOW = gd.preset("teodorescu2009_low_speed").replace(
    {"run.duration": 0.02, "run.samples": 201, "run.rtol": 1e-8}
)
HIGH = gd.preset("teodorescu2009").replace(
    {"contact.bodies": "rigid", "run.duration": 4e-5, "run.samples": 201, "run.rtol": 1e-8}
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


COUNT = """
import json
import sys

import numpy as np

from gearidae.contact.kernels import branches, evaluate, law

laws = ("branch_value", "stretched_value")
counts = dict.fromkeys(laws, 0)


def eight_powers(table, start, u):  # exists in machine code only, as the next
    return tuple(np.asarray(table[int(start) : int(start) + 64]).reshape(8, 8).T @ u ** np.arange(8))


def numbers_of(record):
    return np.atleast_1d(record).view(np.float64)


def counted(name, function):
    def call(*arguments):
        counts[name] += 1
        return function(*arguments)

    return call


evaluate.eight_powers = branches.eight_powers = eight_powers
models = []


class Addresses:  # a model has no address here
    def __init__(self, m):
        models.append(m)
        self.base = len(models) - 1


for name in laws:
    setattr(law, name, counted(name, getattr(law, name)))

import gearidae as gd
from gearidae.engine import backend, compiling, solve
from gearidae.engine import portable

stand_ins = ("Addresses", Addresses), ("model_at", models.__getitem__), ("numbers_of", numbers_of)
for module in [m for name, m in sys.modules.items() if name.startswith("gearidae.engine")]:
    for name, stand_in in stand_ins:
        if hasattr(module, name):
            setattr(module, name, stand_in)

backend.compiles = lambda: True  # a run of what is not compiled is refused
compiling.make_ready = lambda part: None
scene = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 0.003, "run.samples": 11, "run.rtol": 1e-6})
for fraction in (1.0, 0.999):
    counts.update(dict.fromkeys(laws, 0))
    run = solve(scene.replace({"coating.sam_fraction": fraction}), backend="sksundae")
    print(json.dumps([run.status, sum(counts.values()), run.statistics.residual_evaluations]))
"""


def test_skips_save_work():
    """A whole coating has one material law where a worn one has two: evaluations counted, in Python and not timed."""
    done = subprocess.run(
        [sys.executable, "-c", COUNT],
        env={**os.environ, "NUMBA_DISABLE_JIT": "1"},
        capture_output=True,
        text=True,
        check=True,
    )
    (whole, laws, residuals), (worn, more_laws, more_residuals) = map(json.loads, done.stdout.splitlines())
    assert (whole, worn) == ("finished", "finished")
    assert residuals == pytest.approx(more_residuals, rel=0.2)
    assert 0 < laws / residuals < 0.6 * more_laws / more_residuals
