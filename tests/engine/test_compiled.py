"""Compiled code is kept on disk, found again, and never stale."""

import subprocess
import sys

import pytest

from gearidae import compiled

RUN = (
    "import gearidae as gd, gearidae.engine as e; "
    "r = e.solve(gd.preset('roller_slow').replace({{'contact.model': '{model}'}}), t_end=1e-6); "
    "print(r.statistics.backend, r.samples['height'][-1])"
)


def run(folder, model):
    return subprocess.run(
        [sys.executable, "-c", RUN.format(model=model)],
        env={"NUMBA_CACHE_DIR": str(folder), "PATH": "", "HOME": str(folder)},
        capture_output=True,
        text=True,
        check=True,
    )


@pytest.mark.slow
def test_the_second_process_compiles_nothing(tmp_path):
    said = {"asperity": "compiling the solver", "elastic": "compiling elastic contacts"}
    for model, message in said.items():
        first = run(tmp_path, model)
        assert first.stderr.count("compiling") == 1
        assert f"{message} for this machine" in first.stderr
        # what elastic contacts need is compiled with the first of them, and not before
        assert any(tmp_path.rglob("service.*")) == (model == "elastic")
        kept = {p: p.stat().st_mtime_ns for p in tmp_path.rglob("*.nb*")}
        second = run(tmp_path, model)
        assert second.stderr == ""
        assert second.stdout == first.stdout
        assert {p: p.stat().st_mtime_ns for p in tmp_path.rglob("*.nb*")} == kept


def test_the_folder_is_named_after_everything_that_goes_in(monkeypatch, tmp_path):
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    names = set()

    def note():
        compiled.cache_folder.cache_clear()
        names.add(compiled.cache_folder().name)

    note()
    note()
    assert len(names) == 1
    for package in ("numba", "llvmlite", "scikit-sundae"):
        real = compiled.version
        with monkeypatch.context() as patch:
            patch.setattr(
                compiled, "version", lambda name, p=package, r=real: "0.0" if name == p else r(name)
            )
            note()
    with monkeypatch.context() as patch:
        patch.setattr(compiled, "COMPILED_PACKAGES", ("contact",))  # other sources
        note()
    assert len(names) == 5
    compiled.cache_folder.cache_clear()


def test_other_peoples_numba_cache_is_left_alone():
    import numba

    assert str(compiled.cache_folder()) != numba.config.CACHE_DIR
