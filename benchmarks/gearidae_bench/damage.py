"""Unfinished archives and folders of compiled code with damaged bytes: no death, and no silent value.

``python -m gearidae_bench.damage archives 200`` damages the archive of a run that was cut off, opens it and goes on
with the run; ``caches 200`` damages files of compiled code that a run loads. Each case has its own process.
"""

from __future__ import annotations

import collections
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import partial
from pathlib import Path

import numpy as np
import xarray as xr

import gearidae as gd
from gearidae.archive import growing
from gearidae.engine.integrate import driver, portable
from gearidae.studies.products import open_product

SCENE = gd.preset("teodorescu2009_low_speed").replace(
    {"coating.sam_fraction": 0.5, "run.duration": 0.01, "run.samples": 201}
)
_PLACES = ("head", "data", "end", "any")


def say(*words: object) -> None:
    """Print a line."""
    sys.stdout.write(" ".join(map(str, words)) + "\n")


def damage(content: bytes, seed: int) -> bytes:
    """Cut a file, zero a part of it, flip some of its bits, or write other bytes into it."""
    rng = np.random.default_rng(seed)
    kind = ("cut", "zeros", "flips", "bytes")[seed % 4]
    if kind == "cut":
        return content[: -int(rng.integers(1, min(len(content), 20_000)))]
    place = _PLACES[seed // 4 % 4]
    low, high = {
        "head": (0, min(3000, len(content))),
        "data": (min(131_000, len(content) // 2), len(content)),
        "end": (max(len(content) - 8192, 0), len(content)),
        "any": (0, len(content)),
    }[place]
    harmed = np.frombuffer(content, np.uint8).copy()
    begin = int(rng.integers(low, high))
    length = min(int(rng.integers(1, 4096)), len(content) - begin)
    if kind == "zeros":
        harmed[begin : begin + length] = 0
    elif kind == "bytes":
        harmed[begin : begin + length] = rng.integers(0, 256, length)
    else:
        for at in rng.integers(low, high, int(rng.integers(1, 5))):
            harmed[at] ^= 1 << int(rng.integers(8))
    return harmed.tobytes()


@contextmanager
def small_blocks() -> Iterator[None]:
    """Let runs of the portable driver write many blocks and checkpoints, between which their steps differ slightly."""
    modules = {
        (portable, "CHECKPOINT_STEPS"): 300,
        (portable, "BLOCK_SECONDS"): 0.0,
        (driver, "BLOCK_ROWS"): 7,
        (growing, "CHECKPOINT_SECONDS"): 0.0,
    }
    usual = {place: getattr(*place) for place in modules}
    try:
        for place, value in modules.items():
            setattr(*place, value)
        yield
    finally:
        for place, value in usual.items():
            setattr(*place, value)


def unfinished(path: Path) -> None:
    """Make the archive of a run that has been cut off, with a checkpoint before its last blocks."""

    def cut_off(time: float, _events: int) -> None:
        if time > 0.6 * SCENE.run.duration:
            raise KeyboardInterrupt

    with suppress(gd.Interrupted):
        gd.simulate(SCENE, archive=path, backend="sksundae", progress=cut_off)


def outcome(path: Path, whole: xr.Dataset) -> str:
    """Open a damaged archive and go on with its run: what happened, in a word; ``SILENT`` for a wrong value."""
    try:
        part, _ = open_product(path)
    except gd.SceneError:
        opened = "refused"
    else:
        opened = "opened" if _begins(part, whole) else "SILENT"
    try:
        ds = gd.simulate(SCENE, archive=path, backend="sksundae", resume=True)
    except (gd.SceneError, gd.SolverError):
        return f"{opened}, not resumed"
    return f"{opened}, resumed" if _begins(ds, whole) and ds.sizes == whole.sizes else f"{opened}, SILENT"


def _begins(part: xr.Dataset, whole: xr.Dataset) -> bool:
    """Whether a dataset is the beginning of another, to the last bit."""
    return part.attrs["scene"] == whole.attrs["scene"] and all(
        part[name].equals(whole[name].isel(dict.fromkeys(whole[name].dims, slice(part[name].size))))
        for name in whole.variables
        if whole[name].dims in (("time",), ("event",))
    )


def in_a_process(work: Callable[[], str]) -> str:
    """What some work returns in a copy of this process, or the signal or exit code that ended it."""
    if sys.platform == "win32":
        raise NotImplementedError("a process cannot be copied there")
    reader, writer = os.pipe()
    child = os.fork()
    if not child:
        try:
            os.write(writer, work().encode())
        except BaseException as error:
            os.write(writer, f"{type(error).__name__}: {error}"[:500].encode())
        os._exit(0)
    os.close(writer)
    with os.fdopen(reader, "rb") as file:
        word = file.read().decode()
    _, status = os.waitpid(child, 0)
    return word if status == 0 else f"DIED {os.waitstatus_to_exitcode(status)}"


def damaged_archives(folder: Path, seeds: range) -> dict[str, int]:
    """Count what happens with damaged archives."""
    with small_blocks():
        return _damaged_archives(folder, seeds)


def _damaged_archives(folder: Path, seeds: range) -> dict[str, int]:
    whole = gd.simulate(SCENE, archive=folder / "whole.nc", backend="sksundae")
    unfinished(folder / "sound.nc")
    content = (folder / "sound.nc").read_bytes()
    found: collections.Counter[str] = collections.Counter()
    for seed in seeds:
        path = folder / f"{seed}.nc"
        path.write_bytes(damage(content, seed))
        shutil.copytree(folder / "sound.nc.runs", folder / f"{seed}.nc.runs")
        word = in_a_process(partial(outcome, path, whole))
        found[word] += 1
        if not word.replace(",", "").replace(" ", "").isalpha() or "SILENT" in word:
            say(seed, word)
        path.unlink(missing_ok=True)
        shutil.rmtree(folder / f"{seed}.nc.runs", ignore_errors=True)
    return dict(found)


_RUN = """
import sys, gearidae as gd
ds = gd.simulate(gd.preset("teodorescu2009_low_speed").replace({"run.duration": 2e-3, "run.samples": 11}))
print(ds.gear_speed.values.tobytes().hex())
"""
_LOAD = (
    """
import os, sys
from gearidae.compiled import cache
def noticed(message, reason):
    print("noticed")
    sys.stdout.flush()
    os._exit(0)
cache._say_once = noticed
"""
    + _RUN
)
_MADE_ANEW = 20
"""One of so many damaged files is made anew, which takes minutes; of the others, whether damage is noticed is seen."""


def damaged_caches(folder: Path, seeds: range) -> dict[str, int]:
    """Count what happens in runs after files of compiled code have been damaged."""
    environment = os.environ | {"NUMBA_CACHE_DIR": str(folder / "cache")}

    def run(text: str) -> tuple[int, str, str]:
        ended = subprocess.run(
            [sys.executable, "-c", text], env=environment, capture_output=True, text=True, check=False
        )
        return ended.returncode, ended.stdout, ended.stderr

    def word_of(text: str) -> str:
        code, out, err = run(text)
        lines = err.strip().splitlines()
        said = "silently" if not lines else "with a line" if len(lines) == 1 else f"{len(lines)} LINES"
        if code or out not in (right, "noticed\n"):
            return f"DIED or WRONG ({code})"
        return "noticed" if out != right else f"right {said}"

    _, right, words = run(_RUN)
    assert right, words
    files = sorted(path for path in (folder / "cache").rglob("*") if path.is_file())
    largest = max(files, key=lambda path: path.stat().st_size)
    found: collections.Counter[str] = collections.Counter()
    for seed in seeds:
        path = largest if seed % 2 else files[int(np.random.default_rng(seed).integers(len(files)))]
        sound = path.read_bytes()
        path.write_bytes(damage(sound, seed))
        word = word_of(_LOAD)
        if word == "noticed" and seed % _MADE_ANEW == 0:
            path.write_bytes(damage(sound, seed))
            word += f", made anew: {word_of(_RUN)}, then {word_of(_RUN)}"
        else:
            path.write_bytes(sound)
        found[word] += 1
        if "DIED" in word or "LINES" in word:
            say(seed, path.name, word)
            path.write_bytes(sound)
    return dict(found)


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as place:
        do = damaged_archives if sys.argv[1] == "archives" else damaged_caches
        for words, number in sorted(do(Path(place), range(int(sys.argv[2]))).items()):
            say(f"{number:5d}  {words}")
