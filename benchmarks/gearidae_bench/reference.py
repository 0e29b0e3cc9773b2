"""Reference solutions: an integrator that gearidae does not use, at a tolerance where a second one agrees.

The reference is Gauss-Legendre collocation of order twelve with a step's end at every event, every kink of the force
and every sample. Its error is stated as the largest difference to a run of its own at a tenth of the tolerance and
to Dormand and Prince's explicit eighth-order pair at the tightest tolerance that double precision bears.
"""

from __future__ import annotations

import hashlib
import json
import math
import os
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from platformdirs import user_cache_path

import gearidae
from gearidae.engine.integrate.start import set_rates
from gearidae.engine.model.state import ROLLER, U, V, W
from gearidae.engine.setup.build import make_problem
from gearidae.engine.setup.problem import Problem
from gearidae.errors import SolverError
from gearidae.scene.older_names import MODELS
from gearidae_bench.error import run_error
from gearidae_bench.loop import run_dop853, run_gauss
from gearidae_bench.roots import FAILED
from gearidae_bench.scenes import BenchScene

__all__ = [
    "METHOD",
    "TOLERANCE",
    "Provenance",
    "Reference",
    "alone",
    "end_of",
    "find_reference",
    "load_reference",
    "make_reference",
    "physical",
    "reference_folders",
    "save_reference",
    "scene_hash",
    "solve_with",
]

Floats = NDArray[np.float64]

METHOD = "Gauss-Legendre collocation, order 12, steps ending at events, kinks and samples"
CHECK = "the same at a tenth of the tolerance, and Dormand-Prince 8(5,3) at 1e-14"
TOLERANCE = 1e-12
CHECK_TOLERANCE = 1e-14
FOLDER_VARIABLE = "GEARIDAE_REFERENCES"


@dataclass(frozen=True, slots=True)
class Provenance:
    """Where a reference comes from.

    Attributes
    ----------
    scene, scene_hash : str
        Name, and from `scene_hash`.
    method, check : str
    tolerance : float
    own_error : float
        Largest difference to the checks, as `gearidae_bench.error.run_error` measures it.
    versions : dict
        Of gearidae, numpy and numba.
    date : str
        UTC, ISO 8601.
    """

    scene: str
    scene_hash: str
    method: str
    check: str
    tolerance: float
    own_error: float
    versions: dict[str, str]
    date: str


@dataclass(frozen=True, slots=True)
class Reference:
    """Reference samples of a scene.

    Attributes
    ----------
    time : ndarray, shape (n,)
        [s].
    speed : ndarray, shape (n,)
        Of the gear [rad/s], or of a roller [m/s].
    position : ndarray, shape (n,)
        Dynamic transmission error, or height of a roller [m].
    length : float
        The roughness [m], against which errors of position are judged.
    provenance : Provenance
    """

    time: Floats
    speed: Floats
    position: Floats
    length: float
    provenance: Provenance


_YOUNGER: Final[dict[str, dict[str, Any]]] = {
    "run": {
        "method": "auto",
        "stop": "time",
        "exposures": 0,
        "balance": True,
        "passages": True,
        "impacts": False,
        "asperity_events": True,
        "largest_step": 0.0,
    },
    "contact": {
        "seed": 0,
        "radius_spread": 0.0,
        "friction": 0.0,
        "friction_law": "coulomb",
        "shear_strength": 0.0,
    },
    "gears": dict.fromkeys(
        (
            "hub_friction",
            "pinion_hub_radius",
            "gear_hub_radius",
            "pinion_hub_clearance",
            "pinion_hub_adhesion",
            "gear_hub_adhesion",
            "pinion_axial_load",
            "gear_axial_load",
            "pinion_dimple_radius",
            "gear_dimple_radius",
            "hub_friction_rise",
            "pinion_spring",
            "gear_spring",
            "pinion_spring_damping",
            "gear_spring_damping",
            "pinion_spring_play",
            "gear_spring_play",
        ),
        0.0,
    ),
    "mesh": {
        "radius_force": False,
        "film_damping": 0.0,
        "film_gap": 0.0,
        "pitch_error_rms": 0.0,
        "pitch_error_seed": 0,
    },
    "initial": {"rest_time": 0.0},
    "surface": {
        "provenance": "",
        "hamaker": 0.0,
        "contact_angle": 0.0,
        "bridged": 1.0,
        "temperature": 298.15,
    },
    "drive": {"speed_gain": 0.0, "orientation": 0.0, "pin_radius": 0.0},
    "load": {"viscous": 0.0},
    "coating": {"pairing": "patches", "thickness": 0.0, "hamaker": 0.0, "contact_angle": math.radians(110.0)},
}
"""Keys that the shipped references are older than, with the values that change nothing."""


def scene_hash(bench: BenchScene) -> str:
    """SHA-256 of what is solved: the scene, and its scaled accelerations at some gaps.

    Those are rounded to six digits, so that another machine's last bits do not matter, but a change of the force law
    or of the scaling does.
    """
    problem = make_problem(bench.scene)
    solved = bench.scene.to_dict()
    if bench.scene.contact.asperity != "maugis":  # no other law has a range
        del solved["surface"]["interaction_range"]
    if bench.scene.initial is not None:  # a length, in whichever way it is written
        solved["initial"]["gap"] = float(bench.scene.initial.gap)
    contact = solved["contact"]  # in the names of the shipped references
    named = contact.pop("bodies"), contact.pop("roughness")
    contact["model"] = next(model for model, names in MODELS.items() if names == named)
    for table, defaults in _YOUNGER.items():
        for key, default in defaults.items():
            if solved.get(table, {}).get(key) == default:
                del solved[table][key]
    digest = hashlib.sha256(json.dumps(solved, sort_keys=True, default=str).encode())
    for gap in (-2.0, -1.0, 0.0, 1.0, 2.0, 3.0):
        slopes = np.zeros_like(problem.start)
        set_rates(problem.model, 0.0, _pressed(problem, gap), slopes)
        if bench.scene.roller is not None:  # of the height, as the shipped references have it
            slopes = np.concatenate([-slopes[:2], slopes[4:]])
        digest.update(",".join(f"{x:.6e}" for x in slopes).encode())
    return digest.hexdigest()


def _pressed(problem: Problem, gap: float) -> Floats:
    """Start state, moved so that the drive flank's gap is `gap` roughnesses."""
    y, s = problem.start.copy(), problem.model.scene
    y[U] = s.clearance[0] - gap
    return y


def end_of(problem: Problem) -> float:
    """End of a problem's run, over tau."""
    return float(problem.model.scene.end)


def alone(problem: Problem, *kept: str) -> Problem:
    """Let a problem be run without observers, like a peer that has none, but for those of the names `kept`."""
    followed = problem.model.scene.follow
    for name in followed.dtype.names:
        if name not in kept:
            followed[name] = 0
    return problem


def physical(problem: Problem, states: Floats) -> tuple[Floats, Floats]:
    """Speed [rad/s, or m/s of a roller] and position [m] of scaled states, shape (n, states)."""
    s = problem.model.scene
    length = float(s.length_unit)
    unit = length / problem.time_unit
    if s.kind == ROLLER:
        return -states[:, V] * unit, -states[:, U] * length
    return states[:, W] * unit / float(s.gear_radius), states[:, U] * length


def solve_with(bench: BenchScene, method: str, tolerance: float) -> tuple[Floats, Floats, Floats]:
    """Solve a scene by a method of reference.

    Parameters
    ----------
    bench : BenchScene
    method : {"gauss", "dop853"}
    tolerance : float

    Returns
    -------
    time, speed, position : ndarray, shape (n,)
        As in `Reference`.

    Raises
    ------
    SolverError
        If the method fails.
    """
    problem = alone(make_problem(bench.scene))
    m, end = problem.model, end_of(problem)
    times = np.linspace(0.0, end, bench.scene.run.sample_count)
    y, states = problem.start.copy(), np.zeros((times.size, problem.start.size))
    counts = np.zeros(4, np.int64)
    if method == "gauss":
        run_gauss(m, y, end, times, states, problem.tolerance_scale, tolerance, counts)
    else:
        run_dop853(m, y, end, times, states, tolerance * problem.tolerance_scale, True, counts, np.zeros(2))
    if counts[FAILED] or not np.isfinite(states).all():
        raise SolverError(
            f"no reference for {bench.name}: {method} failed",
            time=0.0,
            state={},
            last_event="",
            advice="loosen the tolerance",
        )
    speed, position = physical(problem, states)
    return times * problem.time_unit, speed, position


def make_reference(bench: BenchScene) -> Reference:
    """Solve a scene for reference, and check it.

    Raises
    ------
    SolverError
        If a method fails.
    """
    time, speed, position = solve_with(bench, "gauss", TOLERANCE)
    length = bench.scene.surface.roughness
    checks = [solve_with(bench, "gauss", 0.1 * TOLERANCE), solve_with(bench, "dop853", CHECK_TOLERANCE)]
    own_error = max(run_error(speed, position, s, p, length) for _, s, p in checks)
    versions = {"gearidae": gearidae.__version__, **{name: version(name) for name in ("numpy", "numba")}}
    date = datetime.now(UTC).isoformat(timespec="seconds")
    provenance = Provenance(
        bench.name, scene_hash(bench), METHOD, CHECK, TOLERANCE, float(own_error), versions, date
    )
    return Reference(time, speed, position, length, provenance)


def save_reference(reference: Reference, folder: Path) -> Path:
    """Write a reference as ``NAME.npz`` into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{reference.provenance.scene}.npz"
    np.savez_compressed(
        path,
        time=reference.time,
        speed=reference.speed,
        position=reference.position,
        length=reference.length,
        provenance=json.dumps(asdict(reference.provenance)),
    )
    return path


def load_reference(path: Path) -> Reference:
    """Read what `save_reference` wrote."""
    with np.load(path, allow_pickle=False) as stored:
        return Reference(
            stored["time"],
            stored["speed"],
            stored["position"],
            float(stored["length"]),
            Provenance(**json.loads(str(stored["provenance"]))),
        )


def reference_folders() -> list[Path]:
    """Where references are looked for: the source tree's own, then the user's cache, which is also written to.

    ``GEARIDAE_REFERENCES`` names a folder to use in their place.
    """
    if chosen := os.environ.get(FOLDER_VARIABLE):
        return [Path(chosen)]
    shipped = Path(__file__).parents[1] / "references"
    return [*([shipped] if shipped.is_dir() else []), user_cache_path("gearidae") / "references"]


def find_reference(bench: BenchScene, folders: list[Path] | None = None) -> Reference:
    """Take a scene's reference from where it is kept, or make and keep it.

    Parameters
    ----------
    bench : BenchScene
    folders : list of Path, optional
        Where to look; the last one is written to. By default `reference_folders`.

    Returns
    -------
    Reference
        Of exactly this scene: a stored one whose scene hash differs is passed over.
    """
    places = reference_folders() if folders is None else folders
    wanted = scene_hash(bench)
    for folder in places:
        path = folder / f"{bench.name}.npz"
        if path.is_file():
            reference = load_reference(path)
            if reference.provenance.scene_hash == wanted:
                return reference
    reference = make_reference(bench)
    save_reference(reference, places[-1])
    return reference
