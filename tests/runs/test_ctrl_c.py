"""Ctrl-C: a program ends within about a second wherever it is, and keeps what it has computed."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import gearidae as gd
from gearidae.scene import dump_case

pytestmark = pytest.mark.skipif(
    not Path("/proc/self/stat").exists(), reason="reads a process's time from /proc"
)

LOW = gd.preset("teodorescu2009_low_speed")
SCENES = {
    "rigid": gd.preset("teodorescu2009").replace({"run.duration": 1.0, "run.samples": 100_001}),
    # thirty pairs a flank with nodes each: more than a thousand states
    "wide": LOW.replace(
        {"contact.bodies": "elastic", "mesh.tip_relief_radius": 0.04, "run.samples": 100_001}
    ),
}
PROMPT = 1.5
"""Own time of the program from the signal to its end, over that from its start to the signal, which is nearly all
imports: a quarter to a half is found, also on a busy machine. A good half of it is what closing the archive imports."""

PROGRAM = """
import importlib, os, signal, sys

from gearidae.cli import main

signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs ignore it
place, name = sys.argv[1].split(":")
module = importlib.import_module(place)
real = getattr(module, name)

def marked(*arguments, **options):
    os.write(1, b"there\\n")  # at once: a sweep's threads come here side by side
    return real(*arguments, **options)

setattr(module, name, marked)
sys.exit(main(sys.argv[2:]))
"""
BUILD, CONTACT = "gearidae.engine.setup.build", "gearidae.engine.setup.build_contact"


def cpu_of(pid):
    """Time of a process [s], its system calls included."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def interrupted(scene, stage, calls, folder):
    """Send SIGINT to a run: exit code, own time from there to the end over that before, standard error."""
    case = folder / "case.toml"
    case.write_text(dump_case(scene))
    return interrupted_at(stage, calls, ["--quiet", "run", "case.toml", "-o", "out.nc"], folder)


def interrupted_at(stage, calls, arguments, folder):
    """Send SIGINT as a stage is entered for so many times, to any command."""
    command = [sys.executable, "-c", PROGRAM, stage, *arguments]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=folder)
    try:
        assert process.stdout is not None
        for _ in range(calls):
            # what a command announces beforehand comes first
            assert "there\n" in iter(process.stdout.readline, ""), process.communicate()[1]
        before = cpu_of(process.pid)
        process.send_signal(signal.SIGINT)
        process.stdout.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        assert process.stderr is not None
        after = usage.ru_utime + usage.ru_stime - before
        return process.returncode, after / before, process.stderr.read()
    finally:
        if process.returncode is None:
            process.kill()
            process.wait()
        for stream in (process.stdout, process.stderr):
            stream.close()


@pytest.fixture(scope="module", autouse=True)
def warm():
    """Compile what the scenes need: the time of that is none of the program's."""
    for scene in SCENES.values():
        gd.simulate(scene, t_end=1e-9, samples=11)


@pytest.mark.parametrize(
    ("scene", "stage", "calls"),
    [
        pytest.param("rigid", f"{CONTACT}:law_table", 1, id="tables"),
        pytest.param("wide", f"{CONTACT}:deepest_gap", 1, id="layout of elastic nodes"),
        pytest.param("wide", f"{CONTACT}:node_grid", 2, id="influence coefficients"),
        pytest.param("wide", f"{BUILD}:settle_nodes", 1, id="settling of elastic nodes"),
        pytest.param("wide", f"{BUILD}:settle_nodes", 2, id="settling for the run itself"),
        pytest.param("rigid", "gearidae.engine.backend:run_blocks", 1, id="before the first step"),
        pytest.param("wide", "gearidae.engine.backend:run_blocks", 1, id="before the first elastic step"),
    ],
)
def test_before_the_first_block(scene, stage, calls, tmp_path):
    code, spent, said = interrupted(SCENES[scene], stage, calls, tmp_path)
    assert code == 130, said
    assert spent < PROMPT
    assert len(said.splitlines()) == 1, said
    if (tmp_path / "out.nc").exists():
        assert gd.open_archive(tmp_path / "out.nc").attrs["status"] == "interrupted"


@pytest.mark.parametrize("scene", SCENES)
def test_between_blocks_what_is_computed_is_kept(scene, tmp_path):
    stage = "gearidae.engine.integrate.native:update_statistics"
    code, spent, said = interrupted(SCENES[scene], stage, 8, tmp_path)
    assert code == 130, said
    assert spent < PROMPT
    assert len(said.splitlines()) == 1, said
    with gd.open_archive(tmp_path / "out.nc") as part:
        assert part.attrs["status"] == "interrupted"
        assert part.sizes["time"] > 1


@pytest.mark.slow
def test_a_sweep_of_long_runs(tmp_path):
    """Interrupted while they compute: exit code 130, one line, no litter."""
    case = tmp_path / "low.toml"
    case.write_text(dump_case(LOW.replace({"run.duration": 3000.0, "run.samples": 101})))
    arguments = ["sweep", "low.toml", "--over", "coating.sam_fraction=1,0.9"]
    stage = "gearidae.engine.integrate.native:update_statistics"
    code, spent, said = interrupted_at(stage, 3, arguments, tmp_path)
    assert code == 130, said
    assert spent < PROMPT
    assert said.startswith("gearidae: interrupted")
    assert len(said.splitlines()) == 1, said
    assert {file.name for file in tmp_path.iterdir()} <= {"low.nc", "low.toml"}
