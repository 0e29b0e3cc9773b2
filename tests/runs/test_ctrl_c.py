"""Ctrl-C: a program ends within about a second wherever it is, and keeps what it has computed."""

from __future__ import annotations

import importlib
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import gearidae as gd
from gearidae.cli import main
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
PROMPT = 1.0
"""Own time of a program from the signal to its end, over that of a whole short one, which is nearly all imports."""

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
UPDATE = "gearidae.engine.native:update_statistics"


def cpu_of(pid):
    """Time of a process [s], its system calls included."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def cpu_until(pid):
    """Wait for the end of a process: its exit code and its time [s]."""
    _, status, usage = os.wait4(pid, 0)
    return os.waitstatus_to_exitcode(status), usage.ru_utime + usage.ru_stime


@pytest.fixture(scope="module")
def short_program(tmp_path_factory):
    """Own time of a short program [s], after what the scenes need has been compiled."""
    for scene in SCENES.values():
        gd.simulate(scene, t_end=1e-9, samples=11)
    target = tmp_path_factory.mktemp("short") / "out.nc"
    command = [sys.executable, "-m", "gearidae", "--quiet", "run", "roller_slow", "-o", str(target)]
    process = subprocess.Popen(command)
    process.returncode, spent = cpu_until(process.pid)
    assert process.returncode == 0
    return spent


def command_in_a_fork(stage, arguments, folder, there):
    """Run a command in this process, a fork: a byte goes into a pipe each time a stage is entered."""
    place, name = stage.split(":")
    module = importlib.import_module(place)
    real = getattr(module, name)
    setattr(module, name, lambda *values, **options: (os.write(there, b"."), real(*values, **options))[1])
    os.chdir(folder)
    for number, file in ((1, "out"), (2, "err")):
        os.dup2(os.open(file, os.O_CREAT | os.O_WRONLY), number)
    sys.stdout, sys.stderr = open(1, "w", closefd=False), open(2, "w", closefd=False)  # noqa: SIM115
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs ignore it
    code = main(arguments)
    sys.stdout.flush()
    sys.stderr.flush()
    return code


def interrupted(scene, stage, calls, folder):
    """Send SIGINT to a run as a stage is entered for so many times: exit code, own time to the end, standard error."""
    (folder / "case.toml").write_text(dump_case(scene))
    here, there = os.pipe()
    pid = os.fork()
    if not pid:
        code = 99
        try:
            code = command_in_a_fork(stage, ["--quiet", "run", "case.toml", "-o", "out.nc"], folder, there)
        finally:
            os._exit(code)
    os.close(there)
    met = [os.read(here, 1) for _ in range(calls)]
    os.close(here)
    before = cpu_of(pid)
    os.kill(pid, signal.SIGINT)
    code, spent = cpu_until(pid)
    said = (folder / "err").read_text()
    assert all(met), said
    return code, spent - before, said


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
@pytest.mark.filterwarnings("ignore:This process")  # is multi-threaded, says fork
def test_before_the_first_block(scene, stage, calls, short_program, tmp_path):
    code, spent, said = interrupted(SCENES[scene], stage, calls, tmp_path)
    assert code == 130, said
    assert spent < PROMPT * short_program
    assert len(said.splitlines()) == 1, said
    if (tmp_path / "out.nc").exists():
        assert gd.open_archive(tmp_path / "out.nc").attrs["status"] == "interrupted"


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.filterwarnings("ignore:This process")
def test_between_blocks_what_is_computed_is_kept(scene, short_program, tmp_path):
    code, spent, said = interrupted(SCENES[scene], UPDATE, 8, tmp_path)
    assert code == 130, said
    assert spent < PROMPT * short_program
    assert len(said.splitlines()) == 1, said
    with gd.open_archive(tmp_path / "out.nc") as part:
        assert part.attrs["status"] == "interrupted"
        assert part.sizes["time"] > 1


@pytest.mark.slow
def test_a_sweep_of_long_runs(short_program, tmp_path):
    """Interrupted while its threads compute, as a program, which waits for them: exit code 130, one line, no litter."""
    case = tmp_path / "low.toml"
    case.write_text(dump_case(LOW.replace({"run.duration": 3000.0, "run.samples": 101})))
    arguments = ["sweep", "low.toml", "--over", "coating.sam_fraction=1,0.9"]
    command = [sys.executable, "-c", PROGRAM, UPDATE, *arguments]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=tmp_path
    ) as process:
        try:
            for _ in range(3):
                # what a command announces beforehand comes first
                assert "there\n" in iter(process.stdout.readline, ""), process.communicate()[1]
            before = cpu_of(process.pid)
            process.send_signal(signal.SIGINT)
            process.stdout.read()
            process.returncode, spent = cpu_until(process.pid)
            said = process.stderr.read()
        finally:
            if process.returncode is None:
                process.kill()
    assert process.returncode == 130, said
    assert spent - before < PROMPT * short_program
    assert said.startswith("gearidae: interrupted")
    assert len(said.splitlines()) == 1, said
    assert {file.name for file in tmp_path.iterdir()} <= {"low.nc", "low.toml"}
