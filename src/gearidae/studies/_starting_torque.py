"""Starting torque: the smallest drive torque that keeps the gear turning against adhesion."""

from __future__ import annotations

import logging
import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeAlias, Unpack

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from gearidae.archive.output_selection import TOTALS
from gearidae.archive.provenance import provenance
from gearidae.archive.variables import COVERAGE_KEY
from gearidae.errors import SceneError
from gearidae.runs.execution import Execution, RunOptions, prepared
from gearidae.runs.release import holding_forces
from gearidae.runs.run_cache import RunCache
from gearidae.runs.running import FAILS, SomeScene, failure_of, solve_any_to_end, unfinished
from gearidae.scene import GearScene, TrainScene, is_long_train, require_gears, require_meshes
from gearidae.scene.carried import numbers_of
from gearidae.scene.joints import ages
from gearidae.scene.judged import judged_shaft
from gearidae.scene.quantity import number, switch, whole
from gearidae.studies._starting_seeds import QUANTILES, quantiles, starting_torques
from gearidae.studies.bracket import STRIDE, bracket, crossing, next_value
from gearidae.studies.declared.starting_torque import (
    GEAR_RESTS,
    GEARS,
    RESTS,
    STUDY,
    TEETH,
    coordinate,
)
from gearidae.studies.requirements import require_constant
from gearidae.studies.specimens import gears_of, gears_text, seed_of, seeds_that_draw
from gearidae.studies.starting_parts import PARTS, Starting, parts_of
from gearidae.studies.starting_ramp import Pitch, nothing_followed, pitch_of
from gearidae.studies.train_starting import (
    part_names,
    pitch_of_train,
    require_no_loop,
    require_startable,
    static_start,
    train_parts,
)

if TYPE_CHECKING:
    from gearidae.arrays import Floats
    from gearidae.records.train_results import AnySolution
    from gearidae.scene import Scene
    from gearidae.studies.study import Study

log = logging.getLogger(__name__)
AnyGears: TypeAlias = GearScene | TrainScene

_FRACTIONS = np.round(np.linspace(1.0, 0.4, 13), 4)
_LOWEST = 1e-3
"""Default lower end of the search, as a part of the scene's torque."""
_PATIENCE = 3.0
"""A gear that has not arrived after this many times the time it would take without adhesion has stuck."""


def static_starting_torque(scene: Scene, *, impacts: int = 3, lowest: float | None = None) -> float:
    """Drive torque that pulls the leaving tooth off at every mesh exit, without help from inertia.

    Parameters
    ----------
    scene : Scene
        With gears, or a train without loops.
    impacts : int, optional
        Mesh exits that have to be passed, of each mesh of a train. A worn contact is pressed deeper
        by each one, and needs more torque the more there are.
    lowest : float, optional
        Torque below which nothing is looked for, beyond what dry resistance and joints take [N m]; by default a
        thousandth of the scene's.

    Returns
    -------
    float
        Torque on the pinion [N m]: the M10 at which ``M10/R1 = max(-s' W_l) + M20/R2`` holds at the worst exit, see
        `gearidae.runs.release`; with friction, ``M10 = i (R2 max(-s' W_l) + M20 + m2) + m1`` of
        `gearidae.studies.starting_parts`, friction of the flanks being that under the scene's own torque. Of a train on
        the shaft of the drive, see `gearidae.runs.train_release`. What dry resistance and joints take (0 without
        any) if adhesion does not hold the gear even at the lowest torque; infinite if it does at any.

    Raises
    ------
    SceneError
        If the scene has no gears, or a setting is not allowed.
    """
    if is_long_train(scene):
        train = require_no_loop(_require_train(scene, impacts))
        return static_start(train, impacts, _lowest(scene, lowest))[0]
    scene = _require_pair(scene, impacts)
    lowest, whole, geometry = _lowest(scene, lowest), Starting(scene), scene.geometry
    dry, lever = whole.torque(), geometry.base_radius_gear * whole.ratio
    carried = dry - whole.joint_torques[0]  # by the teeth

    def surplus(torque: float) -> float:
        force = (carried + torque) / geometry.base_radius_pinion
        return torque - max(holding_forces(scene, force, impacts)) * lever

    return dry + crossing(surplus, lowest)


def starting_torque(
    scene: Scene,
    sam_fraction: ArrayLike | None = None,
    *,
    impacts: int = 3,
    lowest: float | None = None,
    simulated: bool = True,
    tolerance: float = 0.1,
    seeds: int | None = None,
    rest_time: ArrayLike | None = None,
    **options: Unpack[RunOptions],
) -> xr.Dataset:
    """Smallest drive torque that takes the gear through the mesh, against SAM fraction; of a population, by its gears.

    Parameters
    ----------
    scene : Scene
        With gears, or a train. Its constant drive torque is replaced, a schedule of the drive taken away, its initial
        speed set to zero.
    sam_fraction : array_like or 'own', optional
        Fractions of the coating; by default 13 from 1 to 0.4. ``own`` stands for the scene's own coating as it is, and
        is the default of a population.
    impacts : int, optional
        Pitches to be turned, each with its mesh exit.
    lowest : float, optional
        Lowest torque to try [N m]; by default 0.001 of the drive's own.
    simulated : bool, optional
        Whether to simulate too.
    tolerance : float, optional
        Relative width at which the search among simulated torques ends, 0.001 .. 1.
    seeds : int, optional
        Number of gears of one design, with seeds of discrete asperities, of errors of teeth
        (``mesh.pitch_error_rms``), or of both, numbered from the scene's own on; 20 by default for a population, of
        which `impacts`, `lowest`, `simulated` and `tolerance` are no settings.
    rest_time : array_like, optional
        Times at rest before the start, in seconds or with a unit, in place of ``initial.rest_time``: of hubs or a pin
        whose friction ages. Not with other fractions of the coating.
    **options
        ``executor``, ``jobs``, ``backend``, ``progress``, ``archive``, ``overwrite`` and ``resume``, as for `sweep`.
        With ``archive``, finished runs are kept beside it until it is written.

    Returns
    -------
    Dataset, dims (sam_fraction)
        ``static_torque``: without inertia, see `static_starting_torque`. ``simulated_torque``: a run from rest turns
        the gear by `impacts` pitches at this torque and not at ``simulated_stuck``, which is smaller by `tolerance` or
        less. Both are what dry resistance and joints take where adhesion does not hold even at the lowest torque, and
        NaN without `simulated`. ``parts`` divides the static torque along ``part``: dry resistance, adhesion of teeth,
        friction of flanks, hubs, pin, axial loads; of a train dry resistance, ``adhesion of MESH`` for each mesh, ``hub
        of SHAFT`` for each shaft. A train with loops has neither of these: they are NaN. All in N m on the pinion, of a
        train on the shaft of the drive; a run has turned a train when each mesh has come so many pitches. The scene's
        own constant torque is the attribute ``drive_torque``; ``message`` names the run that failed.
        With `rest_time` the same, dims (rest_time).

        Of smooth contacts with `seeds`, dims (sam_fraction, seed): ``starting_torque``, the simulated one of each gear
        (NaN if none starts it), and ``stuck_torque``, at which it sticks. Along ``sam_fraction`` the
        ``quantiles`` (10, 50 and 90 %), ``not_started``, the share that no torque has started, ``chance``, the share
        that the drive's own constant torque starts, and ``static_torque``, of teeth without errors.

        Of a population, dims (sam_fraction, seed): ``starting_torque``, at the last moment of rest before the gear has
        turned one pitch, while the torque rises linearly; its ``parts`` along ``part``; ``starts``, whether the drive's
        own constant torque, there at once, turns it so far; ``message`` of a run that failed. Along ``sam_fraction``
        ``quantiles`` (10, 50 and 90 %), ``not_started`` (the share that rests when the ramp ends at ``ramp_end``),
        ``chance`` (mean of ``starts``), the ``rate`` [N m/s] and ``median_change``, by which half of a rate has changed
        the median; the rate is halved until that is less than a tenth. ``damping`` is the scene's, or 3 % of the
        critical damping of an asperity without load.

    Raises
    ------
    SceneError
        If the scene has no gears, its load follows a schedule, or a setting is not allowed; if friction of no joint
        ages with `rest_time`.
    SolverError
        If no gear, or no coverage, could be followed. Otherwise what has failed is named in the log, and its torque is
        NaN.
    Interrupted
        On Ctrl-C.

    Notes
    -----
    The two differ: a gear that comes along has momentum, which helps it over the first exits, and its contact has been
    pressed by the first touch harder than by the torque, which makes the next ones harder.
    """
    scene = _require(scene, impacts)
    tolerance, simulated = number("tolerance", tolerance), switch("simulated", simulated)
    if not 0.001 <= tolerance <= 1.0:
        raise SceneError("tolerance", tolerance, "must lie in 0.001..1")
    if is_long_train(scene) and not simulated:
        require_no_loop(scene)
    base, execution = prepared(scene, options, trains=True)
    rests = None if rest_time is None else _rests(base, rest_time, sam_fraction)
    if rests is not None:
        points, scenes = rests, [base.replace({"initial.rest_time": time}) for time in rests]
    elif sam_fraction is None and (base.contact.is_discrete or is_long_train(base)):
        points, scenes = _coatings(base, "own")
    else:
        points, scenes = _coatings(base, sam_fraction)
    if base.contact.is_discrete:
        _refuse_settings(impacts=impacts, lowest=lowest, simulated=simulated, tolerance=tolerance)
        pairs = [require_gears(variant) for variant in scenes]
        return starting_torques(
            require_gears(base), GEARS if rests is None else GEAR_RESTS, points, pairs, seeds, execution
        )
    if seeds is not None:
        if rests is not None or not simulated:
            raise SceneError("seeds", seeds, "is for simulated torques over the coating: leave it out here")
        return _torques_of_gears(
            scene,
            require_meshes(base),
            (points, [require_meshes(variant) for variant in scenes]),
            seeds,
            _lowest(scene, lowest),
            impacts,
            tolerance,
            execution,
        )
    study, least = STUDY if rests is None else RESTS, _lowest(scene, lowest)

    def work(kept: RunCache | None) -> xr.Dataset:
        searches = [_searched(variant, impacts, least) for variant in scenes]
        if simulated:
            _search_all(searches, tolerance, execution, kept)
        return _dataset(scene, study, points, searches, simulated=simulated).assign_attrs(
            impacts=impacts, tolerance=tolerance
        )

    settings = [points, impacts, least, simulated, tolerance]
    return study.compute(
        execution, base, work, settings if rests is None else [RESTS.kind, *settings], origin=scene
    )


def _torques_of_gears(
    scene: Scene,
    base: AnyGears,
    coatings: tuple[list[float], list[AnyGears]],
    seeds: int,
    lowest: float,
    impacts: int,
    tolerance: float,
    execution: Execution,
) -> xr.Dataset:
    """Starting torques of gears that differ in the errors of their teeth, at each coverage."""
    gears, (points, scenes) = gears_of(base, seeds), coatings

    def work(kept: RunCache | None) -> xr.Dataset:
        alike = [_alike(variant) for variant in scenes]
        static = [
            static_start(variant, impacts, lowest)[0]
            if is_long_train(variant)
            else static_starting_torque(variant, impacts=impacts, lowest=lowest)
            for variant in alike
        ]
        searches = [
            _search_from(variant.replace(gear), impacts, lowest, torque)
            for variant, torque in zip(scenes, static, strict=True)
            for gear in gears
        ]
        _search_all(searches, tolerance, execution, kept)
        shape = (len(points), len(gears))
        turns, sticks = (
            np.reshape(column, shape) for column in zip(*[s.result for s in searches], strict=True)
        )
        below = np.stack([quantiles(row) for row in turns])
        followed = (~np.isnan(turns)).sum(axis=1)
        drive = base.drive.torque
        started = (turns <= drive).sum(axis=1) / followed
        values = {
            "starting_torque": np.where(np.isfinite(turns), turns, np.nan),
            "stuck_torque": sticks,
            "quantiles": np.where(np.isfinite(below), below, np.nan),
            "not_started": np.isinf(turns).sum(axis=1) / followed,
            "chance": started if drive > 0.0 else np.full(len(points), np.nan),
            "static_torque": np.array(static),
            "message": np.reshape([search.failure for search in searches], shape),
            "seed": np.array([seed_of(base.replace(gear)) for gear in gears]),
            "quantile": np.array(QUANTILES),
        }
        attributes = {
            **provenance(
                scene, "searched starting torques of gears", swept=(COVERAGE_KEY, *seeds_that_draw(base))
            ),
            "title": f"{scene.name}: starting torque of {gears_text(len(gears))}",
            "summary": "Smallest drive torques that keep gears of one design turning against adhesion.",
            "drive_torque": drive,
            "impacts": impacts,
            "tolerance": tolerance,
        }
        return TEETH.dataset(values, attributes).assign_coords(coordinate(TEETH, points))

    settings = [TEETH.kind, points, impacts, lowest, tolerance, seeds]
    return TEETH.compute(execution, base, work, settings, origin=scene)


def _alike(scene: AnyGears) -> AnyGears:
    """Return a scene whose teeth have no errors that are drawn."""
    own = [] if isinstance(scene, GearScene) else [*scene.meshes]
    return scene.replace(
        dict.fromkeys(("mesh.pitch_error_rms", *(f"meshes.{name}.pitch_error_rms" for name in own)), 0.0)
    )


def _search_from(scene: AnyGears, impacts: int, lowest: float, static: float) -> _Search:
    """Begin the search of one gear's torque at that of teeth alike."""
    pitch = pitch_of(scene) if isinstance(scene, GearScene) else pitch_of_train(scene)
    return _Search(scene, impacts, lowest, static, pitch)


def _rests(base: Scene, rest_time: ArrayLike, sam_fraction: ArrayLike | None) -> list[float]:
    """Read times at rest, and refuse what does not go with them."""
    if sam_fraction is not None and not (isinstance(sam_fraction, str) and sam_fraction == "own"):
        raise SceneError("sam_fraction", sam_fraction, "must be left out with rest_time: one of both varies")
    if not ages(base):
        allowed = "needs friction that ages: gears.hub_friction_rise or drive.pin_friction_rise"
        raise SceneError("rest_time", rest_time, allowed)
    try:
        times = numbers_of([rest_time] if isinstance(rest_time, str) else rest_time, "s")
    except ValueError as error:
        raise SceneError("rest_time", rest_time, str(error)) from None
    return [float(time) for time in np.atleast_1d(times)]


def _refuse_settings(**settings: Any) -> None:
    """Refuse settings that the starting torques of a population do not have."""
    usual = {"impacts": 3, "lowest": None, "simulated": True, "tolerance": 0.1}
    for name, value in settings.items():
        if value != usual[name]:
            raise SceneError(
                name, value, "is not for a population, whose gears each turn by one pitch: leave it out"
            )


def _coatings(base: SomeScene, sam_fraction: ArrayLike | None) -> tuple[list[float], list[SomeScene]]:
    """Fractions of the coating, and the scenes with them."""
    if isinstance(sam_fraction, str):
        if sam_fraction != "own":
            raise SceneError("sam_fraction", sam_fraction, "must be a list of numbers, or 'own'")
        return [float(np.mean(base.coating.fractions))], [base]
    try:
        fractions = np.atleast_1d(
            numbers_of(_FRACTIONS if sam_fraction is None else sam_fraction, "1")
        ).tolist()
    except (TypeError, ValueError) as error:
        raise SceneError(
            "sam_fraction", sam_fraction, f"must be a list of numbers, or 'own' ({error})"
        ) from None
    return fractions, [base.replace({"coating.sam_fraction": fraction}) for fraction in fractions]


def _dataset(
    scene: AnyGears, study: Study, points: Sequence[float], searches: Sequence[_Search], *, simulated: bool
) -> xr.Dataset:
    results = [search.result if simulated else (math.nan, math.nan) for search in searches]
    turns, sticks = map(np.array, zip(*results, strict=True))
    values = {
        "static_torque": np.array([search.static for search in searches]),
        "simulated_torque": turns,
        "simulated_stuck": sticks,
        "part": np.array(part_names(scene) if is_long_train(scene) else PARTS),
        "parts": np.array([search.parts for search in searches]),
        "message": np.array([search.failure for search in searches]),
    }
    key, against = ("initial.rest_time", "time at rest") if study is RESTS else (COVERAGE_KEY, "SAM fraction")
    attributes = {
        **provenance(scene, "searched the starting torque", swept=(key,)),
        "title": f"{scene.name}: starting torque",
        "summary": f"Smallest drive torque that keeps the gear turning against adhesion, against {against}.",
        "drive_torque": scene.drive.torque,
    }
    if is_long_train(scene):
        attributes["summary"] = (
            f"Smallest drive torque that takes a train through its mesh exits, against {against}."
        )
        attributes["drive_shaft"] = scene.train.shafts[scene.train.drive].name
    return study.dataset(values, attributes).assign_coords(coordinate(study, points))


@dataclass
class _Search:
    """Bracket of one fraction's torque on its way to be narrow; torques are beyond the dry resistance."""

    scene: AnyGears
    impacts: int
    lowest: float
    static: float
    pitch: Pitch
    parts: Floats = field(default_factory=lambda: np.empty(0))
    failure: str = ""
    turned: dict[float, bool] = field(default_factory=dict)

    def next_torque(self, tolerance: float) -> float | None:
        """Torque to try next; None when the bracket is narrow, there is nothing in reach, or a run has failed."""
        if self.failure or math.isinf(self.pitch.dry):
            return None
        guess = self.static - self.pitch.dry
        first = guess if self.lowest < guess < math.inf else self.lowest
        return next_value(self.turned, first, self.lowest, tolerance)

    @property
    def result(self) -> tuple[float, float]:
        """Smallest torque that turns and largest that sticks [N m]; alike if the gear turns at the lowest.

        NaN if a run has failed: the torque may lie on either side of it.
        """
        if self.failure:
            return math.nan, math.nan
        dry = self.pitch.dry
        if all(self.turned.values()):
            return dry, dry
        sticks, turns = bracket(self.turned)
        return (dry + turns, dry + sticks) if turns > 0.0 else (math.inf, dry + max(self.turned))


def _searched(scene: AnyGears, impacts: int, lowest: float) -> _Search:
    """Begin the search of a scene's torque at the static one."""
    if is_long_train(scene):
        static, held = static_start(scene, impacts, lowest)
        names = part_names(scene)
        parts = train_parts(scene, held) if math.isfinite(static) else np.full(len(names), math.nan)
        return _Search(scene, impacts, lowest, static, pitch_of_train(scene), parts)
    gears = require_gears(scene)
    static = static_starting_torque(gears, impacts=impacts, lowest=lowest)
    return _Search(gears, impacts, lowest, static, pitch_of(gears), parts_of(gears, static))


def _search_all(
    searches: Sequence[_Search], tolerance: float, execution: Execution, kept: RunCache | None
) -> None:
    """Narrow all brackets, the runs of each round side by side."""
    halvings = math.ceil(math.log2(math.log(STRIDE) / math.log1p(tolerance)))
    usual = len(searches) * (2 + max(halvings, 0))
    with execution.side_by_side(kept, usual, len(searches)) as compute:
        while True:
            wanted = [(search, search.next_torque(tolerance)) for search in searches]
            todo = [(search, torque) for search, torque in wanted if torque is not None]
            if not todo:
                return
            scenes = [_from_rest(search, torque) for search, torque in todo]
            solved = compute(_run_from_rest, scenes, _way(todo[0][0]))
            for (search, torque), (_, word) in zip(todo, solved, strict=True):
                search.turned[torque] = word == "turns"
                if failure := failure_of(word):
                    search.failure = failure
                    log.warning("one coverage has no simulated torque: %s", search.failure)
            if all(search.failure for search in searches):
                raise nothing_followed("coverage", searches[-1].failure)


def _way(search: _Search) -> float:
    """Angle through which the gear is to come [rad]."""
    return search.impacts * search.pitch.angle


def _from_rest(search: _Search, torque: float) -> AnyGears:
    """Return the scene of a run from rest at a torque beyond the dry resistance, with the time that it gets."""
    scene, way, pitch = search.scene, _way(search), search.pitch
    duration = math.sqrt(2.0 * way * pitch.inertia / (torque * pitch.ratio))
    if pitch.drag > 0.0:
        duration += way / math.sqrt(torque * pitch.ratio / pitch.drag)
    duration += way * pitch.viscous / (torque * pitch.ratio)
    others = ("schedule", "speed", "speed_gain")
    drive = {key: value for key, value in scene.to_dict()["drive"].items() if key not in others}
    return scene.replace(
        {
            "drive": {**drive, "torque": pitch.dry + torque},
            "initial.gear_speed": 0.0,
            "run.duration": _PATIENCE * duration,
            "run.samples": 101,
        }
    )


def _run_from_rest(scene: AnyGears, way: float, backend: str) -> tuple[AnySolution, str]:
    """Run a scene; ``turns`` if the gear comes that far, else ``sticks``; `FAILS` and a message if it fails."""
    solution = solve_any_to_end(scene, backend)
    if solution.status != "finished":
        coverage = 100.0 * float(np.mean(scene.coating.fractions))
        rest = f" after {scene.initial.rest_time:g} s of rest" if scene.initial.rest_time > 0.0 else ""
        words = f"the run of SAM {coverage:.4g} %{rest} at {scene.drive.torque:g} N m"
        return solution, f"{FAILS}{unfinished(solution, words)}"
    if isinstance(scene, TrainScene):
        angle = solution.samples["shaft_angle"][judged_shaft(scene)]
    else:
        angle = solution.samples["gear_angle"]
    return TOTALS.thinned(solution), "turns" if angle.max() - angle[0] >= way else "sticks"


def _lowest(scene: AnyGears, asked: float | None) -> float:
    lowest = _LOWEST * abs(scene.drive.torque) if asked is None else number("lowest", asked, "N m")
    if not 0.0 < lowest < math.inf:
        allowed = (
            "must be a positive torque; give the lowest to be tried (lowest=, --lowest) where the scene has no "
            "constant drive torque, as with drive.schedule"
        )
        raise SceneError("lowest", asked, allowed)
    return lowest


def _require(scene: Scene, impacts: int) -> AnyGears:
    return _require_train(scene, impacts) if is_long_train(scene) else _require_pair(scene, impacts)


def _require_pair(scene: Scene, impacts: int) -> GearScene:
    gears = require_gears(scene)
    _require_one_load(gears, impacts)
    return gears


def _require_train(scene: TrainScene, impacts: int) -> TrainScene:
    _require_one_load(scene, impacts)
    return require_startable(scene)


def _require_one_load(scene: Scene, impacts: int) -> None:
    require_constant(scene, "a starting torque", "it holds against one load", ("load",))
    whole("impacts", impacts, 1)
