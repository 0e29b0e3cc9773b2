"""A damaged cache of compiled code, a full disk, and the user's own settings of numba never end in a traceback."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from gearidae.compiled import cache
from gearidae.engine import self_test

PROGRAM = """
import logging

logging.basicConfig(format="%(message)s")
from gearidae.compiled import compiled, compiled_callback, compiled_once, make_ready
from numba import types


@compiled
def double(x):
    return 2.0 * x


@compiled_once("part")
def triple(x: float) -> float:
    return 3.0 * x


@compiled_callback(types.float64(types.float64))
def half(x):
    return 0.5 * x


make_ready("part")
print(double(4.0), triple(4.0), half.ctypes(4.0))
"""
ANSWER = "8.0 12.0 2.0\n"


def run(folder, program=None, preexec=None, **settings):
    """Run a program with its compiled code in a folder."""
    (folder / "program.py").write_text(PROGRAM if program is None else program)
    return subprocess.run(
        [sys.executable, str(folder / "program.py")],
        env=os.environ
        | {"PYTHONPATH": str(Path(cache.__file__).parents[2]), "NUMBA_CACHE_DIR": str(folder / "cache")}
        | settings,
        preexec_fn=preexec,
        capture_output=True,
        text=True,
        check=False,
    )


def _flipped(content):
    """Change a bit in the middle, which numba would load as code."""
    middle = len(content) // 2
    return content[:middle] + bytes([content[middle] ^ 8]) + content[middle + 1 :]


SAID = {
    "of no bytes": lambda path: path.write_bytes(b""),
    "cut off": lambda path: path.write_bytes(path.read_bytes()[: path.stat().st_size // 2]),
    "zeros": lambda path: path.write_bytes(bytes(path.stat().st_size)),
}
HALF_SAID = {
    "gone": lambda path: path.unlink(),
    "a folder": lambda path: (path.unlink(), path.mkdir()),
    "a bit of another value": lambda path: path.write_bytes(_flipped(path.read_bytes())),
}


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """A folder whose program has been run, and a copy of what that has kept."""
    folder = tmp_path_factory.mktemp("kept")
    assert run(folder).stdout == ANSWER
    shutil.copytree(folder / "cache", folder / "copy")
    return folder


@pytest.mark.parametrize("ending", [".nbi", ".nbc"])
@pytest.mark.parametrize("damages", [SAID, HALF_SAID], ids=["damaged", "gone and damaged"])
def test_damaged_entries_are_made_anew_and_that_is_said_once(whole, damages, ending):
    """Each of the three kinds of compiled functions with a damage of its own."""
    shutil.rmtree(whole / "cache")
    shutil.copytree(whole / "copy", whole / "cache")
    entries = [path for path in (whole / "cache").rglob(f"*{ending}") if "program" in path.name]
    functions = sorted({path.name.partition("-")[0] for path in entries})
    harm = dict(zip(functions, damages.values(), strict=True))
    for path in entries:
        harm[path.name.partition("-")[0]](path)
    again = run(whole)
    assert (again.returncode, again.stdout) == (0, ANSWER), again.stderr
    said = again.stderr.splitlines()
    assert 1 <= len(said) <= (1 if damages is SAID else 3)  # a folder in the way is said twice
    assert any("is damaged and is made anew" in line for line in said)
    healed = run(whole)
    assert healed.stdout == ANSWER
    assert len(healed.stderr.splitlines()) <= (0 if damages is SAID else 2)  # the folder is still in the way
    assert all(path.stat().st_size > 100 for path in entries if path.is_file())


def test_a_full_disk_keeps_nothing_and_runs(tmp_path):
    """No file may grow beyond ten bytes: as on a full disk, files can be made and not written."""
    resource = pytest.importorskip("resource")
    full = run(tmp_path, preexec=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (10, 10)))
    assert (full.returncode, full.stdout) == (0, ANSWER), full.stderr
    assert len(full.stderr.splitlines()) == 1
    assert "cannot be kept" in full.stderr
    assert run(tmp_path).stdout == ANSWER


@pytest.mark.parametrize("text", ["", "null", "[1]", "7", '{"bdf": nul', '{"bdf": 3}', "\0\0"])
def test_a_damaged_note_of_the_self_test_is_made_anew(tmp_path, monkeypatch, text):
    monkeypatch.setattr(self_test, "cache_folder", lambda: tmp_path)
    monkeypatch.setattr(self_test, "examine", lambda way: f"asked for {way}")
    monkeypatch.setattr(self_test, "TRIED", (sys.platform,))
    (tmp_path / "self_test.json").write_text(text)
    self_test.failure.cache_clear()
    try:
        assert self_test.failure("bdf") == "asked for bdf"
        assert (tmp_path / "self_test.json").read_text() == '{"bdf": "asked for bdf"}'
    finally:
        self_test.failure.cache_clear()


COMMAND = """
import sys
from gearidae.cli import main

sys.argv = ["gearidae", "run", "roller_slow", "--set", "run.duration=1e-9", "-o", sys.argv[0] + ".nc"]
sys.exit(main())
"""
REFUSED = {
    "NUMBA_NUM_THREADS": ("0", "numba cannot be loaded: Number of threads"),
    "NUMBA_DISABLE_JIT": ("1", "must not be set: the solver runs compiled only"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_settings_of_numba_that_cannot_work_are_named_in_one_line(tmp_path, name):
    value, words = REFUSED[name]
    done = run(tmp_path, COMMAND, **{name: value, "NUMBA_CACHE_DIR": ""})
    assert done.returncode == 2
    assert done.stdout == ""
    line = " ".join(done.stderr.split())
    assert "Traceback" not in line
    assert name in line
    assert words in line
