"""From the engine's solution of a train to one labelled dataset."""

from __future__ import annotations

import json
from collections.abc import Hashable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from gearidae.archive.dataset import end_time, statistics_attributes
from gearidae.archive.end_state import end_state_attributes
from gearidae.archive.output_selection import EVERYTHING, OutputSelection
from gearidae.archive.provenance import provenance
from gearidae.archive.totals import standstills_as_text
from gearidae.archive.train.variables import (
    COORDINATES,
    EFFICIENCIES,
    ENERGY,
    EVENT_PLACES,
    MESH_TOTALS,
    OF_JUDGED,
    REST_LIST,
    SHAFT_TOTALS,
    TRAIN_SAMPLES,
    TWO_SHAFTS,
    left_out,
)
from gearidae.archive.train.work import efficiencies
from gearidae.archive.variables import (
    ENERGY_TOTALS,
    EVENTS,
    EXTREMES,
    OF_SWEPT_RUN,
    POPULATION_EVENTS,
    SAMPLES,
    STANDSTILL_LIST,
    TIME,
    run_label,
)
from gearidae.populations.flanks import flanks_digest, flanks_of
from gearidae.records import Extremes, Words
from gearidae.scene.judged import judged_mesh, judged_shaft

if TYPE_CHECKING:
    from gearidae.records.train_results import TrainSolution
    from gearidae.scene import TrainScene
    from gearidae.scene.train import Train


def train_dataset(
    scene: TrainScene,
    solution: TrainSolution,
    selection: OutputSelection = EVERYTHING,
    *,
    verdict: Words | None = None,
) -> xr.Dataset:
    """Label one run of a train.

    Parameters
    ----------
    scene : Scene
        The scene exactly as it was run.
    solution : TrainSolution
        Result of the engine, judged.
    selection : OutputSelection, optional
        Which variables the dataset has; by default all.
    verdict : ndarray of 8-byte words, optional
        What runs that go on from this one have to know for their verdicts.

    Returns
    -------
    xarray.Dataset
        Samples along ``shaft``, ``mesh`` and ``time``; those of the two shafts that a pair has, ``gear_`` for the
        judged one and ``pinion_`` for that of the drive, along ``time``; totals along ``shaft`` and ``mesh``; energies
        and extremes of the judged shaft without a dimension; events with their mesh and shaft. Everything in SI units.
    """
    extremes = solution.extremes or Extremes()
    absent = left_out(scene)
    sampled = [name for name in TRAIN_SAMPLES if name in solution.samples and name not in absent]
    variables: dict[Hashable, Any] = {
        name: (TRAIN_SAMPLES[name].dims, solution.samples[name], TRAIN_SAMPLES[name].attributes)
        for name in sampled
    }
    variables |= _two_shafts(scene, solution, sampled)
    variables |= _events(scene, solution)
    for catalogue, totals in ((SHAFT_TOTALS, solution.shaft_totals), (MESH_TOTALS, solution.mesh_totals)):
        for name, variable in catalogue.items():
            values = np.asarray(totals[name]).astype(variable.dtype)
            variables[name] = (variable.dims, values, variable.attributes)
    for name, variable in ENERGY.items():
        variables[name] = ((), solution.energy[name], variable.attributes)
    for name, values in efficiencies(scene, solution).items():
        known = EFFICIENCIES.get(name, ENERGY_TOTALS.get(name))
        assert known is not None
        variables[name] = (known.dims, values, known.attributes)
    for name in OF_JUDGED:
        variables[name] = ((), np.asarray(extremes[name], EXTREMES[name].dtype), EXTREMES[name].attributes)
    variables[STANDSTILL_LIST.name] = ((), standstills_as_text(extremes), STANDSTILL_LIST.attributes)
    variables[REST_LIST.name] = ((), _rests(solution), REST_LIST.attributes)
    variables["reached"] = ((), solution.reached, OF_SWEPT_RUN["reached"].attributes)
    return xr.Dataset(
        {
            name: entry
            for name, entry in variables.items()
            if name not in absent and selection.holds(str(name))
        },
        coords={
            "time": ("time", solution.time, TIME.attributes),
            **run_label(scene),
            **coordinates(scene.train, judged_shaft(scene)),
        },
        attrs={
            **provenance(scene, f"simulated {solution.reached:g} s"),
            "status": solution.status,
            "message": solution.message,
            **statistics_attributes([solution.statistics]),
            "contact_bodies": "rigid",
            "contact_bodies_reason": (
                "auto stays rigid: of several meshes" if scene.contact.bodies == "auto" else ""
            ),
            "contact_roughness": scene.contact.roughness,
            **_digests(scene),
            "judged_shaft": scene.train.shafts[judged_shaft(scene)].name,
            "judged_mesh": scene.train.meshes[judged_mesh(scene)].name,
            "drive_shaft": scene.train.shafts[scene.train.drive].name,
            **({"held_by": ", ".join(solution.held_by)} if solution.held_by else {}),
            **end_state_attributes(solution.start, solution.checkpoint, verdict),
            "t_end": end_time(scene, solution),
        },
    )


def coordinates(train: Train, judged: int) -> dict[str, Any]:
    """Label the shafts and meshes of a train, of which the shaft of a number is judged."""
    values: dict[str, list[Any]] = {
        "shaft": [shaft.name for shaft in train.shafts],
        "mesh": [mesh.name for mesh in train.meshes],
        "mesh_driver": [mesh.driver for mesh in train.meshes],
        "mesh_driven": [mesh.driven for mesh in train.meshes],
        "mesh_ratio": [float(mesh.ratio) for mesh in train.meshes],
        "shaft_sense": [shaft.sense for shaft in train.shafts],
        "shaft_ratio": [float(shaft.ratio / train.shafts[judged].ratio) for shaft in train.shafts],
    }
    return {
        name: (variable.dims, np.array(values[name], dtype=variable.dtype), variable.attributes)
        for name, variable in COORDINATES.items()
    }


def _digests(scene: TrainScene) -> dict[str, str]:
    """Digests of the discrete asperities of all meshes, in their order; see `flanks_digest`."""
    if not scene.contact.is_discrete:
        return {}
    names = (mesh.name for mesh in scene.train.meshes)
    return {"asperities_sha256": " ".join(flanks_digest(flanks_of(scene.pair(name))) for name in names)}


def _two_shafts(scene: TrainScene, solution: TrainSolution, sampled: Sequence[str]) -> dict[Hashable, Any]:
    """Samples by the names that a pair has: of the judged shaft, and of the drive's."""
    numbers = {"gear": judged_shaft(scene), "pinion": scene.train.drive}
    return {
        name: (("time",), solution.samples[source][numbers[name.partition("_")[0]]], SAMPLES[name].attributes)
        for name, source in TWO_SHAFTS.items()
        if source in sampled
    }


def _events(scene: TrainScene, solution: TrainSolution) -> dict[Hashable, Any]:
    """Events, with the mesh and the shaft of each."""
    events = solution.events
    count = len(events["time"])
    columns = {f"event_{name}": values for name, values in events.items()}
    columns["event_sam_fraction"] = np.full(count, scene.coating.sam_fraction)
    teeth = np.array([mesh.geometry.pinion_teeth for mesh in scene.train.meshes])
    columns["event_tooth"] = np.where(events["mesh"] >= 0, events["pair"] % teeth[events["mesh"]], -1)
    return {
        name: (("event",), np.asarray(columns[name]).astype(variable.dtype), variable.attributes)
        for name, variable in {**EVENTS, **POPULATION_EVENTS, **EVENT_PLACES}.items()
    }


def _rests(solution: TrainSolution) -> str:
    rests = solution.rests
    rows = zip(rests["shaft"], rests["begin"], rests["end"], strict=True)
    return json.dumps([[solution.shafts[int(shaft)], float(begin), float(end)] for shaft, begin, end in rows])
