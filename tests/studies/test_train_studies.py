"""Studies that run trains: members are single runs to the last bit, limits those of closed forms."""

from __future__ import annotations

import json
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest
import xarray as xr
from tests.reference.trains import chain

import gearidae as gd
from gearidae.archive.train.variables import MESH_TOTALS, OF_JUDGED, SHAFT_TOTALS
from gearidae.cli import main
from gearidae.scene import Scene, dump_case
from gearidae.studies.declared.ensemble import STUDY as ENSEMBLE
from gearidae.studies.declared.operating_map import STUDY as MAP
from gearidae.studies.declared.starting_torque import STUDY as STARTING

STARTS = 8.0046985e-12
"""Starting torque of the chain with hubs at 40 degrees [N m], of an independent prototype."""
REST = {"gear_speed": 0.0, "gap": "36 nm", "mesh_phase": 0.3}
LOAD = {"torque": 3e-11, "drag": 8e-18}
COVERAGE, HUB = "meshes.second.coating.sam_fraction", "shafts.idler.hub_radius"
VARY = {COVERAGE: "uniform(0.4, 0.9)", HUB: "normal(4 um, 0.2 um)"}


@pytest.fixture(scope="module")
def scene():
    return Scene.from_dict(chain(hubs=0.3)).replace({"run.duration": "60 us"})


@pytest.fixture(scope="module")
def members(scene):
    return gd.studies.ensemble(scene, VARY, 4, jobs=1, progress=False)


def test_members_of_an_ensemble_are_single_runs(scene, members):
    assert members.sizes["member"] == 4
    for number in range(4):
        member = members.isel(member=number)
        keys = {
            COVERAGE: float(member["meshes_second_coating_sam_fraction"]),
            HUB: float(member["hub_radius"]),
        }
        single = gd.simulate(scene.replace(keys), progress=False)
        for name in {*OF_JUDGED, *SHAFT_TOTALS, *MESH_TOTALS} & set(members.data_vars):
            np.testing.assert_array_equal(member[name], single[name], err_msg=name)
        assert str(member["verdict"].values) == single.gearidae.verdicts().verdict[0]
    assert "shaft_speed" not in members


def test_an_ensemble_is_kept_and_computed_anywhere(scene, members, tmp_path):
    path = tmp_path / "members.nc"
    with ProcessPoolExecutor(2) as pool:
        gd.studies.ensemble(scene, VARY, 4, executor=pool, progress=False, archive=path)
    read = gd.open_archive(path)
    xr.testing.assert_equal(read.drop_vars("wall_time"), members.drop_vars("wall_time"))
    assert ENSEMBLE.sentence(read).startswith("0 of 4 members stick")
    assert any(row[0] == "largest mesh force" for row in ENSEMBLE.rows(read))
    with pytest.raises(gd.SceneError, match="must be one of sticks"):
        gd.studies.ensemble(scene, VARY, 4, of="hub_loss", progress=False)


def test_indices_of_a_force_are_those_of_the_judged_mesh(scene):
    short = scene.replace({"run.duration": "5 us"})
    ds = gd.studies.ensemble(short, VARY, 4, of="largest_mesh_force", jobs=1, progress=False)
    assert ds["largest_mesh_force"].dims == ("member", "mesh")
    assert ds.attrs["index_of"] == "largest_mesh_force"
    assert ds["first_order"].dims == ("parameter",)


def test_a_map_says_what_the_judged_shaft_does(tmp_path, capfd):
    """Hubs hold the train below its starting torque, whatever the second mesh is coated with."""
    case, path = tmp_path / "train.toml", tmp_path / "map.nc"
    rest = Scene.from_dict(chain(hubs=0.3, load=LOAD, initial=REST))
    case.write_text(dump_case(rest.replace({"run.duration": "1 ms"})))
    over = ["drive.torque=7.8e-12,1.2e-11", f"{HUB}=4 um,4.1 um"]
    assert main(["operating-map", str(case), "--over", over[0], "--over", over[1], "-o", str(path)]) == 0
    assert "2 turns" in " ".join(capfd.readouterr().out.split())
    read = gd.open(path)
    assert read["verdict"].values[0].tolist() == ["sticks", "sticks"]
    assert (
        read["held_by"].values[0].tolist()
        == ["hub friction of input, hub friction of idler, hub friction of output"] * 2
    )
    assert MAP.sentence(read) == "4 runs: 2 turns, 2 sticks."
    assert main(["plot", str(path), "-o", str(tmp_path / "map.png")]) == 0


def test_the_threshold_is_the_starting_torque_of_the_hubs(tmp_path):
    rest = Scene.from_dict(chain(hubs=0.3, load=LOAD, initial=REST, drive={"torque": 7.9e-12}))
    path, ends = tmp_path / "threshold.nc", (7.6e-12, 8.6e-12)
    ds = gd.studies.sticking_threshold(
        rest, "drive.torque", ends, exits=10, width=1.3e-13, jobs=1, progress=False, archive=path
    )
    point = gd.open(path).isel(exits=-1)
    xr.testing.assert_equal(point, ds.isel(exits=-1))
    assert float(point["sticks"]) < STARTS < float(point["passes"])


def test_a_run_starts_where_the_hubs_let_it(tmp_path):
    rest = Scene.from_dict(chain(hubs=0.3, load=LOAD))
    path = tmp_path / "start.nc"
    ds = gd.studies.starting_torque(rest, impacts=1, lowest=1e-13, progress=False, archive=path)
    assert float(ds["static_torque"][0]) == pytest.approx(STARTS, rel=1e-7, abs=0.0)
    # nothing adheres: the lowest torque beyond that of the hubs turns it
    assert float(ds["simulated_torque"][0]) == float(ds["static_torque"][0])
    xr.testing.assert_equal(gd.open(path), ds)
    assert "at 8.005e-12 N m without inertia" in STARTING.sentence(ds) or "8.005 pN m" in STARTING.sentence(
        ds
    )


@pytest.mark.parametrize(
    ("angle", "torque"),
    [
        ("0 deg", 8.0528934e-12),
        ("-40 deg", 8.0696985e-12),
        ("40 deg", STARTS),
        ("90 deg", 7.9102254e-12),
        ("140 deg", 7.7954910e-12),
    ],
)
def test_a_ramp_breaks_away_at_the_static_torque(angle, torque):
    """A microsecond of the ramp is 5e-6 of it: a vibration of the meshes that is left lets go that much off at most."""
    knots = [[0.0, 0.9 * torque], [0.4e-3, 0.99 * torque], [4e-3, 1.01 * torque], [4.4e-3, 1.01 * torque]]
    drive = {"torque": 0.0, "schedule": knots}
    tables = chain(angle, hubs=0.3, load=LOAD, drive=drive, initial=REST)
    ds = gd.simulate(
        Scene.from_dict(tables).replace({"run.duration": 4.4e-3, "run.samples": "off"}), progress=False
    )
    assert float(ds["breakaway_torque"]) == pytest.approx(torque, rel=5e-6, abs=0.0)
    assert len(json.loads(ds["standstill_list"].item())) == 1
