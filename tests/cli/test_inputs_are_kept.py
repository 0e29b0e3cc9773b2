"""No command writes over a file that it reads; pipes and impossible names are refused in one line."""

from __future__ import annotations

import os

import numpy as np
import pytest

import gearidae as gd
from gearidae.archive.target import as_path, check_target
from gearidae.cli import main
from gearidae.scene import dump_case


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    np.save("scan.npy", gd.surfaces.gaussian_map(128, 1e-6, 6e-9, shortest=40e-9, longest=300e-9, seed=1))
    (tmp_path / "case.toml").write_text(dump_case(gd.preset("roller_slow")))
    os.link("case.toml", "link.toml")
    return tmp_path


@pytest.mark.parametrize(
    "command",
    [
        ["surface", "scan.npy", "--size", "1 um", "--cutoff", "50 nm", "-o", "scan.npy"],
        ["surface", "scan.npy", "--size", "1 um", "--cutoff", "50 nm", "--picture", "./scan.npy"],
        ["surface", "scan.npy", "--size", "1 um", "--cutoff", "50 nm", "--case", "case.toml", "-o", "case.toml"],
        ["surface", "scan.npy", "--size", "1 um", "--cutoff", "50 nm", "--case=case.toml", "--output=case.toml"],
        ["run", "case.toml", "-o", "case.toml"],
        ["run", "case.toml", "-o", "link.toml"],
        ["sweep", "case.toml", "--over", "surface.energy=1,1.5", "-o", "case.toml"],
    ],
)  # fmt: skip
def test_an_output_onto_an_input_is_refused(command, folder, capsys):
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    assert main([*command, "--overwrite"]) == 2
    assert "input of this command" in capsys.readouterr().err.splitlines()[-1]
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before


def test_a_log_onto_an_input_is_refused(folder, capsys):
    before = (folder / "case.toml").read_bytes()
    assert main(["--log", "case.toml", "check", "case.toml"]) == 2
    assert "input of this command" in capsys.readouterr().err
    assert (folder / "case.toml").read_bytes() == before


def test_a_function_may_replace_what_it_has_read(folder):
    check_target("case.toml", overwrite=True)


def test_a_pipe_is_no_case_file(folder, capsys):
    os.mkfifo("pipe.toml")
    assert main(["check", "pipe.toml"]) == 2
    assert "is a pipe or a device" in capsys.readouterr().err


def test_a_name_with_the_character_nul():
    for name in ("a\0b", "a\0b.toml"):
        with pytest.raises(gd.SceneError, match="must be a file name"):
            as_path(name)
        with pytest.raises(gd.SceneError, match="case file"):
            gd.load_case(name)
    with pytest.raises(gd.SceneError, match=r"drive\.schedule"):
        gd.preset("teodorescu2009_low_speed").replace({"drive.schedule": {"file": "a\0b.csv"}})
    with pytest.raises(gd.SceneError):
        gd.open_archive("a\0b.nc")
