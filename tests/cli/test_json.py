"""``--json``: each command that prints tables prints one object instead, with what the tables say."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from tests.reference.trains import chain

import gearidae as gd
from gearidae.cli import main
from gearidae.studies.declared import command_help, studies

CASES = Path(__file__).parents[2] / "cases"
SHORT = ["--set", "run.duration=2 ms", "run.samples=201"]


@pytest.fixture
def printed(tmp_path, monkeypatch, capfd):
    """Run a command in a folder of its own, and read the one object that it prints."""
    monkeypatch.chdir(tmp_path)

    def run(*command, code=0):
        assert main([*command, "--json"]) == code
        out, err = capfd.readouterr()
        assert (err == "") == (code == 0)
        return json.loads(out)

    return run


def test_check(printed):
    told = printed("check", "teodorescu2009_low_speed")
    by_name = {row["name"]: row for row in told["rows"]}
    scene = gd.preset("teodorescu2009_low_speed")
    assert by_name["base pitch"] == {
        "section": "Gears", "name": "base pitch", "text": "11.48 um", "remark": "between neighbouring flanks",
        "number": scene.geometry.base_pitch, "unit": "m",
    }  # fmt: skip

    limits = {row["name"]: row for row in told["limits"]}
    assert limits["expected_asperities"]["holds"] is False
    assert told["scene"] == scene.to_dict()
    assert "number" in printed("check", "roller_slow")["rows"][0]


def test_check_has_numbers_where_the_text_has_them(printed):
    for case in CASES.glob("*.toml"):
        for row in printed("check", str(case))["rows"]:
            assert (row["number"] is None) == (row["text"] in ("unknown", "unbounded") or not row["unit"]), (
                row
            )


def test_check_lists_warnings(printed):
    warnings = printed("check", "teodorescu2009_low_speed", "--set", "surface.roughness=10 um")["warnings"]
    assert any("roughness" in warning for warning in warnings)


def test_run_and_info_tell_the_same(printed):
    told = printed("run", "teodorescu2009_low_speed", *SHORT, "-o", "low.nc")
    assert told == printed("info", "low.nc")
    assert told["file"] == "low.nc"
    assert told["outcomes"][0]["verdict"] == "turns smoothly"
    ds = gd.open("low.nc")
    assert told["energy_balance"]["drive_work"] == float(ds.drive_work)
    assert told["references"] == gd.cite(ds).splitlines()
    assert [row["name"] for row in told["limits"]][:1] == ["expected_asperities"]


def test_impacts_of_each_flank_are_counted_with_their_forces(printed):
    rattle = ["run.duration=0.1 ms", "run.samples=off", "run.impacts=true", "coating.sam_fraction=1"]
    told = printed("run", str(CASES / "alternating.toml"), "--set", *rattle, "-o", "hits.nc")["impacts"]
    with gd.open("hits.nc") as ds:
        hits = ds.gearidae.impacts()
    assert sum(row["count"] for row in told) == len(hits) > 0
    for row in told:
        of_flank = hits[hits["flank"] == row["flank"]]
        assert row["largest_force"] == of_flank["largest_force"].max()
        assert row["impulse"] == pytest.approx(of_flank["impulse"].sum(), rel=1e-12, abs=0)


def test_a_quiet_run_still_gives_its_answer(printed):
    assert printed("--quiet", "run", "roller_slow", "-o", "r.nc")["outcomes"][0]["impacts"] == 1


def test_sweep(printed, monkeypatch):
    told = printed(
        "sweep", "teodorescu2009_low_speed", *SHORT, "--over", "coating.sam_fraction=1,0.8", "-o", "s.nc"
    )
    assert told["swept"] == {"sam_fraction": [1.0, 0.8]}
    assert [outcome["label"] for outcome in told["outcomes"]] == [
        {"sam_fraction": 1.0},
        {"sam_fraction": 0.8},
    ]
    assert told["headline"]


def test_study_gives_its_values_and_the_rows_of_the_terminal(printed, capfd):
    command = ("pull-off", "teodorescu2009_low_speed", "--set", "contact.roughness=discrete", "--seeds", "3")
    told = printed(*command, "-o", "p.nc")
    ds = gd.open("p.nc")
    assert told["kind"] == ds.gearidae.kind == "pull_off"
    np.testing.assert_array_equal(told["variables"]["pull_off"]["values"], ds.pull_off)
    assert main(["info", "p.nc"]) == 0
    shown = capfd.readouterr().out
    assert told["answer"] in shown
    assert all(value in shown for row in told["rows"] for value in row)
    assert told == printed("info", "p.nc")


def test_studies_of_trains_give_what_python_has(printed):
    """Limits, parts and verdicts of each run, and what they lie along, to the last digit."""
    train = gd.Scene.from_dict(chain(hubs=0.3)).replace({"run.duration": "30 us"})
    Path("train.toml").write_text(gd.dump_case(train))
    key = "meshes.second.coating.sam_fraction"
    over = ["--over", "drive.torque=1e-11,1.2e-11", "--over", f"{key}=0.5,1"]
    asked = {
        "ensemble": ["--vary", f"{key}=uniform(0.4, 0.9)", "--size", "2"],
        "operating-map": over,
        "starting-torque": ["--impacts", "1"],
    }
    found = {
        "ensemble": gd.studies.ensemble(train, {key: "uniform(0.4, 0.9)"}, 2),
        "operating-map": gd.studies.operating_map(train, {"drive.torque": [1e-11, 1.2e-11], key: [0.5, 1.0]}),
        "starting-torque": gd.studies.starting_torque(train, impacts=1),
    }
    for study, ds in found.items():
        told = printed(study, "train.toml", *asked[study], "-o", f"{study}.nc")
        assert told["kind"] == ds.gearidae.kind
        assert told["sizes"] == dict(ds.sizes)
        assert set(told["variables"]) == set(ds.variables)
        given = {name: entry["values"] for name, entry in told["variables"].items() if "values" in entry}
        assert set(given) >= {*ds.coords, *studies()[told["kind"]].columns} & set(ds.variables)
        for name, values in given.items():
            expected = [None if value != value else value for value in np.ravel(ds[name].values).tolist()]
            assert np.ravel(np.array(values, dtype=object)).tolist() == expected, name


def test_a_run_of_a_train_says_where_its_work_goes(printed):
    train = gd.Scene.from_dict(chain(hubs=0.3)).replace({"run.duration": "1 us", "run.samples": 3})
    Path("train.toml").write_text(gd.dump_case(train))
    told = printed("run", "train.toml", "-o", "t.nc")
    work = gd.open("t.nc").gearidae.work()
    assert [part["name"] for part in told["work"]] == list(work.index)
    assert [part["share"] for part in told["work"]] == list(work["share"])
    assert told["work"][0]["passes"] == gd.open("t.nc")["mesh_efficiency"].values[0]
    assert told["energy_balance"]["drive_work"] == gd.open("t.nc")["drive_work"].item()


def test_every_study_and_table_takes_the_option():
    for command in (*command_help(), "check", "run", "sweep", "info", "assess", "surface", "surfaces"):
        assert "--json" in _options(command), command


def _options(command):
    from gearidae.cli.session import app

    return {name for argument in app[command].assemble_argument_collection() for name in argument.names}


def test_surfaces_and_a_scan(printed):
    rows = printed("surfaces")["surfaces"]
    assert {"value", "unit", "source", "assumed"} <= {*rows[0]}
    heights = gd.surfaces.gaussian_map(64, 1e-6, 5e-9, shortest=5e-8, longest=5e-7)
    np.save("scan.npy", heights)
    told = printed("surface", "scan.npy", "--size", "1 um", "--cutoff", "80 nm", "-o", "s.toml")
    assert told["cutoff"] == pytest.approx(80e-9)
    assert told["settings"]["surface.roughness"] > 0.0
    assert {row["by"] for row in told["rows"]} == {"summits", "moments"}
    assert Path("s.toml").exists()


def test_a_run_that_fails_gives_what_it_has(printed, end_early):
    end_early("chatter", share=0.4)
    told = printed("run", "teodorescu2009_low_speed", *SHORT, "-o", "low.nc", code=3)
    assert (told["status"], told["sizes"]["time"]) == ("chatter", 80)
