"""The program: what each command prints and writes, and its exit codes."""

from __future__ import annotations

import dataclasses
import errno
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import gearidae as gd
from gearidae import engine
from gearidae.cli import main
from gearidae.records import Ending

CASES = Path(__file__).parents[2] / "cases"
SHORT = ["--set", "run.duration=2 ms", "run.samples=101"]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def low(folder):
    """A copy of the low-speed case in the current folder."""
    (folder / "low.toml").write_text((CASES / "low_speed.toml").read_text())
    return "low.toml"


def files(folder):
    return sorted(path.name for path in folder.iterdir())


def one_line(text):
    return text.count("\n") == 1 and text.startswith("gearidae: ")


def cut_runs(monkeypatch, when, status):
    solve = engine.solve

    def cut(scene, **options):
        solution = solve(scene, **options)
        if not when(scene):
            return solution
        samples = {name: values[:40] for name, values in solution.samples.items()}
        return dataclasses.replace(
            solution, time=solution.time[:40], samples=samples, status=status, message="it chatters"
        )

    monkeypatch.setattr(engine, "solve", cut)


def test_run(low, folder, capfd):
    assert main(["run", low, *SHORT, "coating.sam_fraction=0.8"]) == 0
    out, err = capfd.readouterr()
    assert err == ""
    assert "turned smoothly" in out
    assert "low.nc" in out
    ds = gd.open_archive("low.nc")
    assert ds.sam_fraction == 0.8
    assert ds.time[-1] == 2e-3


def test_run_of_a_preset_with_output_and_tolerance(folder, capfd):
    assert main(["run", "roller_slow", "-o", "x.nc", "--rtol", "1e-5"]) == 0
    assert "rebounds" in capfd.readouterr().out
    assert gd.open_archive("x.nc").attrs["rtol"] == 1e-5
    assert files(folder) == ["x.nc"]


def test_sweep(low, folder, capfd):
    assert main(["sweep", low, "--over", "coating.sam_fraction=1:0.8:-0.1", *SHORT]) == 0
    out, err = capfd.readouterr()
    assert err == ""
    assert "sam_fraction" in out
    assert "turned smoothly" in out
    ds = gd.open_archive("low.nc")
    assert ds.sam_fraction.values.tolist() == [1.0, 0.9, 0.8]
    for fraction in ("1", "0.9", "0.8"):
        assert any(line.split()[:1] == [fraction] for line in out.splitlines())


def test_sweep_over_two_keys(low, folder):
    over = ["--over", "coating.sam_fraction=1,0.9", "mesh.backlash=0.2 um,0.3 um"]
    assert main(["sweep", *over, low, *SHORT, "--jobs", "1"]) == 0
    assert gd.open_archive("low.nc").gear_speed.dims == ("sam_fraction", "backlash", "time")


def test_plot_and_info(low, folder, capfd):
    main(["sweep", low, "--over", "coating.sam_fraction=1,0.5", *SHORT])
    capfd.readouterr()
    assert main(["plot", "low.nc"]) == 0
    assert main(["plot", "low.nc", "-o", "other.pdf"]) == 0
    assert (folder / "low.png").read_bytes().startswith(b"\x89PNG")
    assert (folder / "other.pdf").read_bytes().startswith(b"%PDF")
    assert capfd.readouterr().out == "Picture: low.png\nPicture: other.pdf\n"
    assert main(["info", "low.nc"]) == 0
    out = capfd.readouterr().out
    for expected in (
        "finished",
        "1, 0.5",
        "gear_contact_torque",
        "N m",
        gd.__version__,
        "coating.energy",
        "jkr",
    ):
        assert expected in out


def test_check_prints_what_follows_from_the_case(capfd):
    assert main(["check", str(CASES / "high_speed.toml")]) == 0
    out = capfd.readouterr().out
    # Figures of the model's description: contact ratio, E*, steady speed and mesh frequency, effective mass.
    for expected in ("1.681", "138.86 um", "84.996 GPa", "2898", "35057 Hz", "2.533e-12 kg", "6.362 uN"):
        assert expected in out
    assert main(["check", "roller_slow"]) == 0
    assert "4 us" in capfd.readouterr().out


def test_check_says_when_the_drive_is_too_weak(capfd):
    assert main(["check", str(CASES / "high_speed.toml"), "--set", "drive.torque=1e-12"]) == 0
    assert "does not overcome" in capfd.readouterr().out


def test_init_writes_a_case_that_is_the_preset(folder, capfd):
    assert main(["init", "mine", "--preset", "teodorescu2009"]) == 0
    scene = gd.load_case("mine.toml")
    assert scene == gd.preset("teodorescu2009").replace({"name": "mine"})
    assert "#" in (folder / "mine.toml").read_text()
    before = (folder / "mine.toml").read_bytes()
    capfd.readouterr()
    assert main(["init", "mine.toml"]) == 2
    assert "mine.toml: exists already" in capfd.readouterr().err
    assert (folder / "mine.toml").read_bytes() == before


def test_init_writes_every_key_of_its_tables(folder):
    """As the reference lists them; keys that are not set stand behind a comment sign."""
    from gearidae.scene import describe_keys

    assert main(["init", "mine", "--preset", "teodorescu2009"]) == 0
    text = (folder / "mine.toml").read_text()
    for info in describe_keys():
        table, _, key = info.key.partition(".")
        if key and table not in ("roller", "shafts", "meshes"):
            part = re.split(r"\n\[\w+\]", text.partition(f"\n[{table}]")[2])[0]
            name = key.split(".")[-1]
            assert re.search(rf"\b{name} =|\[\[{table}\.{name}\]\]", part), info.key


@pytest.mark.parametrize(
    "arguments",
    [
        ["run"],
        ["run", "nowhere.toml"],
        ["run", "low.toml", "--resume", "--overwrite"],
        ["run", "low.toml", "extra"],
        ["run", "low.toml", "--rtol", "tight"],
        ["run", "low.toml", "--rtol", "-1"],
        ["run", "low.toml", "--set", "coating.sam_fraction"],
        ["run", "low.toml", "--set", "coating.sam_fraction=1.5"],
        ["run", "low.toml", "--set", "coating.sam_fraction=0.5 um"],
        ["run", "low.toml", "--set", "coating.sam=0.5"],
        ["run", "low.toml", "-o", "missing/out.nc"],
        ["run", "low.toml", "-o", "."],
        ["run", "low.toml", "-o"],
        ["sweep", "low.toml"],
        ["sweep", "low.toml", "--over", "coating.sam_fraction=1:0.4:0.1"],
        ["sweep", "low.toml", "--over", "coating.sam_fraction=1,2"],
        ["sweep", "low.toml", "--over", "coating.sam_fraction=1", "--jobs", "0"],
        ["plot", "low.toml"],
        ["plot", "nowhere.nc"],
        ["info", "low.toml"],
        ["check", "nowhere"],
        ["init", "new", "--preset", "nowhere"],
        ["init", ""],
        ["init", "missing/new"],
        ["no-such-command"],
        ["--no-such-option"],
    ],
)
def test_bad_input_is_one_line_exit_2_and_nothing_written(arguments, low, folder, capfd):
    assert main(arguments) == 2
    out, err = capfd.readouterr()
    assert out == ""
    assert one_line(err), err
    assert files(folder) == ["low.toml"]


@pytest.mark.parametrize("command", [["run"], ["sweep", "--over", "coating.sam_fraction=1,0.5"]])
def test_archives_are_overwritten_only_if_asked(command, low, folder, capfd):
    (folder / "low.nc").write_bytes(b"precious")
    assert main([*command, low, *SHORT]) == 2
    assert "--overwrite" in capfd.readouterr().err
    assert (folder / "low.nc").read_bytes() == b"precious"
    assert main([*command, low, *SHORT, "--overwrite"]) == 0
    assert gd.open_archive("low.nc").attrs["status"] == "finished"


def test_pictures_are_overwritten_only_if_asked(low, folder):
    main(["run", low, *SHORT])
    (folder / "low.png").write_bytes(b"precious")
    assert main(["plot", "low.nc"]) == 2
    assert (folder / "low.png").read_bytes() == b"precious"
    assert main(["plot", "low.nc", "--overwrite"]) == 0
    assert (folder / "low.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("command", "made"),
    [
        (["plot", "low.nc"], "low.png"),
        (["plot", "low.nc", "--picture", "gear_speed"], "low_gear_speed.png"),
        (["plot", "low.nc", "--picture", "teeth", "--frames", "2"], "low_teeth.gif"),
        (["report", "low.nc"], "low.html"),
        (["explore", "low.nc"], "low_explore.html"),
    ],
)
def test_pictures_and_pages_are_made_again_under_their_own_names_only(command, made, low, folder, capfd):
    main(["run", low, *SHORT])
    assert main(command) == 0
    first = (folder / made).read_bytes()
    (folder / made).write_bytes(first + b" ")
    assert main(command) == 0
    assert (folder / made).read_bytes() == first
    capfd.readouterr()
    assert main([*command, "-o", made]) == 2
    assert "exists already" in capfd.readouterr().err
    (folder / made).write_bytes(first[:8] + b"by another program")
    assert main(command) == 2
    assert "--overwrite" in capfd.readouterr().err
    assert (folder / made).read_bytes() == first[:8] + b"by another program"


def test_a_solver_in_trouble_is_exit_3_and_the_archive_is_kept(low, folder, capfd, end_early):
    end_early("chatter", share=0.4)
    assert main(["run", low, *SHORT]) == 3
    out, err = capfd.readouterr()
    assert one_line(err)
    assert Ending.CHATTER.message in err
    assert "low.nc" in out
    ds = gd.open_archive("low.nc")
    assert (ds.attrs["status"], ds.sizes["time"]) == ("chatter", 40)


def test_a_failed_run_of_a_sweep_is_exit_3_and_named(low, folder, capfd, monkeypatch):
    cut_runs(monkeypatch, lambda scene: scene.coating.sam_fraction == 0.5, "chatter")
    assert main(["sweep", low, "--over", "coating.sam_fraction=1,0.5", *SHORT]) == 3
    out, err = capfd.readouterr()
    assert err == "gearidae: sam_fraction = 0.5: it chatters\n"
    assert "turned smoothly" in out
    assert gd.open_archive("low.nc").status.values.tolist() == ["finished", "chatter"]


def test_ctrl_c_is_exit_130_and_the_archive_is_kept(low, folder, capfd, end_early):
    end_early("interrupted")
    assert main(["run", low, *SHORT]) == 130
    err = capfd.readouterr().err
    assert one_line(err)
    assert "low.nc" in err
    assert "--resume" in err
    assert gd.open_archive("low.nc").attrs["status"] == "interrupted"


def test_help_and_version(capfd):
    assert main(["--version"]) == 0
    assert gd.__version__ in capfd.readouterr().out
    assert main(["--help"]) == 0
    out = capfd.readouterr().out
    for command in ("run", "sweep", "plot", "check", "init", "info"):
        assert command in out
        assert main([command, "--help"]) == 0


def program(*arguments, **options):
    return subprocess.Popen(
        [sys.executable, "-m", "gearidae", *arguments],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        **options,
    )


def test_the_program_itself(folder):
    """Exit codes, streams and the absence of tracebacks as a shell sees them."""
    process = program("run", "nowhere.toml")
    out, err = process.communicate(timeout=60)
    assert (process.returncode, out) == (2, "")
    assert one_line(err)


def test_help_loads_nothing_heavy():
    script = (
        "import sys; from gearidae.cli import main; main(['--help']); "
        "print([name for name in ('numba', 'xarray', 'scipy', 'pint', 'matplotlib', 'netCDF4') if name in sys.modules])"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, timeout=60, check=True
    )
    assert done.stdout.splitlines()[-1] == "[]"


def test_ctrl_c_while_the_command_line_is_being_loaded():
    interrupted = (
        "import sys\n"
        "class Interrupt:\n"
        "    def find_spec(self, name, path, target=None):\n"
        "        if name == 'cyclopts':\n"
        "            raise KeyboardInterrupt\n"
        "sys.meta_path.insert(0, Interrupt())\n"
        "from gearidae.cli import main\n"
        "sys.exit(main(['--help']))\n"
    )
    done = subprocess.run([sys.executable, "-c", interrupted], capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "gearidae: interrupted\n")


def test_a_reader_that_goes_away_is_no_error(folder):
    """As in ``gearidae info x.nc | head -1``."""
    main(["run", "roller_slow"])
    process = program("info", "roller_slow.nc")
    assert process.stdout is not None
    process.stdout.close()
    assert process.stderr is not None
    err = process.stderr.read()
    process.stderr.close()
    assert "Traceback" not in err
    process.wait(timeout=60)


def test_what_the_system_refuses_is_one_line(monkeypatch, capfd):
    """A full disk under the compiled code, say."""

    def full(*_, **__):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(gd, "simulate", full)
    assert main(["run", "roller_slow", "-o", "never.nc"]) == 3
    err = capfd.readouterr().err
    assert one_line(err), err
    assert "No space left" in err
