"""What holds for every command: quiet, verbose, the log file, right examples, completion, words for mistyped ones."""

from __future__ import annotations

import logging
import os
import shlex
import shutil
import subprocess
import sys

import pytest

import gearidae as gd
from gearidae.cli import main
from gearidae.cli.command_line import spread
from gearidae.cli.examples import EXAMPLES
from gearidae.cli.session import app
from gearidae.scene import dump_case
from gearidae.studies.declared import study_of_command

SHORT = ["--set", "run.samples=51"]


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("place", ["before", "after"])
def test_quiet_run_says_nothing(place, folder, capfd):
    command = ["run", "roller_slow", *SHORT]
    assert main(["--quiet", *command] if place == "before" else [*command, "-q"]) == 0
    assert capfd.readouterr() == ("", "")
    assert (folder / "roller_slow.nc").exists()


def test_quiet_keeps_complaints_and_answers(capfd):
    assert main(["-q", "run", "nothing"]) == 2
    assert capfd.readouterr().err == "gearidae: case file = nothing: no such file\n"
    assert main(["-q", "check", "roller_slow"]) == 0
    assert "Tabor" in capfd.readouterr().out


def test_verbose_tells_on_standard_error(capfd):
    assert main(["run", "roller_slow", "-v", *SHORT]) == 0
    out, err = capfd.readouterr()
    assert "rebounds" in out
    assert "run roller_slow" in err
    assert "exit code 0" in err


def test_quiet_and_verbose_exclude_each_other(capfd):
    assert main(["-q", "-v", "check", "roller_slow"]) == 2
    assert "one of the two" in capfd.readouterr().err


def test_log_file_holds_what_was_done_and_what_went_wrong(folder, capfd):
    assert main(["run", "roller_slow", *SHORT, "--log", "all.log"]) == 0
    assert main(["run", "nothing", "--log", "all.log"]) == 2
    assert capfd.readouterr().err == "gearidae: case file = nothing: no such file\n"
    log = (folder / "all.log").read_text()
    assert "run roller_slow --set run.samples=51" in log
    assert "exit code 0" in log
    assert "SceneError: case file = nothing: no such file" in log
    assert logging.getLogger("gearidae").handlers == []


def test_log_that_cannot_be_written(capfd):
    assert main(["--log", "nowhere/x.log", "check", "roller_slow"]) == 2
    assert "--log = nowhere/x.log: cannot be written" in capfd.readouterr().err


@pytest.mark.parametrize("command", sorted(name for name in app if not name.startswith("-")))
def test_help_shows_examples_that_parse(command, capfd):
    assert main([command, "--help"]) == 0
    shown = " ".join(capfd.readouterr().out.split())
    assert "Examples:" in shown
    for example in EXAMPLES.get(command) or study_of_command(command).examples:
        assert example.split()[-1] in shown
        program, *arguments = shlex.split(example)
        assert program == "gearidae"
        app.parse_args(spread(arguments), exit_on_error=False, print_error=False)


def test_completion_is_offered(capfd):
    assert main(["--help"]) == 0
    assert "--install-completion" in capfd.readouterr().out


WORDS = {
    "gearidae sw": {"sweep"},
    "gearidae sweep --zi": {"--zipped"},
    "gearidae --quiet coating-map --jo": {"--jobs"},
    "gearidae run lo": {"low.toml", "low_speed"},
    "gearidae plot lo": {"low.toml"},
    "gearidae assess --map lo": {"low.toml"},
    "gearidae check star": {"start_up"},
    "gearidae init mine --preset brak": {"braking"},
    "gearidae run low.toml --set coating.sam": {"coating.sam_fraction="},
    "gearidae sweep low.toml --over gears.mod": {"gears.module="},
    "gearidae plot x.nc --picture power": {"power_spectrum"},
}
TRY = """
source completion
for line in "$@"; do
    COMP_WORDS=($line); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); COMP_LINE="$line"; COMP_POINT=${#line}; COMPREPLY=()
    _gearidae
    echo "${COMPREPLY[*]}"
done
"""


@pytest.mark.skipif(shutil.which("bash") is None, reason="needs bash")
def test_bash_completes_commands_options_and_files(tmp_path):
    (tmp_path / "low.toml").touch()
    (tmp_path / "completion").write_text(app.meta.generate_completion(shell="bash"))
    (tmp_path / "try.sh").write_text(TRY)
    program = tmp_path / "bin" / "gearidae"  # which the shell asks for what only the program knows
    program.parent.mkdir()
    program.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m gearidae "$@"\n')
    program.chmod(0o755)
    done = subprocess.run(
        ["bash", "try.sh", *WORDS],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "PATH": f"{program.parent}{os.pathsep}{os.environ['PATH']}"},
    )
    assert done.stderr == ""
    assert [set(line.split()) for line in done.stdout.splitlines()] == list(WORDS.values())


@pytest.mark.parametrize(
    ("line", "meant"),
    [
        (
            "check teodorescu2009_lo_speed",
            "no shipped case; did you mean teodorescu2009_low_speed?",
        ),
        ("check roller_slow --set coating.sam_fracton=1", "did you mean coating.sam_fraction?"),
        ("sweep roller_slow --over rollr.speed=1,2", "did you mean roller.speed?"),
        ("check teodorescu2009 --set drive.harmonic.0.fase=1", "did you mean drive.harmonic.0.phase?"),
        ("check typo.toml", "coating.sam_fracton = 1.0: unknown key; did you mean sam_fraction?"),
        ("run roller_slow --overwrit", "Did you mean --overwrite?"),
        ("chek roller_slow", 'Did you mean "check"?'),
        ("plot x.nc --picture gear_sped", "did you mean gear_speed?"),
    ],
)
def test_mistyped_words_are_answered_by_the_right_one(line, meant, tmp_path, capfd):
    case = dump_case(gd.preset("teodorescu2009"))
    (tmp_path / "typo.toml").write_text(case.replace("sam_fraction", "sam_fracton"))
    assert main(shlex.split(line)) == 2
    assert meant in capfd.readouterr().err


def test_a_case_without_its_ending_is_asked_for(folder, capfd):
    (folder / "pair.toml").write_text("")
    assert main(["check", "pair"]) == 2
    assert "is no file, no preset and no shipped case; did you mean pair.toml?" in capfd.readouterr().err
