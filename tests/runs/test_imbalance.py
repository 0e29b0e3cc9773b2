"""A run whose energy balance does not close says so: in the log, in its outcome, by the command."""

import logging

import numpy as np
import pytest

import gearidae as gd
from gearidae.analysis.verdict import outcomes
from gearidae.cli import main
from gearidae.records import EnergyBalance

SCENE = gd.preset("teodorescu2009_low_speed").replace({"run.duration": "2 ms", "run.samples": 11})


@pytest.fixture
def strict(monkeypatch):
    """A bound that no run keeps."""
    monkeypatch.setattr(EnergyBalance, "bound", lambda self, rtol, *, roller: 0.5 * abs(self.residual))


def warned_of(caplog):
    return [record.getMessage() for record in caplog.records if "energy balance" in record.getMessage()]


def test_a_sound_run_says_nothing(caplog, capsys, tmp_path):
    gd.simulate(SCENE, archive=tmp_path / "run.nc")
    gd.sweep(SCENE, {"coating.sam_fraction": [1.0, 0.5]})
    assert warned_of(caplog) == []
    main(["info", str(tmp_path / "run.nc")])
    assert "do not rely" not in capsys.readouterr().out


@pytest.mark.usefixtures("strict")
def test_a_run_in_memory_and_one_in_an_archive(caplog, capsys, tmp_path):
    for archive in (None, tmp_path / "run.nc"):
        caplog.clear()
        ds = gd.simulate(SCENE, archive=archive)
        assert len(warned_of(caplog)) == 1
        assert "out by 2 times its bound: do not rely on it" in warned_of(caplog)[0]
        assert outcomes(ds)[0].words.endswith(", energy balance out by 2 times its bound")
        kept = ds.gearidae.energy_balance
        assert outcomes(ds)[0].imbalance == pytest.approx(abs(kept["residual"]) / kept["residual_bound"])
    main(["info", str(tmp_path / "run.nc")])
    shown = " ".join(capsys.readouterr().out.split())
    assert "2 times its bound of" in shown
    assert "do not rely on this run" in shown


@pytest.mark.usefixtures("strict")
@pytest.mark.parametrize("keep", [None, ["verdict", "energy_balance"]])
def test_the_members_of_a_sweep_get_one_warning(caplog, keep):
    kept = {} if keep is None else {"keep": keep}
    with caplog.at_level(logging.WARNING):
        ds = gd.sweep(SCENE, {"coating.sam_fraction": [1.0, 0.5]}, **kept)
    assert len(warned_of(caplog)) == 1
    assert "of 2 of 2 runs" in warned_of(caplog)[0]
    np.testing.assert_allclose([outcome.imbalance for outcome in outcomes(ds)], 2.0)


def test_a_verdict_kept_alone_knows_of_no_balance():
    ds = gd.sweep(SCENE, {"coating.sam_fraction": [1.0, 0.5]}, keep=["verdict"])
    assert all(np.isnan(outcome.imbalance) for outcome in outcomes(ds))
    assert "energy" not in outcomes(ds)[0].words
