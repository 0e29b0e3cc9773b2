"""Surroundings that a program cannot choose: closed streams, full disks, other encodings, a user's own settings."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import matplotlib as mpl
import pytest

import gearidae as gd
from gearidae.archive import save
from gearidae.cli import main
from gearidae.cli.interrupts import interrupts_kept
from gearidae.printable import printable
from gearidae.report import build_report
from gearidae.scene import dump_case

ROLLER = gd.preset("roller_slow").replace({"run.samples": 51})
HOSTILE = "red \x1b[31m bell \x07 title \x1b]0;pwned\x07 CSI \x9b31m turned \u202e"
needs_posix = pytest.mark.skipif(os.name != "posix", reason="redirects by a POSIX shell")
needs_full = pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a disk that is always full")


@pytest.fixture(scope="module")
def run():
    return gd.simulate(ROLLER)


@pytest.fixture
def folder(tmp_path, monkeypatch, run):
    """Hold a case and an archive."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "case.toml").write_text(dump_case(ROLLER))
    save(run, tmp_path / "out.nc")
    return tmp_path


def shell(command, **environment):
    """Run a command of a POSIX shell, in which ``gearidae`` is this one."""
    program = f'gearidae() {{ "{sys.executable}" -m gearidae "$@"; }}; {command}'
    return subprocess.run(
        ["/bin/sh", "-c", program],
        env={**os.environ, **environment},
        capture_output=True,
        check=False,
        timeout=120,
    )


@needs_posix
def test_closed_streams_change_nothing(folder):
    done = shell("gearidae run case.toml -o new.nc <&- >&- 2>&-")
    assert done.returncode == 0
    assert b"Traceback" not in done.stderr
    with gd.open_archive(folder / "new.nc") as ds:
        assert ds.attrs["status"] == "finished"


@needs_posix
@pytest.mark.parametrize("arguments", ["run case.toml -o new.nc", "--help"])
def test_a_reader_may_close_its_pipe(arguments, folder):
    done = shell(f"{{ gearidae {arguments}; echo $? >&2; }} | :")
    assert done.stderr == b"0\n"


@needs_full
def test_a_log_on_a_full_disk_takes_nothing_with_it(folder, capfd):
    assert main(["run", "case.toml", "-o", "new.nc", "--log", "/dev/full"]) == 0
    out, err = capfd.readouterr()
    assert "Archive: new.nc" in out
    assert "No space left" in err
    assert len(err.splitlines()) == 1


@needs_full
@needs_posix
def test_results_that_do_not_fit_are_an_error(folder):
    done = shell("gearidae info out.nc >/dev/full")
    assert done.returncode == 3
    assert done.stderr.count(b"\n") == 1
    assert b"No space left" in done.stderr


@needs_posix
def test_an_encoding_without_the_characters_of_a_name(folder):
    (folder / "out.nc").rename(folder / "zähne.nc")
    done = shell("gearidae report zähne.nc && gearidae info häh.nc", LC_ALL="C", PYTHONIOENCODING="ascii")
    assert b"Traceback" not in done.stderr
    assert rb"Report: z\xe4hne.html" in done.stdout
    assert rb"h\xe4h.nc" in done.stderr
    assert (folder / "zähne.html").exists()


@needs_posix
def test_bytes_that_are_no_text_in_a_name(folder):
    name = os.fsdecode(b"bad\xff\x1b[31m.toml")
    try:
        Path(name).write_text(dump_case(ROLLER))
    except OSError:
        pytest.skip("a file system that has Unicode names only")
    done = shell(f"gearidae check '{name}' && gearidae info '{name}'", LC_ALL="C.UTF-8")
    assert done.returncode == 2
    assert b"Traceback" not in done.stderr
    assert rb"bad\udcff\x1b[31m.toml" in done.stderr
    assert b"\x1b" not in done.stdout + done.stderr


@needs_posix
def test_pictures_do_not_depend_on_the_users_settings(folder):
    (folder / "matplotlibrc").write_text(
        "text.usetex: True\nfont.size: 40\nbackend: nonsense\nno.such.key: 3\n"
    )
    assert main(["plot", "out.nc", "-o", "usual.png"]) == 0
    done = shell("gearidae plot out.nc -o own.png", MPLCONFIGDIR=str(folder), MPLBACKEND="nonsense")
    assert (done.returncode, done.stderr) == (0, b"")
    assert (folder / "own.png").read_bytes() == (folder / "usual.png").read_bytes()


def test_reports_do_not_depend_on_the_users_settings(run):
    usual = build_report(run)
    with mpl.rc_context({"text.usetex": True, "font.size": 40}):
        assert build_report(run) == usual


def test_escape_sequences_of_a_file_are_shown_as_text(folder, run, capfd):
    ds = run.copy()
    ds.attrs |= {"title": HOSTILE, "history": HOSTILE, "message": HOSTILE, "summary": HOSTILE}
    save(ds, folder / "evil.nc")
    assert main(["info", "evil.nc"]) == 0
    assert main(["report", "evil.nc"]) == 0
    assert main(["plot", "evil.nc"]) == 0
    assert main(["info", f"no{HOSTILE}such.nc"]) == 2
    assert main(["run", "case.toml", "--set", f"{HOSTILE}=1"]) == 2
    said = "".join(capfd.readouterr())
    assert r"red \x1b[31m bell \x07" in said
    said += (folder / "evil.html").read_text(encoding="utf-8")
    assert not set(said) & {"\x1b", "\x07", "\x9b", "\u202e"}


def test_printable_leaves_text_as_it_is():
    plain = "12 µm\tzähne “…” ─┼─\n日本語 🜂"
    assert printable(plain) == plain
    assert printable("a\rb\x00\udcff") == r"a\rb\x00\udcff"


def test_a_second_ctrl_c_does_not_cut_off_what_the_first_began():
    put_away = False

    def compute():
        nonlocal put_away
        try:
            signal.raise_signal(signal.SIGINT)
        except KeyboardInterrupt:
            signal.raise_signal(signal.SIGINT)
            put_away = True
            raise KeyboardInterrupt("the hint") from None

    with interrupts_kept(), pytest.raises(KeyboardInterrupt, match="the hint"):
        compute()
    assert put_away
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_ctrl_c_is_heeded_again_when_closing_takes_long(monkeypatch):
    monkeypatch.setattr("gearidae.cli.interrupts._CLOSING", 0.0)
    with interrupts_kept():
        for _ in range(2):
            with pytest.raises(KeyboardInterrupt):
                signal.raise_signal(signal.SIGINT)
