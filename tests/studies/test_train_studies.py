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
from gearidae.studies.declared.campbell import STUDY as CAMPBELL
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
    """Half a microsecond of the ramp is 3e-6 of it: a vibration of the meshes that is left lets go up to 2 us off."""
    knots = [[0.0, 0.9 * torque], [0.4e-3, 0.99 * torque], [4e-3, 1.01 * torque], [4.4e-3, 1.01 * torque]]
    drive = {"torque": 0.0, "schedule": knots}
    tables = chain(angle, hubs=0.3, load=LOAD, drive=drive, initial=REST)
    ds = gd.simulate(
        Scene.from_dict(tables).replace({"run.duration": 4.4e-3, "run.samples": "off"}), progress=False
    )
    assert float(ds["breakaway_torque"]) == pytest.approx(torque, rel=2e-5, abs=0.0)
    assert len(json.loads(ds["standstill_list"].item())) == 1


FREE = {"drive": {"torque": 1.2e-11}, "load": {"torque": 0.0}, "initial": REST}
INERTIA = 9.6e-21 * 4.0**2 + 1.536e-19 * 2.0**2 + 4.2e-18
"""Of the free chain at its output [kg m^2]."""


@pytest.mark.parametrize(
    ("judged", "pitch"), [("output", 2.0 * np.pi / 76), ("idler", 2.0 * np.pi / 38 / 2.0)]
)
def test_trains_start_when_their_torque_says(judged, pitch):
    """A free train is at constant acceleration; a pitch of the judged shaft, here as the way of the output [rad]."""
    free = Scene.from_dict(chain(**FREE)).replace({"run.judged": judged})
    half = np.sqrt(2.0 * pitch * INERTIA / (4.0 * 6e-12))
    ds = gd.studies.start_probability(
        free, {"drive.torque": "uniform(2e-12, 1e-11)"}, 4, by=[half, 10.0 * half], progress=False
    )
    exact = np.sqrt(2.0 * pitch * INERTIA / (4.0 * ds.torque.values))
    # the input comes a gap of 36 nm before the output moves, and the teeth bounce: hundredths of a pitch
    assert ds.start_time.values == pytest.approx(exact, rel=0.05)
    assert ds.started.values.tolist() == [2, 4]


def test_trains_that_are_turned_back_have_not_started():
    back = Scene.from_dict(chain(**FREE))
    ds = gd.studies.start_probability(
        back, {"drive.torque": "uniform(-1e-11, -8e-12)"}, 2, by=["1 ms"], progress=False
    )
    assert (int(ds.started[0]), ds.members.values.tolist()) == (0, [2])
    assert "0 of 2 trains have started after 1 ms" in repr(ds.gearidae)


def test_tolerances_are_compared_by_the_judged_shaft_and_its_mesh():
    short = Scene.from_dict(chain()).replace({"run.duration": "20 us"})
    of = ["gear_angle", "largest_mesh_force", "damping_loss"]
    ds = gd.studies.convergence(short, of, rtols=[1e-5, 1e-6, 1e-7], progress=False)
    assert ds["verdict"].values.tolist() == ["converges"] * 3
    run = gd.simulate(short, rtol=1e-7, progress=False)
    known = [
        run["gear_angle"].values[-1],
        run["largest_mesh_force"].sel(mesh="second"),
        run["damping_loss"].sum(),
    ]
    assert ds["reference"].values == pytest.approx(np.array(known, dtype=float), rel=1e-4)
    with pytest.raises(gd.SceneError, match="more than a number"):
        gd.studies.convergence(short, ["hub_loss"], progress=False)


@pytest.fixture(scope="module")
def campbell():
    held = Scene.from_dict(chain(load={"torque": 4.0 * 1.2e-11})).replace({"run.samples": 1501})
    return gd.studies.campbell(held, [3000.0, 6000.0], multiples=[1, 30, 100], progress=False)


def test_a_campbell_diagram_of_a_train_has_its_meshes_and_modes(campbell):
    """The natural frequencies are those of the prototype, under the dry load that the drive carries at each speed."""
    assert campbell["natural_frequencies"].values * 2.0 * np.pi == pytest.approx(
        np.array([[2.532629e6] * 2, [6.053399e6] * 2]), rel=1e-6
    )
    assert campbell["mean_speed"].values == pytest.approx([3000.0, 6000.0], rel=0.05)
    turning = campbell["mean_speed"].values / (2.0 * np.pi)
    assert campbell["mesh_frequencies"].values == pytest.approx(np.array([19.0 * turning] * 2), rel=1e-12)
    assert campbell["shaft_ratio"].values.tolist() == [1.0, 0.5, 0.25]
    speed = float(campbell["critical_speeds"].sel(mesh="second", mode=1, multiple=30))
    meets = np.interp(speed, [3000.0, 6000.0], campbell["mesh_frequencies"].sel(mesh="second"))
    assert 30.0 * meets == pytest.approx(2.532629e6 / (2.0 * np.pi), rel=1e-6)
    assert float(campbell["critical_speed"].sel(multiple=100)) == pytest.approx(
        float(campbell["critical_speeds"].sel(mesh="second", mode=2, multiple=100)), nan_ok=True
    )
    assert (
        f"30 times mesh first and second meets natural frequency 1 at {speed:.4g} rad/s"
        in CAMPBELL.sentence(campbell)
    )
    assert any(row[0].startswith("30 x mesh first and second") for row in CAMPBELL.rows(campbell))


def test_its_picture_has_a_line_for_each(campbell):
    ax = gd.plot.campbell(campbell)
    labels = [line.get_label() for line in ax.get_lines()]
    assert {"mesh first and second and multiples", "natural frequency 1", "natural frequency 2"} <= set(
        labels
    )
    assert ax.get_xlabel() == "speed of input (rad/s)"
    ax.figure.canvas.draw()


DRAWN = {"mesh.pitch_error_rms": "2 nm", "run.duration": "20 us"}


def test_members_draw_the_teeth_of_all_gears():
    scene = Scene.from_dict(chain()).replace(DRAWN)
    ds = gd.studies.ensemble(scene, {"mesh.pitch_error_seed": "seeds"}, 3, jobs=1, progress=False)
    for seed in range(3):
        single = gd.simulate(scene.replace({"mesh.pitch_error_seed": seed}), progress=False)
        np.testing.assert_array_equal(ds["largest_mesh_force"][seed], single["largest_mesh_force"])
    assert np.unique(ds["largest_mesh_force"].sel(mesh="second")).size == 3
    with pytest.raises(gd.SceneError, match="the seed of all meshes"):
        gd.studies.ensemble(scene, {"meshes.second.pitch_error_seed": "seeds"}, 3, progress=False)
    with pytest.raises(gd.SceneError, match="nothing is drawn"):
        gd.studies.ensemble(Scene.from_dict(chain()), {"mesh.pitch_error_seed": "seeds"}, 3, progress=False)


def test_gears_of_one_design_start_each_by_itself():
    """Teeth of Hertz's asperities do not adhere: whatever their errors, hubs and the load alone hold them."""
    rest = Scene.from_dict(chain(hubs=0.3, load=LOAD)).replace({"meshes.second.pitch_error_rms": "3 nm"})
    ds = gd.studies.starting_torque(
        rest, "own", impacts=1, lowest=1e-13, seeds=2, tolerance=0.5, progress=False
    )
    assert ds["static_torque"].values == pytest.approx([STARTS], rel=1e-7)
    assert ds["seed"].values.tolist() == [0, 1]
    assert ds["starting_torque"].values == pytest.approx(np.full((1, 2), STARTS), rel=1e-7)


def test_limits_of_gears_of_one_design_differ_by_their_seeds():
    rest = Scene.from_dict(chain(hubs=0.3, load=LOAD, initial=REST)).replace(DRAWN)
    ends = (7.6e-12, 8.6e-12)
    ds = gd.studies.sticking_threshold(
        rest, "drive.torque", ends, exits=1, width=5e-13, seeds=2, jobs=1, progress=False
    )
    assert ds["seed"].values.tolist() == [0, 1]
    assert np.isfinite(ds["limit"].values).all()
