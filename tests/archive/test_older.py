"""Archives of older versions, which have the energy balance of a run as JSON in an attribute."""

import json

import numpy as np
import pytest
import xarray as xr

import gearidae as gd
from gearidae.archive import save
from gearidae.archive.select import scene_of
from gearidae.archive.variables import ENERGY_BALANCE
from gearidae.records.energy import TERMS

LATER = [name for name, term in TERMS.items() if term.since]
LOW = gd.preset("teodorescu2009_low_speed").replace({"run.duration": "2 ms", "run.samples": 11})
ROLLER = gd.preset("roller_slow").replace({"run.samples": 11})


def of_version_0_1(ds):
    """A run as that version wrote it."""
    kept = {name: value for name, value in ds.gearidae.energy_balance.items() if name not in LATER}
    return ds.drop_vars(["reached", *ENERGY_BALANCE]).assign_attrs(energy_balance=json.dumps(kept))


@pytest.mark.parametrize("scene", [LOW, ROLLER, LOW.replace({"run.samples": "off"})])
def test_the_energy_balance_of_a_run_becomes_variables(scene, tmp_path):
    ds = gd.simulate(scene)
    save(of_version_0_1(ds), tmp_path / "old.nc")
    opened = gd.open_archive(tmp_path / "old.nc")
    assert "energy_balance" not in opened.attrs
    assert opened.gearidae.energy_balance == ds.gearidae.energy_balance
    for name in ("reached", *ENERGY_BALANCE):
        assert opened[name].identical(ds[name]), name


def test_a_run_without_a_balance_has_reached_its_last_sample(tmp_path):
    ds = gd.simulate(LOW.replace({"run.balance": False}))
    save(ds.drop_vars("reached"), tmp_path / "old.nc")
    opened = gd.open_archive(tmp_path / "old.nc")
    assert float(opened.reached) == float(ds.time[-1])
    assert opened.gearidae.energy_balance is None


def test_losses_that_a_sweep_did_not_know_are_zero(tmp_path):
    ds = gd.sweep(LOW, {"coating.sam_fraction": [1.0, 0.5]})
    save(ds.drop_vars(LATER), tmp_path / "old.nc")
    opened = gd.open_archive(tmp_path / "old.nc")
    for name in ENERGY_BALANCE:
        assert opened[name].identical(ds[name]), name


def test_a_sweep_that_kept_single_energies_has_these_only(tmp_path):
    ds = gd.sweep(LOW, {"coating.sam_fraction": [1.0, 0.5]}, keep=["drive_work"])
    save(ds, tmp_path / "kept.nc")
    opened = gd.open_archive(tmp_path / "kept.nc")
    assert set(opened.data_vars) & set(ENERGY_BALANCE) == {"drive_work"}


@pytest.mark.parametrize("text", ["[", "3", '{"drive_work": "much"}', '{"drive_work": 1.0}'])
def test_a_damaged_balance_is_refused(text, tmp_path):
    ds = of_version_0_1(gd.simulate(LOW)).assign_attrs(energy_balance=text)
    save(ds, tmp_path / "old.nc")
    with pytest.raises(gd.SceneError, match="is damaged"):
        gd.open_archive(tmp_path / "old.nc")


def test_energies_of_an_unfinished_run_are_those_of_its_checkpoint(tmp_path, monkeypatch):
    """So that its balance closes, as that of a run that has ended."""
    monkeypatch.setattr("gearidae.archive.unfinished.CHECKPOINT_SECONDS", 0.0)
    scene = LOW.replace({"run.duration": "20 ms", "run.checkpoints": ["5 ms", "10 ms"]})

    def interrupt(block):
        if block.time > 7e-3:
            raise KeyboardInterrupt

    with pytest.raises(gd.Interrupted):
        gd.simulate(scene, archive=tmp_path / "run.nc", on_block=interrupt)
    left = gd.open_archive(tmp_path / "run.nc").gearidae.energy_balance
    assert left["time"] == pytest.approx(10e-3, rel=1e-12)
    whole = gd.simulate(scene.replace({"run.duration": left["time"], "run.checkpoints": ["5 ms"]}))
    wanted = whole.gearidae.energy_balance
    assert left["drive_work"] == pytest.approx(wanted["drive_work"], rel=1e-5, abs=0.0)
    assert 0.0 < abs(left["residual"]) <= left["residual_bound"]
    np.testing.assert_allclose(left["throughput"], wanted["throughput"], rtol=1e-3)


def test_older_names_of_the_contact_are_read_without_a_word(caplog):
    """Scenes of archives up to 0.2.0 have `contact.model` and the friction law `net`."""
    scene = gd.preset("teodorescu2009").to_dict()
    del scene["contact"]["bodies"], scene["contact"]["roughness"]
    scene["contact"] |= {"model": "population", "friction_law": "net", "friction": 0.1}
    ds = xr.Dataset(attrs={"scene": json.dumps(scene)})
    contact = scene_of(ds)["contact"]
    assert (contact["bodies"], contact["roughness"], contact["friction_law"]) == (
        "rigid",
        "discrete",
        "coulomb",
    )
    assert "model" not in contact
    assert gd.Scene.from_dict(scene_of(ds)).contact.is_discrete
    assert not caplog.messages
