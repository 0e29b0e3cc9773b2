"""Results of the runs of a sweep, and runs that are solved elsewhere."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from gearidae.analysis.verdict.judge import verdict_of
from gearidae.archive.output_selection import OutputSelection
from gearidae.errors import SceneError
from gearidae.records.train_results import AnySolution
from gearidae.runs.running import nothing_of, solve_any
from gearidae.scene import Scene


@dataclass(frozen=True, slots=True)
class RunResult:
    """Result of a run in a sweep: what is kept of it, with its verdict.

    Attributes
    ----------
    solution : Solution or TrainSolution
        Without the parts that are not kept.
    verdict : str
        Its outcome in one word, if parts are not kept; empty if all are.
    impacts, flank_changes : int
        Contacts made, and how often contact went over to the other flank, likewise.
    """

    solution: AnySolution
    verdict: str = ""
    impacts: int = 0
    flank_changes: int = 0


def solve_and_leave(
    scene: Scene,
    backend: str,
    selection: OutputSelection,
    on_progress: Callable[[float, int], None] | None = None,
) -> RunResult:
    """Run a scene, judge it, and drop what is not kept, where it was run.

    Parameters
    ----------
    backend : str
        As for `gearidae.simulate`.
    on_progress : callable, optional
        As for `gearidae.runs.running.solve`.
    """
    return leave(scene, solve_any(scene, backend, on_progress), selection)


def leave(scene: Scene, solution: AnySolution, selection: OutputSelection) -> RunResult:
    """Judge a run and drop what is not kept of it."""
    if selection.names is None:
        return RunResult(solution)
    return RunResult(selection.thinned(solution), *verdict_of(scene, solution))


def crashed(scene: Scene, error: Exception, selection: OutputSelection) -> RunResult:
    """Return what is left of a run that died, such as of memory that ran out."""
    return leave(scene, nothing_of(scene, "crashed", f"{type(error).__name__}: {error}"), selection)


def solve_group(scenes: Sequence[Scene], backend: str, selection: OutputSelection) -> list[RunResult]:
    """Run scenes one after the other; one that dies is no end of the others.

    Parameters
    ----------
    backend : str
        As for `gearidae.simulate`.

    Returns
    -------
    list of RunResult
        Up to the first that was interrupted.
    """
    results: list[RunResult] = []
    for scene in scenes:
        try:
            results.append(solve_and_leave(scene, backend, selection))
        except SceneError:
            raise
        except Exception as error:
            results.append(crashed(scene, error, selection))
        if results[-1].solution.status == "interrupted":
            break
    return results
