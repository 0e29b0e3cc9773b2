"""From what the engine hands up to one labelled dataset: a single run, or all runs of a sweep."""

from __future__ import annotations

import json
import math
from collections.abc import Hashable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from gearidae.archive.end_state import end_state_attributes
from gearidae.archive.exposures import exposure_coordinates, exposure_variables
from gearidae.archive.output_selection import EVERYTHING, OutputSelection
from gearidae.archive.provenance import provenance, surface_regimes
from gearidae.archive.row_variables import DIMS, row_variables
from gearidae.archive.sample_table import SampleTable
from gearidae.archive.totals import total_variables
from gearidae.archive.variables import (
    CONTACT,
    COVERAGE_KEY,
    OF_SWEPT_RUN,
    RUN,
    SAM_FRACTION,
    SAMPLES,
    TIME,
    Variable,
    by_name,
    run_label,
)
from gearidae.errors import SceneError
from gearidae.populations.flanks import flanks_digest, flanks_of
from gearidae.records import ROWS, Solution, Statistics
from gearidae.scene import Scene, describe_key
from gearidae.scene.combinations import bodies_reason
from gearidae.scene.sampled import columns_of

if TYPE_CHECKING:
    from gearidae.records.train_results import TrainSolution

_COUNTERS = tuple(name for name, variable in RUN.items() if variable.dtype is np.int64)
_RESERVED = {*by_name(), *DIMS, "scene", "coordinates"}


def to_dataset(scene: Scene, solution: Solution) -> xr.Dataset:
    """Label one run.

    Parameters
    ----------
    scene : Scene
        The scene exactly as it was run.
    solution : Solution
        What the engine handed up.

    Returns
    -------
    xarray.Dataset
        Samples along ``time``, events along ``event``, passages along ``passage``, impacts along ``tooth_impact``,
        scalar coordinate ``sam_fraction``, energy balance and extremes without a dimension; provenance, scene, solver
        statistics and status as attributes. Everything in SI units.
    """
    variables: dict[Hashable, Any] = {
        name: (("time",), _samples(solution, name), SAMPLES[name].attributes) for name in columns_of(scene)
    }
    for kind in ROWS:
        variables |= row_variables(kind, [scene], [solution])
    variables["reached"] = ((), reached(solution), OF_SWEPT_RUN["reached"].attributes)
    variables |= total_variables(scene, [scene], [solution])
    exposures = exposure_variables(scene, [scene], [solution])
    variables |= exposures
    return xr.Dataset(
        variables,
        {
            "time": ("time", solution.time, TIME.attributes),
            **run_label(scene),
            **(exposure_coordinates(scene) if exposures else {}),
        },
        {
            **provenance(scene, f"simulated {reached(solution):g} s"),
            "status": solution.status,
            "message": solution.message,
            **statistics_attributes([solution.statistics]),
            **_contacts(scene, solution),
            **surface_regimes(scene),
            **_asperities_digest(scene),
            **end_state_attributes(solution.start, solution.checkpoint),
            "t_end": end_time(scene, solution),
        },
    )


def _contacts(scene: Scene, solution: Solution) -> dict[str, str]:
    """Say which bodies and asperities have been computed, and what decided on the bodies."""
    elastic = solution.statistics.skipped.get("elastic_deflection", 1) == 0
    bodies = "elastic" if elastic else "rigid"
    reason = bodies_reason(scene, elastic=elastic)
    values = (bodies, reason, scene.contact.roughness)
    return {variable.name: value for variable, value in zip(CONTACT, values, strict=True)}


def _asperities_digest(scene: Scene) -> dict[str, str]:
    """Attribute that identifies the asperities of a population."""
    if not scene.contact.is_discrete:
        return {}
    return {"asperities_sha256": flanks_digest(flanks_of(scene))}


def end_time(scene: Scene, solution: Solution | TrainSolution) -> float:
    """When a run ends [s]: at the end of its time, or where it was to stop."""
    if scene.run.stop != "time" and solution.status == "finished":
        return reached(solution)
    return solution.start + scene.run.duration


def reached(solution: Solution | TrainSolution) -> float:
    """Return the simulated time that a run reached [s]."""
    if solution.reached is not None:
        return solution.reached
    return float(solution.time[-1]) if len(solution.time) else 0.0


def combine(
    scene: Scene,
    swept: Mapping[str, Sequence[Any]],
    scenes: Sequence[Scene],
    solutions: Sequence[Solution],
    *,
    selection: OutputSelection = EVERYTHING,
    samples: SampleTable | None = None,
) -> xr.Dataset:
    """Stack the runs of a sweep into one dataset.

    Parameters
    ----------
    scene : Scene
        The scene that the runs were derived from.
    swept : mapping of str to sequence
        Values of every swept key, in SI units.
    scenes, solutions : sequence
        The runs in the order of ``itertools.product`` over the swept values (the last key changes fastest). A
        run that produced nothing has empty arrays and says why in its status.
    selection : OutputSelection, optional
        Which variables the dataset has; by default all.
    samples : SampleTable, optional
        Holds the samples, if the solutions do not.

    Returns
    -------
    xarray.Dataset
        As `to_dataset`, with one dimension per swept key in front of ``time``. Samples that a run did not
        reach are NaN. Events, passages and impacts are ragged and therefore lie on a flat dimension each, labelled by
        ``event_<dimension>``, ``passage_<dimension>`` and ``tooth_impact_<dimension>``. Scene, status, solver
        statistics and energy balance are variables along the swept dimensions, the statistics' totals attributes.
    """
    names = dimension_names(swept)
    dims = tuple(names.values())
    shape = tuple(len(values) for values in swept.values())
    labels = {names[key]: key_labels(key, names[key], values) for key, values in swept.items()}
    if samples is None:
        longest = max(len(solution.time) for solution in solutions)
        samples = SampleTable(selection.columns(scene), len(solutions), longest)
        solutions = [samples.take(number, solution) for number, solution in enumerate(solutions)]
    variables: dict[Hashable, Any] = {
        name: ((*dims, "time"), table.reshape(*shape, -1), SAMPLES[name].attributes)
        for name, table in samples.columns().items()
    }
    for kind in ROWS:
        if selection.holds_rows(kind):
            variables |= row_variables(kind, scenes, solutions, labels)
    of_runs = _of_runs(scenes, solutions, selection)
    totals = total_variables(scene, scenes, solutions, dims, shape)
    for name, (variable, values) in of_runs.items():
        if selection.holds(name):
            variables[name] = (dims, values.reshape(shape), variable.attributes)
    variables |= {name: entry for name, entry in totals.items() if selection.holds(str(name))}
    exposures = exposure_variables(scene, scenes, solutions, dims, shape)
    exposures = {name: entry for name, entry in exposures.items() if selection.holds(str(name))}
    variables |= exposures

    coords: dict[Hashable, Any] = {}
    if selection.columns(scene):
        coords["time"] = ("time", samples.time, TIME.attributes)
    coords.update(labels)
    if exposures:
        coords.update(exposure_coordinates(scene))
    coords = {**coords, **{name: label for name, label in run_label(scene).items() if name not in dims}}
    return xr.Dataset(
        variables,
        coords=coords,
        attrs={
            **sweep_attributes(scene, swept, [solution.status for solution in solutions]),
            **({} if selection.names is None else {"keep": json.dumps(selection.asked)}),
            **statistics_attributes([solution.statistics for solution in solutions]),
            **surface_regimes(scene),
        },
    )


def sweep_attributes(
    base: Scene, swept: Mapping[str, Sequence[Any]], statuses: Sequence[str]
) -> dict[str, Any]:
    """Make the attributes of a sweep that tell what was swept, and how many of its runs are finished."""
    done, runs = sum(status == "finished" for status in statuses), len(statuses)
    return {
        **provenance(base, f"swept {runs} runs", swept=tuple(swept)),
        "swept": json.dumps(dict(swept), allow_nan=False),
        "status": "finished" if done == runs else "partial",
        "message": "" if done == runs else f"{done} of {runs} runs finished",
    }


def _of_runs(
    scenes: Sequence[Scene], solutions: Sequence[Solution], selection: OutputSelection
) -> dict[str, tuple[Variable, NDArray[Any]]]:
    """One value a run of what is kept: how it ended, its statistics and its input."""
    columns: dict[str, tuple[Variable, NDArray[Any]]] = {}
    for name, variable in RUN.items():
        if not selection.holds(name):
            continue
        source = [s if name in ("status", "message") else s.statistics for s in solutions]
        columns[name] = variable, np.array([getattr(holder, name) for holder in source], dtype=variable.dtype)
    columns["reached"] = OF_SWEPT_RUN["reached"], np.array([reached(solution) for solution in solutions])
    contacts = [_contacts(scene, solution) for scene, solution in zip(scenes, solutions, strict=True)]
    for variable in CONTACT:
        if selection.holds(variable.name):
            columns[variable.name] = variable, np.array([contact[variable.name] for contact in contacts])
    if selection.holds("skipped"):
        skipped = [json.dumps(solution.statistics.skipped, default=int) for solution in solutions]
        columns["skipped"] = OF_SWEPT_RUN["skipped"], np.array(skipped)
    if selection.holds("scene"):
        inputs = np.empty(
            len(scenes), dtype=object
        )  # in an array of text every entry is as long as the longest
        inputs[:] = [json.dumps(scene.to_dict(), allow_nan=False) for scene in scenes]
        columns["scene"] = OF_SWEPT_RUN["scene"], inputs
    return columns


def dimension_names(keys: Sequence[str] | Mapping[str, Any]) -> dict[str, str]:
    """Name the dimension of every swept key.

    The last part of the key (``coating.sam_fraction`` gives ``sam_fraction``), unless that is taken by
    another swept key or by a variable of the dataset; then the whole key with underscores (``roller_speed``), which has
    ``swept_`` before it where that is a variable, too (``swept_drive_torque``). ``sam_fraction``, which labels runs, is
    ``coating.sam_fraction`` alone: that of one mesh of a train is ``meshes_second_coating_sam_fraction``.

    Parameters
    ----------
    keys : sequence of str
        Dotted keys of the scene.

    Returns
    -------
    dict of str to str
        Key to dimension, in the given order.
    """
    last = [key.rpartition(".")[2] for key in keys]
    names = {}
    for key, short in zip(keys, last, strict=True):
        # An index in a list is no name.
        taken = last.count(short) > 1 or short in _RESERVED or short.isdecimal()
        whole = key.replace(".", "_")
        whole = f"swept_{whole}" if whole in _RESERVED else whole
        names[key] = whole if taken and key != COVERAGE_KEY else short
    return names


def _samples(solution: Solution, name: str) -> NDArray[np.float64]:
    """Return the samples of a column; a run that could not even start has none."""
    return solution.samples.get(name, np.empty(0))


def key_labels(key: str, dim: str, values: Sequence[Any]) -> xr.Variable:
    """Coordinate of a swept key: its numbers or words; lists are numbered and spelled out in `comment`."""
    attributes = _key_attributes(key)
    if all(isinstance(value, int | float) and not isinstance(value, bool) for value in values):
        return xr.Variable(dim, np.array(values), attributes)
    if all(isinstance(value, str) for value in values):
        return xr.Variable(dim, np.array(values, dtype=np.str_), attributes)
    attributes["comment"] = "numbers of the values " + json.dumps(list(values), allow_nan=False)
    return xr.Variable(dim, np.arange(len(values)), attributes)


def _key_attributes(key: str) -> dict[str, Any]:
    """CF attributes of a swept key, from the scene's own description of it."""
    if key == COVERAGE_KEY:
        return SAM_FRACTION.attributes
    try:
        info = describe_key(key)
    except SceneError:  # a whole table
        return {"long_name": key, "units": "1"}
    return {"long_name": f"{key}: {info.description}", "units": info.unit or "1"}


def statistics_attributes(statistics: Sequence[Statistics]) -> dict[str, Any]:
    """Solver statistics added up over the runs, as attributes."""
    totals: dict[str, Any] = {name: sum(getattr(counts, name) for counts in statistics) for name in _COUNTERS}
    totals["wall_time"] = math.fsum(counts.wall_time for counts in statistics)
    for name in ("backend", "method"):
        totals[name] = ", ".join(sorted({getattr(counts, name) for counts in statistics} - {""}))
    if len(statistics) == 1:
        totals["skipped"] = json.dumps(statistics[0].skipped, default=int)
    return totals
