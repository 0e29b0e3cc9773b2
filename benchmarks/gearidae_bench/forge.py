"""Forged checkpoints and damaged archives: whatever stands in a file, a command ends in one line and an exit code.

The archive is that of a run that was cut off behind its first checkpoints. A forged checkpoint carries the checksum of
what it holds, so that nothing but the engine's own checks stands between it and compiled code. A damaged archive has
bits flipped anywhere, or its end cut off.
"""

from __future__ import annotations

import contextlib
import io
import random
import shutil
import tempfile
import traceback
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Final
from unittest.mock import patch

import netCDF4
import numpy as np

import gearidae as gd
from gearidae.archive import growing
from gearidae.archive.checkpoint import Checkpoint
from gearidae.archive.store import Store
from gearidae.cli import main
from gearidae.cli.codes import BAD_INPUT, DONE, UNFINISHED
from gearidae.engine.integrate import portable
from gearidae.scene import Scene, dump_case
from gearidae_bench.attack import Outcome, run_attack
from gearidae_bench.attack_worker import limit_memory

__all__ = ["FORGED_SCENES", "cut_off", "damage", "forge", "is_forged", "read_by_commands", "run_forge"]

PATIENCE = 120.0
"""Seconds that the commands may take with one file."""

_LOW = gd.preset("teodorescu2009_low_speed")
_SHORT = {"run.duration": "8 ms", "run.samples": 101}
FORGED_SCENES: Final = {
    "gears": _LOW.replace({**_SHORT, "contact.bodies": "rigid"}),
    "gears, elastic": _LOW.replace({"run.duration": "2 ms", "run.samples": 101, "contact.bodies": "elastic"}),
    "roller": gd.preset("roller_slow").replace({"run.samples": 101, "contact.bodies": "rigid"}),
}
"""Scenes whose checkpoints are forged, by name."""
_CODES = (DONE, BAD_INPUT, UNFINISHED)
_FLIPS = (1, 3, 30)
_FORGED_EVERY = 5  # files
_PICTURES_EVERY = 10


class _CutOffError(Exception):
    """What ends a run in the middle, as a kill would."""


def cut_off(scene: Scene, file: Path) -> None:
    """Write the archive of a run that ends without a word behind its first checkpoints.

    The portable driver runs it, whose limits are not compiled in and are lowered here.

    Parameters
    ----------
    scene : Scene
    file : Path
    """

    def cut(time: float, events: int) -> None:
        if time > 0.5 * scene.run.duration:
            raise _CutOffError

    with (
        patch.object(portable, "CHECKPOINT_STEPS", 20),
        patch.object(growing, "CHECKPOINT_SECONDS", 0.0),
        contextlib.suppress(_CutOffError),
    ):
        gd.simulate(scene, archive=file, backend="sksundae", progress=cut)


def forge(file: Path, rng: random.Random, word: int | None = None) -> str:
    """Change a word of the newest checkpoint, with the checksum that belongs to it.

    Parameters
    ----------
    file : Path
        A partial archive.
    rng : random.Random
    word : int, optional
        Which word of the state, modulo their number; by default any.

    Returns
    -------
    str
        What has been changed, in words.
    """
    with netCDF4.Dataset(file) as ds:
        run = str(ds.getncattr("run"))
    point = Checkpoint.newest(file, run)
    assert point is not None
    state = np.array(point.state)
    at = (rng.randrange(state.size) if word is None else word) % state.size
    was = state[at]
    words = state.view(np.int64)
    if rng.random() < 0.5:  # as a whole number
        words[at] = rng.choice([0, 1, -1, 2, int(words[at]) ^ 1, 2**40, -(2**40), rng.getrandbits(63)])
    else:
        state[at] = rng.choice(
            [0.0, 1.0, -1.0, np.nan, np.inf, 1e300, -1e300, 1e-300, was * (1.0 + 1e-3), -was]
        )
    replace(point, state=state).keep(file, run)
    return f"word {at}: {was!r} to {state[at]!r}"


def damage(file: Path, rng: random.Random) -> str:
    """Flip bits anywhere, or cut the end off; what has been done, in words.

    Parameters
    ----------
    file : Path
    rng : random.Random
    """
    content = bytearray(file.read_bytes())
    if rng.random() < 0.3:
        del content[rng.randrange(len(content)) :]
    flips = rng.choice(_FLIPS) if content else 0
    for _ in range(flips):
        content[rng.randrange(len(content))] ^= 1 << rng.randrange(8)
    file.write_bytes(bytes(content))
    return f"{flips} bits flipped, {len(content)} bytes left"


def read_by_commands(file: Path, case: Path, *, pictures: bool) -> str:
    """Let commands read a file, and resume its run; the first complaint about how one ended, or nothing.

    Parameters
    ----------
    file, case : Path
        A partial archive, and the case file of its scene.
    pictures : bool
        Whether to plot and to report as well.

    Returns
    -------
    str
        Empty if each ended with an exit code for users, and with one line wherever it could not do its work.
    """
    commands = [["info", str(file)]]
    if pictures:
        for command, ending in (("plot", ".png"), ("report", ".html")):
            commands.append([command, str(file), "-o", str(file.with_suffix(ending)), "--overwrite"])
    commands.append(["run", str(case), "-o", str(file), "--resume", "--quiet"])
    for arguments in commands:
        said = io.StringIO()
        try:
            with contextlib.redirect_stderr(said), contextlib.redirect_stdout(io.StringIO()):
                code = main(arguments)
        except Exception as defect:  # whatever it is, it is to be listed
            place = traceback.extract_tb(defect.__traceback__)[-1]
            return f"{arguments[0]}: {type(defect).__name__}: {defect} ({place.name}:{place.lineno})"
        lines = said.getvalue().strip().splitlines()
        if code not in _CODES or (code != DONE and len(lines) != 1):
            return f"{arguments[0]}: exit code {code}, {len(lines)} lines: {' / '.join(lines)[:300]}"
    return ""


def run_forge(
    runs: int, seed: int, jobs: int, report: Callable[[Outcome], None] | None = None
) -> list[Outcome]:
    """Forge checkpoints and damage archives, each read by commands in a process of its own.

    Parameters
    ----------
    runs : int
        How many files; every fifth is a forged checkpoint.
    seed, jobs : int
        Of the changes, and processes at a time.
    report : callable, optional
        Told each outcome as it is there.

    Returns
    -------
    list of Outcome
        ``finished`` if all commands ended as they may, else ``raised``, ``killed`` or ``silent``.
    """
    with tempfile.TemporaryDirectory(prefix="forge") as name:
        folder = Path(name)
        for scene_name, scene in FORGED_SCENES.items():
            cut_off(scene, folder / f"{scene_name}.nc")
            (folder / f"{scene_name}.toml").write_text(dump_case(scene))
        target = partial(_one, name)
        return run_attack(runs, seed, jobs, budget=0, patience=PATIENCE, report=report, target=target)


def is_forged(number: int) -> bool:
    """Whether this file's checkpoint is forged; else the archive is damaged."""
    return number % _FORGED_EVERY == 0


def _one(folder: str, seed: int, number: int, budget: int, reports: Connection, trace: str) -> None:
    """Change one file and read it, in a process of its own."""
    limit_memory()
    reports.send("begun")
    rng, turn = random.Random(f"{seed} {number}"), number // _FORGED_EVERY
    name = list(FORGED_SCENES)[turn % len(FORGED_SCENES)]
    source, file = Path(folder) / f"{name}.nc", Path(folder) / f"changed_{number}.nc"
    shutil.copyfile(source, file)
    shutil.copytree(Store(source).folder, Store(file).folder)
    word = turn // 2 if turn % 2 else None  # every second one in order, so that each field has its turn
    change = forge(file, rng, word) if is_forged(number) else damage(file, rng)
    pictures = number % _PICTURES_EVERY == 1
    complaint = read_by_commands(file, source.with_suffix(".toml"), pictures=pictures)
    status = "raised" if complaint else "finished"
    shutil.rmtree(Store(file).folder, ignore_errors=True)
    for left in Path(folder).glob(f"changed_{number}.*"):
        left.unlink()
    reports.send(Outcome(number, status, f"{change}: {complaint}" if complaint else change))
