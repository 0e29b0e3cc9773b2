"""Compiled code is kept on disk, found again, and never stale."""

import importlib
import os
import shutil
import subprocess
import sys
from pathlib import Path
from types import MappingProxyType

import pytest
from numba.core.errors import NumbaWarning

from gearidae.compiled import cache, options
from reference.compilations import COUNTING

RUN = (
    "import gearidae as gd, gearidae.engine as e; "
    "r = e.solve(gd.preset('roller_slow').replace({{'contact.bodies': '{model}'}}), t_end=1e-6); "
    "print(r.statistics.backend, r.samples['height'][-1])"
)

NOTHING = MappingProxyType({})


def run(folder, model, code=RUN, more=NOTHING):
    """Run a program with its compiled code in a folder, None for the folder that this process has, too."""
    # the package that is tested, wherever it lies
    environment = {"PYTHONPATH": str(Path(cache.__file__).parents[2])}
    if folder is None:
        environment = dict(os.environ) | environment
    else:
        environment |= {"NUMBA_CACHE_DIR": str(folder), "PATH": "", "HOME": str(folder)}
        # BLAS kernels decide the last bits of the tables
        environment |= {name: value for name, value in os.environ.items() if name.startswith("OPENBLAS_")}
    done = subprocess.run(
        [sys.executable, "-c", code.format(model=model)],
        env=environment | more,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done


MODELS = ("rigid", "elastic")
MISSING = ("adhesion_loss.*", "nodes.*", "follow._follow-*")
"""Functions that others call at their addresses, and parts of them: of the solver, elastic contacts, exposures."""


@pytest.fixture(scope="module")
def first_runs(tmp_path_factory):
    """A folder in which a process after the other has compiled what it needs, with what each left there and said.

    A few functions alone are missing before: to compile all takes minutes, which `make test` does once, ahead of the
    tests.
    """
    folder = tmp_path_factory.mktemp("cache")
    kept = cache.cache_folder()
    shutil.copytree(kept, folder / "gearidae" / kept.name, ignore=shutil.ignore_patterns(*MISSING))
    runs = {}
    for model in MODELS:
        process = run(folder, model)
        runs[model] = process, {p: p.stat().st_mtime_ns for p in folder.rglob("*.nb*")}
    return folder, runs


@pytest.mark.slow
def test_what_is_compiled_is_said(first_runs):
    """What elastic contacts need is compiled with the first of them, and not before; exposures are in neither run."""
    _, runs = first_runs
    for model, message in zip(MODELS, ("the solver", "elastic contacts"), strict=True):
        process, kept = runs[model]
        assert process.stderr.count("compiling") == process.stderr.count("functions compiled in") >= 1
        assert f"compiling {message} for this machine" in process.stderr
        names = [path.name for path in kept]
        assert any(name.startswith("step.advance-") for name in names)
        assert any(name.startswith("nodes.node_force-") for name in names) == (model == "elastic")
        assert not any(name.startswith("follow._follow-") for name in names)


@pytest.mark.slow
@pytest.mark.parametrize("model", MODELS)
def test_the_second_process_compiles_nothing(first_runs, model):
    folder, runs = first_runs
    again = run(folder, model)
    assert again.stderr == ""
    assert again.stdout == runs[model][0].stdout
    assert {p: p.stat().st_mtime_ns for p in folder.rglob("*.nb*")} == runs["elastic"][1]


def test_the_folder_is_named_after_everything_that_goes_in(monkeypatch, tmp_path):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    names = set()

    def note():
        cache.cache_folder.cache_clear()
        names.add(cache.cache_folder().name)

    note()
    note()
    assert len(names) == 1
    for package in ("numba", "llvmlite", "scikit-sundae"):
        real = cache.version
        with monkeypatch.context() as patch:
            patch.setattr(cache, "version", lambda name, p=package, r=real: "0.0" if name == p else r(name))
            note()
    with monkeypatch.context() as patch:
        patch.setattr(cache, "COMPILED_PACKAGES", ("contact",))  # other sources
        note()
    assert len(names) == 5
    cache.cache_folder.cache_clear()


def test_other_peoples_numba_cache_is_left_alone():
    import numba

    assert str(cache.cache_folder()) != numba.config.CACHE_DIR


SMALL = (
    COUNTING
    + """
from gearidae.contact.kernels import evaluate
from gearidae.compiled import cache_folder
import numpy as np
value = evaluate._septic(np.arange(64.0), 0, 0.5 / evaluate.KNOTS_PER_SIGMA, 0.0, 4)[0]
print(evaluate.__file__, cache_folder(), count.n, value)
"""
)


def copied(folder):
    """Another environment: the same sources at another place, with other times."""
    package = Path(cache.__file__).parents[1]
    shutil.copytree(package, folder / "gearidae", copy_function=shutil.copyfile)
    return {"PYTHONPATH": str(folder)}


def edit(folder):
    """Shift all pieces by one knot."""
    file = folder / "gearidae" / "contact" / "kernels" / "evaluate.py"
    text = file.read_text()
    assert text.count(PLACE) == 1
    file.write_text(text.replace(PLACE, f"{PLACE} + 1.0"))


PLACE = "position = (x - low) * KNOTS_PER_SIGMA"


def test_environments_of_the_same_sources_share(tmp_path):
    cache, names = tmp_path / "cache", ("one", "other")
    outputs = [run(cache, "", SMALL, copied(tmp_path / name)).stdout.split() for name in names]
    for (file, *_), name in zip(outputs, names, strict=True):
        assert Path(file).is_relative_to(tmp_path / name)
    assert outputs[0][1] == outputs[1][1]
    assert int(outputs[0][2]) > 0
    assert outputs[1][2] == "0"
    assert outputs[0][3] == outputs[1][3]
    edit(tmp_path / "other")
    edited = run(cache, "", SMALL, {"PYTHONPATH": str(tmp_path / "other")}).stdout.split()
    assert edited[1] != outputs[1][1]
    assert int(edited[2]) > 0
    assert edited[3] != outputs[1][3]


def test_what_cannot_be_kept_is_compiled_anew_and_never_stale(tmp_path):
    """A folder that cannot be written: what stands in its way is a file."""
    (tmp_path / "file").write_text("")
    environment = copied(tmp_path / "one")
    first, same = (run(tmp_path / "file", "", SMALL, environment) for _ in range(2))
    edit(tmp_path / "one")
    edited = run(tmp_path / "file", "", SMALL, environment)
    for process in (first, same, edited):
        assert process.stderr.count("compiled code cannot be kept") == 1
        assert int(process.stdout.split()[2]) > 0
    assert first.stdout == same.stdout
    assert edited.stdout.split()[3] != first.stdout.split()[3]
    assert not list((tmp_path / "one").rglob("*.nb?"))


FOREIGN = """
import ctypes
from gearidae.compiled import compiled
root = ctypes.CDLL(None).cbrt
root.argtypes, root.restype = (ctypes.c_double,), ctypes.c_double
@compiled
def edge(volume):
    return root(volume)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="the C library's name is another one there")
def test_a_function_that_numba_cannot_keep_works_and_is_named(tmp_path, monkeypatch):
    """An extension that calls C by an address, which differs from process to process."""
    (tmp_path / "edges.py").write_text(FOREIGN)
    monkeypatch.syspath_prepend(tmp_path)
    edge = importlib.import_module("edges").edge
    with pytest.warns(NumbaWarning, match='Cannot cache compiled function "edge"'):
        assert edge(27.0) == pytest.approx(3.0, rel=1e-15)  # one rounding


ALL = """
import numpy as np
import gearidae as gd
from gearidae.compiled import numba_options
from gearidae.engine import solve
assert numba_options() == frozenset()
scene = gd.preset("teodorescu2009").replace({{"contact.bodies": "rigid", "run.method": "bdf"}})
runs = [solve(scene, t_end=2e-5, samples=11, backend=b) for b in ("native", "sksundae")]
assert np.array_equal(runs[0].events.time, runs[1].events.time)
print([r.status for r in runs], len(runs[0].events), runs[0].samples["gear_speed"][-1].hex())
"""


@pytest.mark.by_hand
def test_both_drivers_do_without_numbas_undocumented_options(tmp_path):
    """Slower, and equal to the last bit; to compile without the options takes one to three minutes."""
    plain = run(tmp_path, "", ALL, {cache.PLAIN: "1"})
    usual = run(None, "", ALL.replace("assert numba_options() == frozenset()", "assert numba_options()"))
    assert "finished" in plain.stdout
    assert plain.stdout == usual.stdout


def test_an_option_that_numba_does_not_know_is_done_without(tmp_path, monkeypatch, caplog):
    monkeypatch.setattr(options, "_UNDOCUMENTED", {"_nrt": False, "_gone": True})
    monkeypatch.setattr(options, "cache_folder", lambda sources=(): tmp_path)
    options.numba_options.cache_clear()
    try:
        assert options.numba_options() == {"_nrt"}
        assert "_gone" in caplog.text
        caplog.clear()
        options.numba_options.cache_clear()
        assert options.numba_options() == {"_nrt"}  # known now
        assert caplog.text == ""
    finally:
        options.numba_options.cache_clear()
