"""The dataset of a train: its dimensions, names, units, files, and the pair that it is judged by."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from tests.reference.train_solution import solved
from tests.reference.trains import chain

import gearidae as gd
from gearidae.analysis.verdict.train import judge_chain
from gearidae.archive.totals import balance_of, imbalance_of
from gearidae.archive.train import judged_view, train_dataset
from gearidae.archive.train.variables import ALL, OF_AGEING, OF_ASPERITIES
from gearidae.scene import Scene

SCENE = Scene.from_dict(chain(hubs=0.3))


def labelled(scene=SCENE):
    solution = solved(scene)
    return train_dataset(scene, judge_chain(scene, solution, None)[0])


@pytest.fixture(scope="module")
def ds():
    return labelled()


def test_what_lies_along_shafts_and_meshes(ds):
    assert ds["shaft"].values.tolist() == ["input", "idler", "output"]
    assert ds["shaft_sense"].values.tolist() == [1, -1, 1]
    assert ds["shaft_ratio"].values.tolist() == [4.0, 2.0, 1.0]
    assert ds["mesh_driver"].values.tolist() == ["input", "idler"]
    assert ds["mesh_driven"].values.tolist() == ["idler", "output"]
    assert ds["mesh_ratio"].values.tolist() == [2.0, 2.0]
    assert ds["shaft_speed"].dims == ("shaft", "time")
    assert ds["mesh_force"].dims == ("mesh", "time")
    optional = {*OF_AGEING, *OF_ASPERITIES}  # of joints that age, and of single asperities
    assert not optional & {*ds.variables}
    for name, variable in ((name, ALL[name]) for name in ALL if name not in optional):
        assert ds[name].dims == variable.dims, name
        assert ds[name].attrs["units"] == variable.units, name
        assert ds[name].attrs["long_name"], name


def test_speeds_by_the_names_of_a_pair(ds):
    """Of the independent prototype at 150 us, in the chain with hubs."""
    assert float(ds["pinion_speed"][-1]) == pytest.approx(4530.490142, rel=3e-5)
    assert float(ds["gear_speed"][-1]) == pytest.approx(1128.926403, rel=3e-5)
    np.testing.assert_array_equal(ds["gear_speed"], ds["shaft_speed"].sel(shaft="output"))
    np.testing.assert_array_equal(ds["pinion_hub_load"], ds["hub_load"].sel(shaft="input"))


def test_another_shaft_may_be_judged():
    scene = SCENE.replace({"run.judged": "idler"})
    ds = labelled(scene)
    assert (ds.attrs["judged_shaft"], ds.attrs["judged_mesh"]) == ("idler", "first")
    assert ds["shaft_ratio"].values.tolist() == [2.0, 1.0, 0.5]
    np.testing.assert_array_equal(ds["gear_speed"], ds["shaft_speed"].sel(shaft="idler"))
    with pytest.raises(gd.SceneError, match=r"run.judged = idlr: .*idler"):
        SCENE.replace({"run.judged": "idlr"})
    with pytest.raises(gd.SceneError, match=r"run.judged = gear: is of a train"):
        gd.preset("teodorescu2009").replace({"run.judged": "gear"})


def test_where_the_work_of_the_drive_goes(ds):
    """Energies of the prototype; integrals over samples are good to some 1e-4 of what the drive has done."""
    work = ds.gearidae.work()
    expected = {
        "mesh first": 6.52914e-15,
        "mesh second": 3.21368e-15,
        "hub of input": 1.88843066e-13,
        "hub of idler": 1.92256651e-13,
        "hub of output": 9.02875074e-14,
        "load": 4.690351846e-12 + 1.370138714e-12,
        "kinetic energy": 9.737795861e-13,
    }
    for name, energy in expected.items():
        assert work["energy"][name] == pytest.approx(energy, abs=1e-4 * 7.515919998e-12, rel=0.0), name
    assert work["share"].sum() == pytest.approx(1.0, rel=1e-12)
    assert abs(work["share"]["not accounted for"]) < 2e-4
    with pytest.raises(gd.SceneError, match="must be a single run of a train"):
        xr.Dataset(attrs=ds.attrs).gearidae.work()


def test_efficiencies_of_meshes_and_hubs(ds):
    assert ds["mesh_efficiency"].values == pytest.approx(
        [7.289698684 / 7.296415776, 6.971615197 / 6.975160733], abs=2e-4
    )
    expected = 1.0 - np.array(
        [0.188843066 / 7.515919998, 0.192256651 / 7.296415776, 0.0902875074 / 6.975160733]
    )
    assert ds["hub_efficiency"].values == pytest.approx(expected, abs=2e-4)
    lost = 4.690351846 + 1.370138714 + 0.188843066 + 0.192256651 + 0.0902875074 + 0.00652914 + 0.00321368
    assert float(ds["efficiency"]) == pytest.approx((4.690351846 + 1.370138714) / lost, abs=2e-4)


def test_a_table_names_its_shafts_and_meshes(ds):
    table = ds.gearidae.to_dataframe()
    np.testing.assert_array_equal(table["shaft_speed[idler]"], ds["shaft_speed"].sel(shaft="idler"))
    np.testing.assert_array_equal(table["mesh_force[second]"], ds["mesh_force"].sel(mesh="second"))
    assert table.index.name == "time"
    events = ds.gearidae.events()
    assert events["mesh"].tolist() == ["first", "second"]
    assert events["shaft"].isna().all()


def test_the_view_of_its_judged_pair_has_the_names_of_a_pair(ds):
    view = judged_view(ds)
    assert view["mesh_force"].dims == ("time",)
    np.testing.assert_array_equal(view["mesh_force"], ds["mesh_force"].sel(mesh="second"))
    assert view["event_time"].values == pytest.approx([57.871869e-6])  # of its own mesh
    balance = balance_of(view)
    assert balance is not None
    assert balance["damping_loss"] == pytest.approx(float(ds["damping_loss"].sum()), rel=1e-12, abs=0.0)
    assert balance["gear_hub_loss"] == pytest.approx(float(ds["hub_loss"].sum()), rel=1e-12, abs=0.0)
    losses = sum(balance[name] for name in balance if name.endswith("_loss"))
    left = balance["drive_work"] - losses - balance["kinetic_change"] - balance["stored_change"]
    assert left == pytest.approx(balance["residual"], abs=1e-9 * balance["drive_work"], rel=0.0)
    assert imbalance_of(view) < 1.0


def test_a_file_gives_it_back(ds, tmp_path):
    path = gd.save(ds, tmp_path / "train.nc")
    opened = gd.open_archive(path)
    xr.testing.assert_identical(opened, ds)
    assert gd.open(path).gearidae.kind == "runs"
    assert opened.gearidae.scene == SCENE


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda ds: ds.drop_vars("hub_load"), "it lacks hub_load"),
        (lambda ds: ds.drop_vars("mesh_driven"), "it lacks mesh_driven"),
        (
            lambda ds: ds.assign(work_in=ds["work_in"].assign_attrs(units="mJ")),
            "work_in is in mJ, and must be in J",
        ),
    ],
)
def test_a_file_that_has_lost_something_is_named(ds, tmp_path, change, words):
    path = gd.save(change(ds), tmp_path / "train.nc")
    with pytest.raises(gd.SceneError, match=words):
        gd.open_archive(path)


def test_a_pair_along_shafts_and_meshes():
    pair = gd.preset("teodorescu2009").replace({"run.duration": "20 us", "run.samples": 11})
    run = gd.simulate(pair)
    train = run.gearidae.train()
    assert train["shaft"].values.tolist() == ["pinion", "gear"]
    assert train["mesh"].values.tolist() == ["mesh"]
    np.testing.assert_array_equal(train["shaft_speed"].sel(shaft="pinion"), run["pinion_speed"])
    np.testing.assert_array_equal(train["mesh_force"].sel(mesh="mesh"), run["mesh_force"])
    assert float(train["largest_mesh_force"].sel(mesh="mesh")) == float(run["largest_mesh_force"])
    assert train["shaft_ratio"].values == pytest.approx([76 / 19, 1.0])
    assert train["shaft_speed"].attrs["units"] == "rad s-1"


def test_the_table_of_a_pair_is_no_run():
    pair = gd.preset("teodorescu2009").replace({"run.duration": "1 us", "run.samples": 11})
    table = gd.simulate(pair).gearidae.train()
    assert table.gearidae.train() is table
    for asked in (
        lambda: table.gearidae.verdicts(),
        lambda: table.gearidae.work(),
        lambda: gd.plot.train(table),
    ):
        with pytest.raises(gd.SceneError, match="give the run of the pair itself"):
            asked()


@pytest.mark.parametrize("part", [{"shaft": "input"}, {"mesh": "first"}, {"shaft": ["input", "idler"]}])
def test_a_part_of_a_train_is_not_judged(ds, part):
    some = ds.sel(part)
    for asked in (lambda: some.gearidae.verdicts(), lambda: gd.analysis.power_spectrum(some)):
        with pytest.raises(gd.SceneError, match="must have all shafts and meshes here: select in a variable"):
            asked()


def test_a_train_is_in_that_form_already(ds):
    assert ds.gearidae.train() is ds
