"""The summary of a run against what is known of it on paper."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

import gearidae as gd
from gearidae import engine
from gearidae.archive import run_summary as account_module
from gearidae.archive.end_state import end_state_of
from gearidae.archive.run_summary import summary_of
from gearidae.archive.summary_rows import summary_rows
from gearidae.archive.totals import extremes_of
from gearidae.archive.variables import ENERGY_BALANCE
from gearidae.cli import main
from gearidae.records.standing import Holding
from gearidae.scene.prefixes import with_prefix
from reference.sampled_work import SampledWork

CASES = Path(__file__).parents[2] / "cases"
LOW = gd.preset("teodorescu2009_low_speed")
FREE = LOW.replace(
    {  # one flank far from the other, both shafts held back so that nothing touches: two bodies on their own
        "drive.torque": 0.0,
        "load.drag": 0.0,
        "initial.gear_speed": 0.0,
        "initial.gap": "0.1 um",
        "run.duration": "1 ms",
        "run.samples": 1001,
    }
)


@pytest.fixture(scope="module")
def braking():
    scene = gd.load_case(CASES / "braking.toml").replace(
        {
            "drive.schedule": [[0.0, 2.43e-11], [2e-3, 0.0]],
            "run.duration": "14 ms",
            "run.samples": 14_001,
            "run.rtol": 1e-7,
        }
    )
    return gd.simulate(scene)


def test_dry_resistance_stops_the_gear_and_the_books_balance(braking):
    summary = summary_of(braking)
    assert summary.held_by == "dry resistance"
    assert summary.sticks == summary.slips + 1
    stuck = braking.event_time[braking.event_kind == 6][-1].item()
    assert summary.time_at_rest == pytest.approx(14e-3 - stuck, rel=1e-9, abs=0.0)  # a sum of steps
    gears = gd.Scene.from_dict(json.loads(braking.attrs["scene"])).gears
    kinetic = 0.5 * (gears.gear_inertia + gears.pinion_inertia * 16.0) * 2898.0**2  # teeth 76 to 19
    # the pinion still trembles against the tooth that holds it
    trembling = 0.5 * gears.pinion_inertia * braking.pinion_speed[-1].item() ** 2
    assert trembling < 1e-9 * kinetic
    assert summary.kinetic_change == pytest.approx(trembling - kinetic, rel=1e-12, abs=0.0)
    # dry resistance of 3e-11 N m over the angle turned
    turned = (braking.gear_angle[-1] - braking.gear_angle[0]).item()
    assert summary.dry_loss == pytest.approx(3e-11 * turned, rel=1e-12, abs=0.0)
    # what is lost in the contacts is small, and more than the error of the sum: adhesion only takes
    assert 0.0 < summary.contact_loss < 1e-3 * summary.dry_loss
    assert summary.residual < 0.5 * summary.contact_loss


def test_work_of_a_schedule_on_a_free_pinion():
    """A torque that grows as t: the pinion gains W = M1^2 T^2 / 8 I1, trapezoids over a thousandth of T."""
    torque, duration = 1e-14, 1e-4
    scene = FREE.replace(
        {"drive.schedule": [[0.0, 0.0], [duration, torque]], "run.duration": duration, "run.rtol": 1e-9}
    )
    ds = gd.simulate(scene)
    summary = summary_of(ds)
    work = (torque * duration) ** 2 / (8.0 * scene.gears.pinion_inertia)
    assert summary.impacts == 0
    assert summary.drive_work == pytest.approx(work, rel=1e-5, abs=0.0)
    assert summary.kinetic_change == pytest.approx(work, rel=1e-5, abs=0.0)
    assert abs(summary.contact_loss) < 1e-5 * work
    assert summary.residual < 1e-5 * work


def test_held_at_rest_from_the_beginning_to_the_end():
    ds = gd.simulate(FREE.replace({"load.torque": 1e-15}))
    summary = summary_of(ds)
    assert summary.time_at_rest == pytest.approx(1e-3, rel=1e-12)
    assert summary.held_by == "dry resistance"
    assert (summary.top_speed, summary.sticks) == (0.0, 0)
    assert math.isnan(summary.time_to_speed)


def test_start_up_rests_until_the_first_slip_and_then_comes_to_speed():
    scene = gd.load_case(CASES / "start_up.toml").replace({"run.duration": "12 ms", "run.samples": 12_001})
    ds = gd.simulate(scene)
    summary = summary_of(ds)
    assert summary.time_at_rest == pytest.approx(ds.event_time[ds.event_kind == 7][0].item(), rel=1e-9)
    assert (
        0.0031 - 2e-4 < summary.time_at_rest < summary.time_to_speed < 0.012
    )  # torque over ratio: 31 % of 10 ms
    first = np.flatnonzero(ds.gear_speed >= 0.95 * ds.gear_speed.max())[0]
    assert summary.time_to_speed == ds.time[first]


def test_adhesion_holds_a_worn_gear_and_lets_a_coated_one_go():
    worn = summary_of(gd.simulate(LOW.replace({"coating.sam_fraction": 0.4})))
    assert worn.held_by == "adhesion"
    assert worn.time_at_rest == 0.0
    assert 0.1 < worn.time_adhering < 0.3
    rocking = gd.simulate(LOW.replace({"coating.sam_fraction": 0.4, "run.samples": 300_001}))
    speed, place = rocking.gear_speed.values, rocking.gear_angle.values * 76 / (2.0 * math.pi)
    back = np.flatnonzero((speed[:-1] > 0.0) & (speed[1:] < 0.0))  # turned back, a microsecond apart
    assert (np.abs(np.diff(place[back])) < 0.5).all()
    assert worn.time_adhering == pytest.approx(0.3 - rocking.time[back[0]].item(), abs=1e-6)
    coated = summary_of(gd.simulate(LOW))
    assert (coated.held_by, coated.time_adhering) == ("", 0.0)


def test_pieces_do_not_matter(braking, monkeypatch):
    whole = summary_of(braking)
    monkeypatch.setattr(account_module, "PIECE", 1000)
    pieces = summary_of(braking)
    for name, value in whole.as_plain().items():
        expected = value if isinstance(value, str) else pytest.approx(value, rel=1e-9, abs=1e-24)
        assert pieces.as_plain()[name] == expected


def test_without_samples_and_of_rollers():
    worn = LOW.replace({"coating.sam_fraction": 0.4})
    summary, sampled = (summary_of(gd.simulate(worn.replace({"run.samples": n}))) for n in ("off", 301))
    assert math.isnan(summary.time_to_speed)  # that of a sample
    for name, value in sampled.as_plain().items():  # all else is kept by the solver
        if name != "time_to_speed":
            assert summary.as_plain()[name] == value, name
    assert summary.drive_work > 0.0
    assert summary.impacts > 0
    assert summary_of(gd.simulate(gd.preset("roller_slow"))) is None


def test_the_energies_are_those_summed_over_the_samples(braking):
    """The sums over samples and the engine's energy balance are two ways to the same energies.

    Samples every 20 ns: what contacts lose is a hundredth of the other energies, and an impact takes a microsecond.
    """
    dense = gd.simulate(braking.gearidae.scene.replace({"run.samples": 700_001}))
    summary = summary_of(dense)
    assert summary.contact_loss == summary_of(braking).contact_loss  # whatever is sampled
    summed, coarse = (
        SampledWork(dense.gearidae.scene, dense.isel(time=slice(None, None, n))) for n in (1, 2)
    )
    for name in ("drive_work", "drag_loss", "dry_loss", "kinetic_change"):
        assert getattr(summary, name) == pytest.approx(getattr(summed, name), rel=1e-5, abs=0.0)
    error = abs(summed.contact_loss - coarse.contact_loss)
    assert error < 0.02 * summary.contact_loss
    assert summary.contact_loss == pytest.approx(summed.contact_loss, rel=0.0, abs=2.0 * error)
    assert summary.residual < error


def test_of_a_run_without_an_energy_balance_no_energies_are_told(braking):
    partial = braking.drop_vars("residual")
    summary, whole = summary_of(partial).as_plain(), summary_of(braking).as_plain()
    energies = {name for name, value in summary.items() if value is None}
    assert energies == {*ENERGY_BALANCE, "contact_loss", "friction_loss", "efficiency"}
    assert {name: value for name, value in summary.items() if name not in energies} == {
        name: value for name, value in whole.items() if name not in energies
    }


def test_the_accessor_and_info_have_the_summary(tmp_path, capsys):
    ds = gd.simulate(LOW, archive=tmp_path / "run.nc")
    wanted = summary_of(gd.simulate(LOW)).as_plain()
    assert ds.gearidae.account.as_plain() == wanted
    assert main(["info", str(tmp_path / "run.nc"), "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    assert facts["run_summary"] == wanted
    assert facts["energy_balance"] == ds.gearidae.energy_balance
    swept = gd.sweep(LOW, {"coating.sam_fraction": [1.0, 0.5]})
    assert swept.gearidae.account is None
    assert (
        swept.sel(sam_fraction=1.0).gearidae.account.as_plain() == wanted
    )  # events of other runs are left out


def test_the_extremes_of_an_unfinished_run_are_those_of_its_newest_checkpoint(tmp_path, monkeypatch):
    """They are what the engine finds in the state that the archive carries, and the verdict rests on them."""
    monkeypatch.setattr("gearidae.archive.unfinished.CHECKPOINT_SECONDS", 0.0)
    kept = {"run.samples": "off", "run.checkpoints": ["0.1 s", "0.2 s"]}
    scene = LOW.replace({"coating.sam_fraction": 0.4} | kept)
    checkpoints = []

    def stop(block):
        checkpoints.append(block.checkpoint is not None)
        if sum(checkpoints) == 2:
            raise KeyboardInterrupt

    with pytest.raises(gd.Interrupted) as cut:
        gd.simulate(scene, archive=tmp_path / "run.nc", on_block=stop)
    ds = cut.value.dataset
    extremes = extremes_of(ds)
    expected = engine.kept_at(scene, end_state_of(ds.attrs)[0])[1]
    numbers = {
        name: value for name, value in expected.items() if name not in ("exposures", "standstill_list")
    }
    assert {name: getattr(extremes, name) for name in numbers} == pytest.approx(
        numbers, rel=1e-12, abs=0, nan_ok=True
    )
    summary = summary_of(ds)
    assert (summary.top_speed, summary.time_adhering) == (extremes.max_gear_speed, extremes.time_adhering)
    (outcome,) = gd.outcomes(ds)
    assert outcome.max_speed == extremes.max_gear_speed
    assert outcome.verdict == "sticks"
    assert outcome.stick_time == extremes.stick_time


def test_what_friction_takes_and_holds():
    """A loaded train that rings down to rest; its drive is held by the load and by the teeth."""
    scene = gd.preset("teodorescu2009").replace(
        {
            "contact.bodies": "rigid",
            "contact.friction": 0.5,
            "load.torque": 1e-12,
            "drive.torque": 2.6e-13,
            "drive.harmonic": None,
            "initial.gear_speed": 2.0,
            "initial.gap": 2.3e-8,
            "mesh.damping": 2e-5,
            "run.duration": 40e-6,
            "run.samples": 401,
        }
    )
    ds = gd.simulate(scene)
    summary, kept = summary_of(ds), ds.gearidae.energy_balance
    assert summary.held_by == "dry resistance and flank friction"
    speed = ds.gear_speed.values
    still = (speed == 0.0).mean() * 40e-6
    assert summary.time_at_rest == pytest.approx(still, abs=2e-7)
    earlier = summary_of(
        ds.drop_vars(["rest_time", "holding", "followed_time"])
    )  # from events, as of version 0.2
    assert earlier.time_at_rest == pytest.approx(still, abs=2e-7)
    rows = {name: (value, remark) for name, value, remark in summary_rows(ds)}
    assert rows["efficiency"][0] == f"{100.0 * summary.efficiency:.4g} %"
    assert "held by dry resistance and flank friction at the end" in rows["time at rest"][1]
    assert rows["drive friction loss"][0] == with_prefix(summary.friction_loss, "J", 5)
    assert 0.0 < summary.friction_loss == kept["drive_friction_loss"] + kept["coast_friction_loss"]
    lost = (
        summary.drag_loss
        + summary.dry_loss
        + summary.damping_loss
        + summary.adhesion_loss
        + summary.friction_loss
    )
    assert summary.efficiency == pytest.approx((summary.drag_loss + summary.dry_loss) / lost, rel=1e-12)
    supplied = summary.drive_work - summary.kinetic_change
    assert lost + summary.contact_loss - summary.adhesion_loss == pytest.approx(supplied, rel=1e-4, abs=0.0)
    waiting = {"initial.gear_speed": 0.0, "drive.torque": 1e-14, "initial.gap": 1e-7, "run.duration": 1e-7}
    held = summary_of(gd.simulate(scene.replace(waiting)))
    assert held.held_by == "dry resistance"  # the pinion moves
    assert held.time_at_rest == pytest.approx(1e-7, rel=1e-12)


def test_what_holds_the_gear_is_said_alike_wherever_it_is_said(braking):
    """Summary, words, table and variable; an archive of version 0.2 has its events alone."""
    (outcome,) = gd.outcomes(braking)
    words = Holding(int(braking.holding)).words
    assert summary_of(braking).held_by == outcome.holding.words == words == "dry resistance"
    assert braking.gearidae.standstills()["held_by"].iloc[-1] == words
    earlier = summary_of(braking.drop_vars(["rest_time", "holding", "followed_time"]))
    assert earlier.held_by == words
    assert earlier.time_at_rest == pytest.approx(summary_of(braking).time_at_rest, rel=1e-9)


def test_the_balance_shows_no_rounding(braking):
    """Entries below the last digit of the sum, and zeros with a sign."""
    ds = braking.assign(model_change=4.394e-57, stored_change=-0.0, residual=-0.0)
    rows = {name: value for name, value, _ in summary_rows(ds)}
    assert "model change" not in rows
    assert "stored change" not in rows
    assert rows["residual"] == "0 J"
    assert str(ds.gearidae.energy_balance["stored_change"]) == "0.0"
    assert "e-" not in "".join(rows.values())
