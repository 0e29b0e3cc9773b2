"""Life of a coating: coverage against passages, by cycle jump from windows at a frozen coverage.

A window is some mesh cycles at a coverage that does not change; what its flanks are exposed to
(`gearidae.engine.observers.exposures.accumulation`) gives, by a loss law, the rate at which coverage is lost. The rates
are integrated over passages (`gearidae.wear.lives.cycle_jump`) until the gear sticks in a window, a coverage or a
number of passages is reached. Passages in which the coverage changes too fast for that are simulated cycle by cycle
(`gearidae.wear.lives.rates`).
"""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Final, Literal, Unpack

import xarray as xr

from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.progress import sweep_progress
from gearidae.runs.execution import RunOptions, prepared
from gearidae.runs.run_cache import RunCache
from gearidae.scene import require_gears
from gearidae.scene.quantity import whole
from gearidae.studies.requirements import require_constant
from gearidae.wear import LossLaw
from gearidae.wear.declared.life import STUDY
from gearidae.wear.lives.coverage import coverage_of
from gearidae.wear.lives.cycle_jump import Life, jump
from gearidae.wear.lives.life_dataset import life_dataset
from gearidae.wear.lives.rates import MOST_STATES, DirectCycles, LifeSamples, StateResult
from gearidae.wear.lives.window import Cycles, window_scene

if TYPE_CHECKING:
    from gearidae.scene import GearScene, Scene

_PLACES: Final = 8


def life(
    scene: Scene,
    law: LossLaw,
    *,
    passages: float = 1e12,
    fraction: float = 0.0,
    resolved: Literal["uniform", "place", "tooth"] = "uniform",
    places: int = _PLACES,
    cycles: int = 19,
    settle: int = 6,
    starts: int = 2,
    tolerance: float = 3e-3,
    bracket: float = 0.01,
    frequency: bool = True,
    **options: Unpack[RunOptions],
) -> xr.Dataset:
    """Coverage of the flanks against the passages of their teeth, until the gear sticks.

    Parameters
    ----------
    scene : Scene
        With gears that turn forward, torques without a schedule, and the coverage at the beginning.
    law : LossLaw
        How coverage is lost, from `gearidae.wear`.
    passages : float, optional
        Passages of each tooth of the pinion after which the life ends in any case.
    fraction : float, optional
        Mean coverage at which it ends. At 0 it ends where no more is left than the absolute error of a jump, a tenth of
        `tolerance`: a loss in proportion to what is left would never end.
    resolved : {"uniform", "place", "tooth"}, optional
        Whether coverage is the same everywhere, or followed along the flank, or by tooth and place.
    places : int, optional
        Places along the flank.
    cycles, settle : int, optional
        Mesh cycles of a block, and those before the first. Blocks follow each other until the contacts that they make
        no longer drift by more than `tolerance`, at most eight; the last counts, or the last two where they fluctuate.
        With ``resolved = "tooth"`` a block is rounded up to whole turns of the pinion.
    starts : int, optional
        Windows for each state, from as many phases of mesh; their rates are averaged, and the gear sticks if it does in
        one of them. They run side by side.
    tolerance : float, optional
        Relative tolerance of each jump, and of the drift of the rates.
    bracket : float, optional
        Relative width to which the passages to sticking are narrowed.
    frequency : bool, optional
        Whether to find the characteristic frequency along the life, which takes a sampled run for each step.
    **options
        ``executor``, ``jobs``, ``backend``, ``progress``, ``archive``, ``overwrite`` and ``resume``, as for `sweep`.
        With ``archive``, finished windows are kept beside it until it is written.

    Returns
    -------
    Dataset
        Along ``passages`` (the steps of the integration): ``coverage``, ``coverage_loss`` (in a passage),
        ``verdict``, ``mean_gear_speed``, ``min_gear_speed``, ``characteristic_frequency``, exposures of a passage and
        their sums, and with ``resolved`` ``coverage_by_place``. Attributes: ``ending`` (sticks, coverage or passages),
        ``passages_to_sticking`` with its bracket, ``windows``, ``passages_simulated`` and ``passages_jumped``,
        ``mesh_cycles_direct`` (those that were simulated one by one).

    Raises
    ------
    SceneError
        If the scene or a setting is not allowed.
    SolverError
        If a window could not be finished, or more windows would be needed than are allowed.
    Interrupted
        On Ctrl-C, with the life so far as its ``dataset``, whose ``ending`` is interrupted. It is written to `archive`,
        beside which finished windows are kept.

    Notes
    -----
    Rates are those of the drive flank. A window begins where the scene does, and not with the state that an earlier
    one has left. Where a jump would be shorter than the cycles of its windows, the cycles are simulated one by one
    instead, each with the coverage and the motion that the one before has left; these are not kept, and done again by a
    life that is resumed.

    Examples
    --------
    >>> import gearidae as gd
    >>> scene = gd.preset("teodorescu2009_low_speed")
    >>> law = gd.wear.loss_law("adhesion_work", energy="10 J/m^2")
    >>> found = gd.studies.life(scene, law)  # doctest: +SKIP
    >>> found.attrs["passages_to_sticking"]  # doctest: +SKIP
    """
    scene = require_gears(scene)
    base, execution = prepared(scene, options, samples="off")
    count = _check(
        base, law, passages, fraction, (places, cycles, settle, starts), (tolerance, bracket), resolved
    )
    coverage = coverage_of(base, resolved, places)
    length = Cycles(settle, count, tolerance)
    window = window_scene(base, length, places)
    history = Life()
    samples = LifeSamples(window, coverage, law, length, starts, execution.backend)
    direct = DirectCycles(samples)

    def work(kept: RunCache | None) -> xr.Dataset:
        samples.kept = kept
        with (
            sweep_progress(execution.progress, MOST_STATES, at_most=True) as samples.report,
            execution.computing(starts) as samples.executor,
        ):
            jump(
                samples.rate,
                coverage.start,
                passages=passages,
                tolerance=tolerance,
                least=fraction,
                bracket=bracket,
                direct=direct,
                life=history,
            )
            return _dataset(scene, direct, history, frequency=frequency)

    settings = [law.describe(), passages, fraction, resolved, places, cycles, settle, starts]
    return STUDY.compute(
        execution,
        window,
        work,
        [*settings, tolerance, bracket, frequency],
        origin=scene,
        so_far=lambda: _so_far(scene, direct, history),
        prepared=lambda ds: ds,
    )


def _dataset(scene: GearScene, direct: DirectCycles, history: Life, *, frequency: bool) -> xr.Dataset:
    """Make the dataset of a life, with the state at which it sticks as its last if there is one."""
    samples = direct.samples
    seen = [_seen(direct, state) for state in history.states]
    ds = life_dataset(scene, samples.coverage, history, seen, frequency=frequency)
    simulated = samples.mesh_cycles + direct.run
    teeth = scene.gears.pinion_teeth
    whole = history.passages[-1] * teeth
    ends = {} if math.isnan(history.sticks_by) else {"passages_to_sticking": history.sticks_by}
    return ds.assign_attrs(
        {
            "law": json.dumps(samples.law.describe()),
            "law_source": samples.law.source,
            "ending": history.ending,
            **ends,
            "states": len(samples.seen),
            "windows": samples.run,
            "mesh_cycles_simulated": simulated,
            "mesh_cycles_direct": direct.run,
            "mesh_cycles_jumped": max(whole - simulated, 0.0),
            "passages_simulated": simulated / teeth,
            "passages_jumped": max(whole - simulated, 0.0) / teeth,
        }
    )


def _seen(direct: DirectCycles, state: Floats) -> StateResult:
    """What the windows of a state have shown, or its cycle where the coverage was followed cycle by cycle."""
    cycle = direct.seen.get(state.tobytes())
    if cycle is not None and not direct.samples.turns(state):
        return cycle
    return direct.samples.of(state)


def _so_far(scene: GearScene, direct: DirectCycles, history: Life) -> xr.Dataset:
    """Make the dataset of a life that was cut off: of its steps that have been run, without frequencies."""
    done = [
        number
        for number, state in enumerate(history.states)
        if direct.samples.has(state) or state.tobytes() in direct.seen
    ]
    if not done:
        return xr.Dataset()
    kept = Life(
        [history.passages[n] for n in done],
        [history.states[n] for n in done],
        history.ending,
        history.sticks_by,
    )
    return _dataset(scene, direct, kept, frequency=False)


def _check(
    scene: GearScene,
    law: LossLaw,
    passages: float,
    fraction: float,
    numbers: tuple[int, int, int, int],
    tolerances: tuple[float, float],
    resolved: str,
) -> int:
    """Refuse what is not allowed; return the mesh cycles of a window that count."""
    require_constant(scene, "a life", "its windows stand for all passages")
    if not isinstance(law, LossLaw):
        raise SceneError("law", type(law).__name__, "must be a loss law, see gearidae.wear.loss_law")
    law.check(scene)
    if not 0.0 < passages < math.inf:
        raise SceneError("passages", passages, "must be positive")
    if not 0.0 <= fraction < 1.0:
        raise SceneError("fraction", fraction, "must lie in 0..1, and be below 1")
    for name, value, least in zip(
        ("places", "cycles", "settle", "starts"), numbers, (2, 1, 0, 1), strict=True
    ):
        whole(name, value, least, 1000)
    for name, size in zip(("tolerance", "bracket"), tolerances, strict=True):
        if not 1e-8 <= size <= 0.1:
            raise SceneError(name, size, "must lie in 1e-08..0.1")
    cycles = numbers[1]
    teeth = scene.gears.pinion_teeth
    return math.ceil(cycles / teeth) * teeth if resolved == "tooth" else cycles
