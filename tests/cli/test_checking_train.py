"""``gearidae check`` of a train, and what other commands say of one."""

from __future__ import annotations

import json
import math

import pytest
from tests.reference.trains import chain, split

import gearidae as gd
from gearidae.cli import main
from gearidae.cli.checking_train import train_columns
from gearidae.scene import Scene, dump_case


@pytest.fixture
def case(tmp_path):
    def write(tables):
        path = tmp_path / "train.toml"
        path.write_text(dump_case(Scene.from_dict(tables)))
        return str(path)

    return write


def words(capfd):
    return " ".join(capfd.readouterr().out.split())


def test_check_prints_each_mesh_and_hub(case, capfd):
    assert main(["check", case(chain(hubs=0.3))]) == 0
    out = words(capfd)
    for expected in (
        "speed of input over that of output",
        "Mesh first input drives idler teeth 19:38 ratio 2 contact ratio 1.624",
        "phase 0.0613738378 of 11.48 um; line of centres at 40 deg",
        "equilibrium gap 18.73 nm",
        "stiffness 226.8 N/m",
        "load of the hub of idler 0.5296 uN at 110 deg friction takes 6.355e-13 N m",
        "natural frequencies 4.031e+05, 9.634e+05 Hz",
        "starting torque 8.0046985e-12 N m",
        "steps, within a factor of about five",
        "second: thermal motion",
    ):
        assert expected in out


def test_check_says_what_a_mesh_has_of_its_own(case, capfd):
    tables = chain()
    tables["meshes"]["second"]["coating"] = {"sam_fraction": 0.6}
    assert main(["check", case(tables)]) == 0
    assert words(capfd).count("of its own coating.sam_fraction = 0.6") == 1


def test_check_of_a_loop_without_torques(case, capfd):
    assert main(["check", case(split(drive={"torque": 0.0}, load={"torque": 0.0}))]) == 0
    assert "shared" not in words(capfd)


def test_check_says_how_hubs_age(case, capfd):
    tables = chain(hubs=0.2)
    for shaft in tables["shafts"].values():
        shaft |= {"hub_friction_rise": 0.1, "hub_ageing_time": "1 ms", "hub_memory_length": "50 nm"}
    tables["initial"]["rest_time"] = "1 s"
    assert main(["check", case(tables)]) == 0
    out = words(capfd)
    assert "ageing of the hub of idler 50 um/s below this sliding speed, 12.5 rad/s of its shaft" in out
    assert "after a long rest friction takes 6.355e-13 N m" in out  # as with 0.3, see above
    assert (
        "starting torque 8.0046985e-12 N m of the drive: dry resistances and hubs, without the teeth; after 1 s"
        in out
    )


def test_check_warns_of_ages_of_nothing(case, capfd):
    settings = ["initial.rest_time=1 s", "shafts.idler.hub_ageing_time=1 ms"]
    assert main(["check", case(chain(hubs=0.3)), "--set", *settings]) == 0
    out = words(capfd)
    for key in ("initial.rest_time = 1 s", "shafts.idler.hub_ageing_time = 1 ms"):
        assert f"{key} has no effect without hub_friction_rise of a shaft" in out


@pytest.mark.parametrize("rise", [0.0, 0.05], ids=["dry", "ageing"])
def test_size_of_the_samples_is_that_of_the_dataset(rise):
    tables = chain(hubs=0.2)
    if rise:
        tables["shafts"]["idler"] |= {
            "hub_friction_rise": rise,
            "hub_ageing_time": "1 ms",
            "hub_memory_length": "10 nm",
        }
    scene = Scene.from_dict(tables)
    ds = gd.simulate(scene, t_end=1e-6, samples=5)
    sampled = [ds[name].size for name in ds.data_vars if "time" in ds[name].dims]
    assert train_columns(scene) == sum(sampled) / ds.sizes["time"]


def test_check_takes_keys_of_meshes(case, capfd):
    assert main(["check", case(split()), "--set", "meshes.two.offset=3 nm"]) == 0
    assert "load of output shared three 73.83 %, four 26.17 %" in words(capfd)


def test_check_prints_what_a_loop_leaves(case, capfd):
    angles = 0.9022, math.asin(0.5 * math.sin(0.9022))
    assert main(["check", case(split(angles))]) == 0
    assert (
        "loop 0.0004254 pitches, 4.883 nm residual with which the loop two, one, three, four closes"
        in words(capfd)
    )


def test_numbers_for_programs(case, capfd):
    assert main(["check", case(chain()), "--json"]) == 0
    rows = json.loads(capfd.readouterr().out)["rows"]
    assert [row["number"] for row in rows if row["name"] == "force"] == pytest.approx(
        [3.456719e-7] * 2, rel=1e-7
    )


def test_a_coating_map_of_several_meshes_is_bad_input(case, capfd, tmp_path):
    assert main(["coating-map", case(chain()), "-o", str(tmp_path / "out.nc")]) == 2
    assert "meshes = (2 meshes): must be one here" in capfd.readouterr().err
    assert not (tmp_path / "out.nc").exists()


def test_commands_take_a_stage_as_a_case_of_its_own(case, capfd, tmp_path):
    """What a refusal says there is: the pair's case, of which a study runs."""
    train = case(chain())
    pull_off = ["pull-off", "--seeds", "3", "-o", str(tmp_path / "out.nc")]
    assert main([*pull_off, train]) == 2
    said = capfd.readouterr().err
    assert "meshes = (2 meshes): must be one here" in said
    assert "gearidae.dump_case(scene.pair(NAME))" in said
    stage = gd.load_case(train).pair("second")
    (tmp_path / "second.toml").write_text(gd.dump_case(stage))
    assert gd.load_case(tmp_path / "second.toml") == stage
    assert main([*pull_off, "--load", "1 uN", str(tmp_path / "second.toml")]) == 0
