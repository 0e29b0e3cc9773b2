"""What holds for every command: quiet, verbose, the log file, and examples that are right."""

from __future__ import annotations

import logging
import shlex

import pytest

from gearidae.cli import main
from gearidae.cli.examples import EXAMPLES
from gearidae.cli.session import app
from gearidae.cli.values import spread

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
    for example in EXAMPLES[command]:
        assert example.split()[-1] in shown
        program, *arguments = shlex.split(example)
        assert program == "gearidae"
        app.parse_args(spread(arguments), exit_on_error=False, print_error=False)


def test_completion_is_offered(capfd):
    assert main(["--help"]) == 0
    assert "--install-completion" in capfd.readouterr().out
