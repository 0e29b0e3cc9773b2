"""Pictures, spectra and tables of a train: drawn of the judged shaft, or refused in the package's own words."""

from __future__ import annotations

import math

import numpy as np
import pytest
import xarray as xr
from tests.reference.trains import chain

import gearidae as gd
from gearidae.errors import GearidaeError
from gearidae.records import EventKind, Flank
from gearidae.scene import Scene

DRAWN = {
    *("cycle", "gap", "gear_speed", "orders", "overview", "power_spectrum", "spectrogram"),
    *("impact_spectrum", "train", "transmission_error", "work"),
}
NOT_OF_TRAINS = {"contact_torque", "impact_forces", "teeth", "tooth_errors"}
NO_PICTURES = {"style", "write"}


@pytest.fixture(scope="module")
def run():
    return gd.simulate(Scene.from_dict(chain()).replace({"run.duration": "150 us", "run.samples": 4001}))


@pytest.mark.filterwarnings("ignore:sampling at")
@pytest.mark.parametrize(
    "name", sorted({*gd.plot.__all__} - NO_PICTURES - {"animate_teeth", "animate_train"})
)
def test_every_picture_draws_a_train_or_says_why_not(run, name):
    if name in DRAWN:
        assert getattr(gd.plot, name)(run) is not None
        return
    with pytest.raises(GearidaeError) as caught:
        getattr(gd.plot, name)(run)
    assert "\n" not in str(caught.value)
    assert ("of a train (2 meshes)" in str(caught.value)) == (name in NOT_OF_TRAINS)


@pytest.mark.parametrize(
    "asked",
    [
        lambda run, path: gd.plot.animate_teeth(run, path / "teeth.gif"),
        lambda run, path: gd.analysis.tooth_contacts(run, [1e-5]),
        lambda run, _: run.gearidae.impacts(),
        lambda run, _: run.gearidae.passages(),
    ],
)
def test_what_needs_single_pairs_of_teeth_is_refused(run, asked, tmp_path):
    with pytest.raises(gd.SceneError, match=r"of a train \(2 meshes\): must be of a pair of gears here"):
        asked(run, tmp_path)
    assert not [*tmp_path.iterdir()]


def test_impacts_of_a_train_are_the_exits_of_the_judged_mesh(run):
    """With the teeth of the gear that is driven there, 76."""
    here = run["event_kind"] == EventKind.MESH_EXIT
    own = here & (run["event_mesh"] == 1) & (run["event_flank"] == Flank.DRIVE)
    found = gd.analysis.impact_windows(run, width=0.02)["impact_time"].values
    assert int(here.sum()) > int(own.sum()) > 1
    np.testing.assert_allclose(found, run["event_time"].values[own.values], rtol=0.0, atol=1e-12)


def test_a_picture_names_shafts_and_the_order_of_the_driver(run):
    """76 teeth meet 38: the idler turns twice for each turn of the output."""
    words = {text.get_text(): text.xy[0] for text in gd.plot.orders(run).texts}
    assert words["mesh"] == 76.0
    assert words["idler"] == 2.0


@pytest.mark.parametrize(
    ("name", "label"),
    [("cycle", "time within the last pitch of output"), ("orders", "order (per turn of output)")],
)
def test_an_axis_names_the_judged_shaft(run, name, label):
    assert getattr(gd.plot, name)(run).get_xlabel().startswith(label)


def test_an_aliased_record_names_the_highest_mode_of_the_train(run):
    """6.05e6 rad/s under steady forces; here under the mean force of the record."""
    with pytest.warns(UserWarning, match="below twice the frequency of the loaded contact") as caught:
        gd.analysis.power_spectrum(run.isel(time=slice(None, None, 100)))
    said = float(str(caught[0].message).split("contact, ")[1].split(" Hz")[0])
    assert 0.5 * 6.053399e6 < 2.0 * math.pi * said < 2.0 * 6.053399e6


def test_a_train_is_resampled_and_balanced(run):
    turned = gd.analysis.resample(run)
    assert {"gear_speed", "pinion_speed", "time"} <= {*turned.data_vars}
    balance = run.gearidae.energy_balance
    assert balance is not None
    assert abs(balance["residual"]) < balance["residual_bound"]
    assert run.gearidae.account is None
    xr.testing.assert_identical(run.gearidae.run(), run)
    offered = repr(run.gearidae)
    assert "work()" in offered
    assert "account" not in offered
