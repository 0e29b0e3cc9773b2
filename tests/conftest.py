import gc
import signal
from numbers import Real

import numpy as np
import pytest
from hypothesis import settings

from gearidae.engine import backend as backend_module
from gearidae.records import Block, Ending
from gearidae.report import teeth
from reference.surface import PlainSurface

# Compilation, once per machine, falls into whichever example comes first.
settings.register_profile("gearidae", deadline=None)
settings.load_profile("gearidae")

SMALL = 1e-10
"""Of which pytest's own absolute tolerance is more than a percent."""


def pytest_collection():
    """Look for no garbage while modules and tests are made, of which there is none."""
    gc.disable()


def pytest_collection_finish():
    """Leave all that out of every later search."""
    gc.collect()
    gc.freeze()
    gc.enable()


@pytest.fixture(autouse=True, scope="session")
def _refuse_vacuous_comparisons():
    """Refuse a comparison with a tiny value that names no absolute tolerance: pytest's own is 1e-12.

    In SI units nearly everything about a micro-gear is smaller than that, and would be equal to anything.
    """
    compared = pytest.approx

    def approx(expected, rel=None, **tolerances):
        explicit = tolerances.get("abs") is not None
        if not explicit and isinstance(expected, Real) and 0.0 < abs(expected) < SMALL:
            raise ValueError(f"say abs=0, or what is allowed: 1e-12 is much beside {expected}")
        return compared(expected, rel=rel, **tolerances)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pytest, "approx", approx)
        yield


@pytest.fixture(autouse=True, scope="session")
def _heed_interrupts():
    """Let tests send Ctrl-C to themselves and to programs of theirs also where a shell runs them in the background."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(autouse=True, scope="session")
def _few_states_of_the_teeth():
    """Let reports show the teeth at 300 samples in place of 3,000, which take most of a report's time."""
    with pytest.MonkeyPatch.context() as patch:
        for function in (teeth.pack_runs, teeth.pack_teeth):
            patch.setattr(function, "__defaults__", (300,))
        yield


@pytest.fixture(scope="session")
def silicon() -> PlainSurface:
    return PlainSurface()


@pytest.fixture(scope="session")
def coated() -> PlainSurface:
    return PlainSurface(energy=0.1)


@pytest.fixture
def end_early(monkeypatch):
    """Let every run end before its time: after a share of its output, by Ctrl-C or by chatter."""

    def arrange(status, share=0.5):
        def cut(problem, rtol, samples, backend, statistics, *options):
            blocks = list(whole(problem, rtol, samples, backend, statistics, *options))
            rows = np.concatenate([block.rows for block in blocks])
            events = np.concatenate([block.events for block in blocks])
            kept = int(share * len(rows))
            time = blocks[-1].time * (kept - 1) / (samples - 1)
            yield Block(rows[:kept], events[events[:, 0] <= time], time)
            if status == "interrupted":
                raise KeyboardInterrupt
            statistics.ending = Ending.CHATTER

        whole = backend_module.run_blocks
        monkeypatch.setattr(backend_module, "run_blocks", cut)

    return arrange
