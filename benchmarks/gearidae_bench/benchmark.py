"""The whole benchmark: which contenders can run, what is measured, and the result as one record."""

from __future__ import annotations

import json
import os
import platform
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import gearidae
from gearidae_bench.c_loop import c_contenders
from gearidae_bench.contender import Contender, engine_contenders, explicit_contenders
from gearidae_bench.growth import Growth, Start, measure_elastic, measure_growth, measure_start, measure_sweep
from gearidae_bench.measure import Point, Settings, measure_scene
from gearidae_bench.python_peers import scipy_contenders, sundials_contenders
from gearidae_bench.reference import Provenance
from gearidae_bench.scenes import BenchScene

__all__ = ["Result", "all_contenders", "run_benchmark"]


@dataclass(slots=True)
class Result:
    """All that was measured, and where.

    Attributes
    ----------
    machine, date : str
    versions : dict
        Of what takes part.
    scenes, labels, peers : dict
        Titles of the scenes; labels and kinds of the contenders.
    skipped : dict
        Why a contender did not take part.
    settings : dict
    points : list of Point
    references : dict of Provenance
    first_calls : dict
        Seconds of each contender's first run, compilation included.
    growth : list of Growth
    elastic : dict
        Run time with the elastic contact over that of the asperity model, by SAM fraction.
    sweep_efficiency : float
    start : Start or None
    """

    machine: str
    date: str
    versions: dict[str, str]
    scenes: dict[str, str]
    labels: dict[str, str]
    peers: dict[str, str]
    skipped: dict[str, str]
    settings: dict[str, float]
    points: list[Point] = field(default_factory=list)
    references: dict[str, Provenance] = field(default_factory=dict)
    first_calls: dict[str, float] = field(default_factory=dict)
    growth: list[Growth] = field(default_factory=list)
    elastic: dict[str, float] = field(default_factory=dict)
    sweep_efficiency: float = float("nan")
    start: Start | None = None

    def save(self, path: Path) -> None:
        """Write everything as JSON."""
        path.write_text(json.dumps(asdict(self), indent=1) + "\n")

    @classmethod
    def load(cls, path: Path) -> Result:
        """Read what `save` wrote."""
        stored = json.loads(path.read_text())
        stored["points"] = [Point(**p) for p in stored["points"]]
        stored["references"] = {name: Provenance(**p) for name, p in stored["references"].items()}
        stored["growth"] = [Growth(**g) for g in stored["growth"]]
        stored["start"] = Start(**stored["start"]) if stored["start"] else None
        return cls(**stored)


def all_contenders() -> tuple[Contender, ...]:
    """Everybody, whether able to run here or not."""
    return (
        *engine_contenders(),
        *c_contenders(),
        *explicit_contenders(),
        *sundials_contenders(),
        *scipy_contenders(),
    )


def run_benchmark(
    scenes: Sequence[BenchScene],
    settings: Settings,
    *,
    contenders: Sequence[Contender] | None = None,
    beyond: bool = True,
    report: Callable[[str], object] = lambda _: None,
) -> Result:
    """Measure run time against error, and what else a user feels.

    Parameters
    ----------
    scenes : sequence of BenchScene
    settings : Settings
    contenders : sequence of Contender, optional
        By default `all_contenders`; those that cannot run here are left out, with the reason in the result.
    beyond : bool, optional
        Whether to measure growth, the elastic contact, sweep and start as well.
    report : callable, optional
        Told in words what is being measured.

    Returns
    -------
    Result
    """
    everybody = all_contenders() if contenders is None else contenders
    reasons = {c.key: c.unavailable() for c in everybody}
    able = [c for c in everybody if not reasons[c.key]]
    result = Result(
        machine=_machine(),
        date=datetime.now(UTC).isoformat(timespec="seconds"),
        versions=_versions(),
        scenes={s.name: s.title for s in scenes},
        labels={c.key: c.label for c in everybody},
        peers={c.key: c.peer for c in everybody},
        skipped={key: reason for key, reason in reasons.items() if reason},
        settings=asdict(settings),
    )
    if beyond:
        report("growth with simulated time")
        result.growth = measure_growth()
        report("elastic contact")
        result.elastic = measure_elastic()
        report("sweep on two cores")
        result.sweep_efficiency = measure_sweep()
        report("start of a new process")
        result.start = measure_start()
    for bench in scenes:
        jumps = bench.scene.contact.is_discrete
        chosen = [c for c in able if c.jumps or not jumps]
        reference, points, first_calls = measure_scene(bench, chosen, settings, report)
        result.references[bench.name] = reference.provenance
        result.points += points
        for key, seconds in first_calls.items():
            result.first_calls.setdefault(key, seconds)
    return result


def _machine() -> str:
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return f"{_processor()}, {cores} cores, {platform.system()} {platform.machine()}"


def _processor() -> str:
    listing = Path("/proc/cpuinfo")
    if listing.is_file():
        for line in listing.read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or "unknown processor"


def _versions() -> dict[str, str]:
    versions = {"python": platform.python_version(), "gearidae": gearidae.__version__}
    for name in ("numpy", "scipy", "numba", "llvmlite", "scikit-sundae", "numbalsoda"):
        try:
            versions[name] = version(name)
        except PackageNotFoundError:
            versions[name] = "not installed"
    return versions
