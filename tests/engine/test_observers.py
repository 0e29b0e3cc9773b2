"""Observers of a run: called in order and if they are wanted, and a run is the same without its energy balance."""

from types import SimpleNamespace

import numpy as np
import pytest

import gearidae as gd
from balances import assert_closes
from gearidae.archive.totals import imbalance_of
from gearidae.engine import solve, step
from gearidae.engine.backend import run_blocks
from gearidae.engine.model.state import V, W
from gearidae.engine.observers import finish
from gearidae.engine.setup.build import make_problem
from gearidae.records import Statistics

GEARS = gd.preset("teodorescu2009").replace(
    {
        "coating.sam_fraction": 0.6,
        "contact.bodies": "rigid",
        "run.duration": "0.03 ms",
        "run.samples": 51,
    }
)
DRY = {
    "initial.gap": 2e-8,
    "initial.gear_speed": 0.0,
    "load.torque": 1e-12,
    "mesh.damping": 1e-6,
    "run.duration": 2e-5,
}
ROLLER = gd.preset("roller_fast")
WITHOUT = {"run.balance": False}


# -- which are called ------------------------------------------------------------------------------------------------


class Recorder:
    """An observer that notes when it is called."""

    def __init__(self, name, calls):
        self._name, self._calls = name, calls

    def __getattr__(self, hook):
        return lambda *_: self._calls.append(f"{self._name}.{hook}")


@pytest.fixture
def calls(monkeypatch):
    names = []
    for name in ("adhesion_loss", "extremes", "friction_losses", "balance", "exposures", "impacts"):
        monkeypatch.setattr(step, name, Recorder(name, names))
        if hasattr(finish, name):
            monkeypatch.setattr(finish, name, Recorder(name, names))
    return names


def follow(balance, exposures):
    """Call every hook, for a pair that has turned round at a mesh mark."""
    wanted = SimpleNamespace(
        balance=balance, friction=balance, extremes=1, exposures=exposures, impacts=exposures
    )
    m = SimpleNamespace(scene=SimpleNamespace(follow=wanted, kind=0, nodes=0))
    y, turned = np.zeros(max(V, W) + 1), SimpleNamespace(turns=True, flank=0, pair=0, k=0, gap=0.0)
    step.account.py_func(m, 1.0, y, y, (True, True), (y, y))
    step.account_event.py_func(m, 1.0, y, y, turned)
    step.resume_account.py_func(m, 1.0, y, True, True)
    finish.finish_account.py_func(m, 1.0, y, y)


def test_all_are_called_in_order(calls):
    follow(1, 1)
    hooks = {
        hook: [call.partition(".")[0] for call in calls if call.endswith(hook)] for hook in ("step", "finish")
    }
    assert hooks["step"] == ["adhesion_loss", "extremes", "balance", "exposures", "impacts"]
    assert (
        calls.index("friction_losses.accumulate_friction")
        < calls.index("extremes.step")
        < calls.index("balance.step")
    )
    assert hooks["finish"] == ["balance", "exposures"]
    assert calls.index("adhesion_loss.event") < calls.index("exposures.event")


@pytest.mark.parametrize(
    ("balance", "exposures", "gone"),
    [
        (0, 0, {"adhesion_loss", "friction_losses", "balance", "exposures", "impacts"}),
        (1, 0, {"exposures", "impacts"}),
    ],
)
def test_what_is_not_wanted_is_not_called(calls, balance, exposures, gone):
    follow(balance, exposures)
    called = {call.partition(".")[0] for call in calls}
    assert (
        called == {"adhesion_loss", "extremes", "friction_losses", "balance", "exposures", "impacts"} - gone
    )


# -- a run without its energy balance --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("scene", "backend"),
    [
        (GEARS, "native"),
        (GEARS.replace({"run.duration": "0.003 ms"}), "sksundae"),
        (GEARS.replace({"coating.pinion_table": np.linspace(0.2, 0.9, 57).reshape(19, 3)}), "native"),
        (GEARS.replace(DRY), "native"),
        (GEARS.replace({"contact.bodies": "elastic", "run.duration": "0.004 ms"}), "native"),
        (ROLLER, "native"),
    ],
    ids=["gears", "portable", "tables", "dry", "elastic", "roller"],
)
def test_the_motion_is_the_same_to_the_last_bit(scene, backend):
    run, other = solve(scene, backend=backend), solve(scene.replace(WITHOUT), backend=backend)
    for name, values in run.samples.items():
        np.testing.assert_array_equal(other.samples[name], values)
    np.testing.assert_array_equal(other.events.time, run.events.time)
    assert other.extremes == run.extremes
    assert other.statistics.steps == run.statistics.steps
    assert run.balance is not None
    assert other.balance is None


@pytest.mark.filterwarnings("ignore:sampling at")
def test_datasets_go_without(tmp_path):
    """Attributes of a run, variables of a sweep, the outcome, and what the report says."""
    scene = GEARS.replace(WITHOUT)
    ds = gd.simulate(scene, archive=tmp_path / "run.nc")
    assert ds.gearidae.energy_balance is None
    assert np.isnan(imbalance_of(ds))
    with_observers, other = (dataset.gearidae.account.as_plain() for dataset in (ds, gd.simulate(GEARS)))
    energies = {name for name, value in with_observers.items() if value != other[name]}
    assert "residual" in energies
    assert all(with_observers[name] is None for name in energies)
    gd.write_report(ds, tmp_path / "report.html")
    assert ">adhesion loss<" not in (tmp_path / "report.html").read_text()
    gd.write_report(gd.simulate(GEARS), tmp_path / "whole.html")
    assert ">adhesion loss<" in (tmp_path / "whole.html").read_text()
    low = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 0.02, "run.samples": 501})
    (outcome,) = gd.outcomes(gd.simulate(low.replace(WITHOUT)))
    (expected,) = gd.outcomes(gd.simulate(low))
    assert outcome.words == expected.words
    assert np.isnan(outcome.imbalance)
    assert expected.imbalance < 1.0
    ds = gd.sweep(scene, {"run.balance": [True, False]})
    np.testing.assert_array_equal(np.isnan(ds["residual"].values), [False, True])


def test_exposures_are_refused_without_a_balance():
    with pytest.raises(
        gd.SceneError, match=r"run.balance = False: must be true where run.exposures are kept"
    ):
        GEARS.replace({"run.exposures": 4, **WITHOUT})


# -- going on --------------------------------------------------------------------------------------------------------


def test_a_checkpoint_without_a_balance_is_taken_back():
    """And the run goes on from it to the last bit."""
    scene = GEARS.replace({**WITHOUT, "run.checkpoints": ["0.01 ms"]})
    rtol, count = scene.run.rtol, scene.run.sample_count
    blocks = list(run_blocks(make_problem(scene), rtol, count, "native", Statistics()))
    at = next(k for k, block in enumerate(blocks) if block.checkpoint is not None)
    assert at < len(blocks) - 1
    others = list(run_blocks(make_problem(scene), rtol, count, "native", Statistics(), blocks[at].checkpoint))
    for name in ("rows", "events"):
        first, then = (
            np.concatenate([getattr(b, name) for b in part]) for part in (blocks[at + 1 :], others)
        )
        np.testing.assert_array_equal(first, then)
    np.testing.assert_array_equal(blocks[-1].checkpoint, others[-1].checkpoint)


@pytest.mark.parametrize("force", [False, True])
def test_a_balance_that_begins_in_the_middle_closes(force):
    """The first run keeps none; it ends while contacts are stretched and joining."""
    scene = GEARS.replace({"mesh.radius_force": force, "run.rtol": 1e-8})
    first = gd.simulate(scene.replace(WITHOUT))
    for changes in ({}, {"coating.sam_fraction": 0.5}):
        then = gd.simulate(scene.replace(changes), start=first)
        kept = then.gearidae.energy_balance
        assert kept["throughput"] > 0.0
        assert abs(kept["residual"]) <= kept["residual_bound"]


def test_a_balance_that_ends_in_the_middle_leaves_none():
    first = gd.simulate(GEARS)
    then = gd.simulate(GEARS.replace(WITHOUT), start=first)
    both = gd.simulate(GEARS, start=first)
    assert then.gearidae.energy_balance is None
    np.testing.assert_array_equal(then["gear_speed"], both["gear_speed"])


@pytest.mark.parametrize("rtol", [1e-5, 1e-8])
def test_the_balance_closes_where_shares_change_along_the_path(rtol):
    """Their lag is followed at every step, like that of uniform shares."""
    scene = GEARS.replace({"coating.pinion_table": np.tile([0.1, 0.9, 0.2, 0.8], (19, 1)), "run.rtol": rtol})
    assert_closes(scene, solve(scene))
