"""Data that a sweep keeps of its runs: everything, or parts by their names."""

from __future__ import annotations

import itertools
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from gearidae.archive.variables import (
    CONTACT,
    ENERGY_TOTALS,
    EVENTS,
    EXPOSURES,
    IMPACTS,
    OF_SWEPT_RUN,
    PASSAGES,
    RUN,
    STANDSTILL_LIST,
    VERDICT,
    extreme_names,
)
from gearidae.errors import SceneError
from gearidae.records import ROWS, Events, Rows, Solution
from gearidae.records.train_results import AnySolution, TrainSolution
from gearidae.scene import is_long_train
from gearidae.scene.group import did_you_mean, shorten
from gearidae.scene.sampled import columns_of

if TYPE_CHECKING:
    from gearidae.scene import Scene

GROUPS = (
    "verdict",
    "extremes",
    "statistics",
    "energy_balance",
    "scene",
    "exposures",
    "passages",
    "impacts",
    "samples",
    "events",
)
"""Names that stand for several variables, or for one, from the smallest to the largest."""
_ALWAYS = ("status", "message", "wall_time", *VERDICT)
_IN_WORDS = (
    "stick_time",
    "stick_exits",
    "advance",
    "free_advance",
    "settled",
    "holding",
    "turned_back",
    "back_time",
    "followed_time",
)
"""What the words of a gear's verdict say besides."""


@dataclass(frozen=True, slots=True)
class OutputSelection:
    """The parts of its runs that a sweep keeps.

    Attributes
    ----------
    asked : tuple of str
        The requested parts, sorted; the attribute ``keep`` of the dataset.
    names : frozenset of str or None
        The variables that are kept; None for all.
    """

    asked: tuple[str, ...] = ()
    names: frozenset[str] | None = None

    def holds(self, name: str) -> bool:
        """Whether a variable is kept."""
        return self.names is None or name in self.names

    def columns(self, scene: Scene) -> tuple[str, ...]:
        """List the sampled columns that are kept."""
        return tuple(name for name in _parts_of(scene)["samples"] if self.holds(name))

    def holds_rows(self, kind: type[Rows]) -> bool:
        """Whether rows of a kind are kept."""
        return self.holds(f"{kind.dim}_time")

    def thinned(self, solution: AnySolution) -> AnySolution:
        """Return a run without the samples and the rows that are not kept, and without its last state."""
        if self.names is None:
            return solution
        return (
            self._thinned_train(solution) if isinstance(solution, TrainSolution) else self._thinned(solution)
        )

    def _thinned_train(self, solution: TrainSolution) -> TrainSolution:
        from gearidae.archive.train.variables import TWO_SHAFTS  # which makes datasets by this module

        wanted = (self.names or frozenset()) | {
            source for name, source in TWO_SHAFTS.items() if self.holds(name)
        }
        samples = {name: values for name, values in solution.samples.items() if name in wanted}

        def rows(table: Mapping[str, Any], held: bool) -> dict[str, Any]:
            return {name: column if held else column[:0] for name, column in table.items()}

        return replace(
            solution,
            time=solution.time if samples else _NO_TIMES,
            samples=samples,
            events=rows(solution.events, self.holds_rows(Events)),
            rests=rows(solution.rests, self.holds("rest_list")),
            checkpoint=None,
        )

    def _thinned(self, solution: Solution) -> Solution:
        samples = {name: values for name, values in solution.samples.items() if self.holds(name)}
        time = solution.time if samples else _NO_TIMES
        reached = solution.reached
        if reached is None and len(solution.time):
            reached = float(solution.time[-1])
        gone: dict[str, Any] = {kind.field: kind.none() for kind in ROWS if not self.holds_rows(kind)}
        # the state at the end, of which a dataset of several runs has none, is most of what is left
        return replace(solution, time=time, samples=samples, reached=reached, checkpoint=None, **gone)


EVERYTHING = OutputSelection()
TOTALS = OutputSelection(("verdict",), frozenset())
"""No samples and no rows: what a run has summed up is with it in any case."""
_NO_TIMES = np.empty(0)
"""Shared by all runs that keep none."""


def read_keep(keep: Iterable[str] | str | None, scene: Scene) -> OutputSelection:
    """Read what the runs of a sweep are to leave behind.

    Parameters
    ----------
    keep : iterable of str, str or None
        Names of variables and of `GROUPS`; None for everything. The verdict with what its words say, the status and
        the wall time are kept in any case.
    scene : Scene
        What the runs have in common.

    Raises
    ------
    SceneError
        If a name is not known in such a scene.
    """
    if keep is None:
        return EVERYTHING
    asked = (keep,) if isinstance(keep, str) else keep
    if not isinstance(asked, Iterable):
        raise SceneError("keep", shorten(keep), "must be a list of variables, such as verdict or gear_speed")
    asked = list(asked)
    members: dict[str, tuple[str, ...]] = {
        "verdict": tuple(VERDICT),
        "statistics": (*RUN, *(variable.name for variable in CONTACT)),
        "scene": ("scene",),
        **_parts_of(scene),
    }
    alone = (
        members[group] for group in ("extremes", "energy_balance", "exposures", "samples") if group in members
    )
    single = (*RUN, *OF_SWEPT_RUN, *VERDICT, *itertools.chain(*alone))
    members |= {name: (name,) for name in single if name not in members}
    names = set(_ALWAYS) | (set(_IN_WORDS) if scene.roller is None else set())
    for name in asked:
        if not isinstance(name, str) or name not in members:
            meant = did_you_mean(str(name), members) or f"known are {', '.join(GROUPS)} and single variables"
            raise SceneError("keep", shorten(name), f"is nothing that a run of this scene leaves; {meant}")
        names.update(members[name])
    return OutputSelection(tuple(sorted({*asked, "verdict"})), frozenset(names))


def _parts_of(scene: Scene) -> Mapping[str, tuple[str, ...]]:
    """Variables that a run of a scene leaves by itself, by their groups."""
    if is_long_train(scene):
        # which makes datasets by this module
        from gearidae.archive.train.variables import PARTS, left_out

        absent = left_out(scene)
        return {group: tuple(name for name in names if name not in absent) for group, names in PARTS.items()}
    pairs_only = {"passages": tuple(PASSAGES)} if scene.roller is None else {}
    return {
        "extremes": (*extreme_names(scene), *([] if scene.roller is not None else [STANDSTILL_LIST.name])),
        "energy_balance": tuple(ENERGY_TOTALS),
        "exposures": tuple(EXPOSURES),
        **pairs_only,
        "impacts": (*IMPACTS, "impacts"),
        "samples": columns_of(scene),
        "events": (*EVENTS, "impacts"),
    }


def kept_in(attributes: Any, scene: Scene) -> OutputSelection:
    """Read the attribute ``keep`` of a dataset; everything if it has none.

    Raises
    ------
    SceneError
        If it differs from the parts of `read_keep`.
    """
    text = attributes.get("keep")
    if text is None:
        return EVERYTHING
    try:
        asked = json.loads(text)
    except (TypeError, ValueError):
        asked = [shorten(text)]
    return read_keep(asked, scene)
