"""Other systems, as far as they can be had on this one: other files to load, and trials that end their process."""

from __future__ import annotations

import json
import signal
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from gearidae.engine import self_test
from gearidae.engine.sundials import names


def test_the_extension_module_leads_to_all_functions_where_names_are_looked_for_in_its_libraries(monkeypatch):
    for system in ("linux", "darwin"):
        monkeypatch.setattr(names, "sys", SimpleNamespace(platform=system))
        assert names.libraries(Path("site/sksundae/_cy_ida.so")) == [Path("site/sksundae/_cy_ida.so")]


def test_windows_loads_each_library_of_the_wheel(monkeypatch, tmp_path):
    """The layout of scikit_sundae-1.2.0-cp312-cp312-win_amd64.whl."""
    monkeypatch.setattr(names, "sys", SimpleNamespace(platform="win32"))
    inside = ("sundials_core-db7c.dll", "sundials_ida-5aa2.dll", "openblas.dll", "vcomp140-95d4.dll")
    for name in inside:
        (tmp_path / "scikit_sundae.libs").mkdir(exist_ok=True)
        (tmp_path / "scikit_sundae.libs" / name).touch()
    extension = tmp_path / "sksundae" / "_cy_ida.cp312-win_amd64.pyd"
    assert names.libraries(extension) == [
        extension,
        *(tmp_path / "scikit_sundae.libs" / n for n in inside[:2]),
    ]


@pytest.fixture
def untried(monkeypatch, tmp_path):
    """A system on which nobody has run the driver."""
    monkeypatch.setattr(self_test, "sys", SimpleNamespace(platform="atari", executable=sys.executable))
    monkeypatch.setattr(self_test, "cache_folder", lambda: tmp_path)
    self_test.failure.cache_clear()
    yield
    self_test.failure.cache_clear()


@pytest.mark.usefixtures("untried")
def test_a_trial_on_an_untried_system_is_made_apart():
    """Where it passes; in a process that reads the same compiled code."""
    assert self_test.failure("adams") == ""


@pytest.mark.usefixtures("untried")
def test_a_trial_that_ends_its_process_is_a_failed_one(monkeypatch, tmp_path):
    monkeypatch.setattr(
        self_test, "TRIAL", "import os; os.abort()"
    )  # which is what a wrong layout of memory does
    assert self_test.failure("adams") == f"the process that tried it ended with code -{signal.SIGABRT:d}"
    assert json.loads((tmp_path / "self_test.json").read_text()) == {"adams": self_test.failure("adams")}


@pytest.mark.usefixtures("untried")
def test_a_trial_that_no_process_could_make_is_a_failed_one(monkeypatch):
    monkeypatch.setattr(self_test, "sys", SimpleNamespace(platform="atari", executable="/no/such/python"))
    assert self_test.failure("adams") == "no process could try it (FileNotFoundError)"
