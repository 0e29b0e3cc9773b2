"""Parts of the engine are compiled by several processes the first time; each is compiled by one, and noted."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

import gearidae as gd
from gearidae.compiled import compiled
from gearidae.engine import beside, native, solve

PARTS = ("longest", "long", "short", "shortest", "last")
OTHERS = """
import os, sys, pathlib
folder, *parts = sys.argv[1:]
if "fails" in parts:
    sys.exit(1)
pathlib.Path(folder, f"{os.getpid()}.txt").write_text(" ".join(parts))
"""


@pytest.fixture
def three_cores(tmp_path, monkeypatch):
    """Make a machine with three cores that has compiled nothing; return what this process compiles, and the folder."""
    here: list[str] = []
    begun = subprocess.Popen
    monkeypatch.setattr(beside, "_cores", lambda: 3)
    monkeypatch.setattr(beside, "cache_folder", lambda: tmp_path)
    monkeypatch.setattr(beside, "compile_here", here.extend)
    monkeypatch.setattr(beside, "_COMPILE", OTHERS)

    def begin(command, **options):
        program, parts = command[:3], command[3:]
        return begun([*program, str(tmp_path), *parts], **options)

    monkeypatch.setattr(beside.subprocess, "Popen", begin)
    return here, tmp_path


def elsewhere(folder):
    """Parts that each other process has compiled."""
    return sorted(path.read_text().split() for path in folder.glob("*.txt"))


def test_each_part_is_compiled_by_one_process_and_once_on_a_machine(three_cores):
    here, folder = three_cores
    beside.compile_side_by_side(PARTS)
    assert here == ["longest", "shortest"]
    assert elsewhere(folder) == [["long", "last"], ["short"]]
    assert json.loads((folder / "parts.json").read_text()) == sorted(PARTS)
    beside.compile_side_by_side((*PARTS, "new"))  # one part alone needs no other process
    assert here == ["longest", "shortest"]
    assert len(elsewhere(folder)) == 2


def test_what_a_process_has_not_compiled_is_not_noted(three_cores):
    here, folder = three_cores
    beside.compile_side_by_side(("first", "fails"))
    assert here == ["first"]
    assert json.loads((folder / "parts.json").read_text()) == ["first"]


def test_without_processes_or_a_second_core_parts_are_compiled_where_they_are_needed(
    three_cores, monkeypatch
):
    here, folder = three_cores

    def refuse(*_arguments, **_options):
        raise OSError("no process can be had")

    monkeypatch.setattr(beside.subprocess, "Popen", refuse)
    beside.compile_side_by_side(("first", "second"))
    assert here == ["first"]
    monkeypatch.setattr(beside, "_cores", lambda: 1)
    beside.compile_side_by_side(("third", "fourth"))
    assert here == ["first"]
    (folder / "parts.json").write_text("[damaged")
    beside.compile_side_by_side(("third", "fourth"))
    assert here == ["first"]


def test_an_error_here_leaves_no_process_behind(three_cores, monkeypatch):
    _, folder = three_cores
    monkeypatch.setattr(beside, "_COMPILE", "import time; time.sleep(600)")
    begun = []
    begin = beside.subprocess.Popen
    monkeypatch.setattr(
        beside.subprocess, "Popen", lambda *a, **options: begun.append(begin(*a, **options)) or begun[-1]
    )

    def interrupt(_parts):
        raise KeyboardInterrupt

    monkeypatch.setattr(beside, "compile_here", interrupt)
    with pytest.raises(KeyboardInterrupt):
        beside.compile_side_by_side(PARTS)
    assert [process.returncode is not None for process in begun] == [True, True]
    assert not (folder / "parts.json").exists()


def test_a_function_is_compiled_ahead_for_arguments_like_these():
    @compiled
    def double(x):
        return 2.0 * x

    double.prepare(1.0)
    made = double._called.nopython_signatures
    assert [str(signature) for signature in made] == ["(float64,) -> float64"]
    assert double(3.0) == 6.0
    assert double._called.nopython_signatures == made


def test_the_loop_that_is_compiled_ahead_is_the_one_that_runs():
    scene = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 1e-4, "run.samples": 3})
    native.prepare_loop()
    solve(scene, backend="native")
    assert len(native.advance._called.nopython_signatures) == 1


CODE = """
import gearidae as gd
from gearidae.compiled import is_ready
from gearidae.engine import compiling

names = ["ELASTIC", "EXPOSURES", "POPULATION", "FRICTION", "IMPACTS"]
for backend in ("native", "sksundae"):
    for change in ({}, {"coating.sam_fraction": 0.45, "run.duration": 0.3}):
        scene = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 1e-3, "run.samples": 3} | change)
        if backend == "native" or not change:
            print(gd.simulate(scene, backend=backend).status)
print(any(is_ready(getattr(compiling, name)) for name in names))
"""


def test_gears_that_nothing_holds_need_no_other_part_of_the_engine():
    """Also where they stick: a run that called what has not been compiled would end with an error."""
    done = subprocess.run([sys.executable, "-c", CODE], capture_output=True, text=True, check=False)
    assert done.stdout.split() == ["finished"] * 3 + ["False"], done.stderr
