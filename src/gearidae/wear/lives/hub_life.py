"""Life of hubs and pin by Archard's law, from what they slide in a turn of the pinion, of a train the drive's shaft."""

from __future__ import annotations

import logging
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final, NamedTuple, Unpack

import numpy as np
import xarray as xr

from gearidae.archive.provenance import provenance
from gearidae.arrays import Floats
from gearidae.errors import SceneError, SolverError
from gearidae.runs.execution import RunOptions, prepared
from gearidae.runs.run_cache import RunCache
from gearidae.runs.running import failure_of
from gearidae.scene import TrainScene, require_meshes
from gearidae.scene.joints import Joint, joints
from gearidae.scene.quantity import Quantity, switch, whole
from gearidae.wear.declared.hub_life import FITTED, QUANTILES, STUDY
from gearidae.wear.lives.hub_turns import (
    Slid,
    Turns,
    names_of_sums,
    run_turns,
    settling_scene,
    shaft_of_turns,
)
from gearidae.wear.lives.hub_wear import (
    Threshold,
    drawn_factors,
    first_shares,
    joint_area,
    lognormal_quantile,
    read_threshold,
    turns_to,
)

if TYPE_CHECKING:
    from gearidae.scene import GearScene, Scene

log = logging.getLogger(__name__)

_COEFFICIENT = Quantity(unit="m^2/N", above=0, at_most=1)
_SPREAD = Quantity(unit="1", at_least=1, at_most=100)
_LENGTH = Quantity(unit="m", above=0, at_most=1)
_FREQUENCY = Quantity(unit="Hz", above=0, at_most=1e12)
_TOLERANCE = Quantity(unit="1", above=0, at_most=1)
_HOUR: Final = 3600.0


class _Wear(NamedTuple):
    """What is known of the wear of the joints.

    Attributes
    ----------
    names : list of str
        Joints.
    radii, volumes : ndarray
        Radius [m] and threshold [m^3] of each.
    length : float
        Of the joints [m].
    coefficient, spread : float
        Median [m^2/N] and geometric standard deviation of the wear coefficient.
    factors : ndarray, shape (seeds, joints)
        What multiplies the coefficient of each joint of a drawn device.
    """

    names: list[str]
    radii: Floats
    volumes: Floats
    length: float
    coefficient: float
    spread: float
    factors: Floats


def hub_life(
    scene: Scene,
    *,
    coefficient: float | str,
    threshold: float | str,
    spread: float | str = 1.0,
    seeds: int = 200,
    clearance: bool = False,
    frequencies: Sequence[float | str] | None = None,
    length: float | str | None = None,
    turns: int = 4,
    tolerance: float = 1e-3,
    **options: Unpack[RunOptions],
) -> xr.Dataset:
    r"""Turns of the pinion after which hubs and pin have worn off a volume, and which of them is the first.

    Of a train of several meshes the drive's shaft stands for the pinion, and the joints are the hubs of all shafts.
    The scene is run to its end, by which it must have settled and its schedules be over. It goes on for whole turns of
    the pinion until what each joint slides, :math:`S = \int N |v|\,\mathrm{d}t`, is steady. Archard's law then gives
    the life :math:`V/(k S)` in turns. Loads do not change as joints wear.

    Parameters
    ----------
    scene : Scene
        With gears that turn on, and a hub or a pin with a radius; the friction of a train's pin must be above 0 and
        not age, as its sliding is taken from its loss.
    coefficient : float or str
        Wear coefficient over hardness, k, in m^2/N or with a unit: a number that is fitted, as no open measurement was
        found.
    threshold : float or str
        Worn volume at which a joint has failed, in m^3 or with a unit; or the height in roughnesses down to which the
        tops of its asperities are gone ("2 sigma"), which takes the volume from the surface of the scene.
    spread : float, optional
        Geometric standard deviation of a lognormal k, of which `coefficient` is the median; 1 for none.
    seeds : int, optional
        Devices that are drawn with a `spread`, each joint with a k of its own.
    clearance : bool, optional
        Whether to give the depth that each joint has worn, all round, at the end of the life, and the backlash that it
        adds.
    frequencies : sequence of float or str, optional
        Of a drive whose law has a ``frequency`` [Hz]: its last value. The whole schedule and the initial speed are
        scaled with it. By default that of the scene.
    length : float or str, optional
        Of the joints, in metres or with a unit; by default the face width, which must be that of all meshes.
    turns : int, optional
        Turns of the pinion in a block.
    tolerance : float, optional
        By which share two blocks may differ.
    **options
        ``executor``, ``jobs``, ``backend``, ``progress``, ``archive``, ``overwrite`` and ``resume``, as for `sweep`.

    Returns
    -------
    Dataset, dims (frequency, joint)
        ``sliding`` [N m] in a turn, ``volume`` [m^3] of the threshold, ``turns`` and ``hours`` of the life with the
        median k, ``turns_quantile`` (10, 50 and 90 % of a joint); ``first_share``, share of the devices in which a
        joint is the first; along ``frequency`` and ``seed`` ``life``, that of the first joint, and along ``quantile``
        ``life_quantile``. With `clearance`, ``worn_depth`` and ``added_backlash`` [m] when the median life is over.
        ``frequency`` is the measured number of turns in a second, ``drift`` the difference of the last two blocks.
        A run that gives no answer has NaN, and its ``status`` and ``message``.

    Raises
    ------
    SceneError
        If the scene has no gears or no joint, or a setting is not allowed.
    SolverError
        If no run gives an answer.
    Interrupted
        On Ctrl-C.

    Notes
    -----
    What is predicted is the form: over frequency, load, springs and friction, and which joint goes first. A hub that
    has worn by h lets its shaft cross 2 h where the tooth force reverses, so that the play along the line of action
    grows by 2 h at most; a worn pin adds none.
    """
    scene = require_meshes(scene)
    base, execution = prepared(scene, options, samples="off", trains=True)
    seeds = whole("seeds", seeds, 1, 1_000_000)
    wear = _wear(base, coefficient, threshold, (spread, seeds), length)
    measured = Turns(whole("turns", turns, 1, 10_000), _TOLERANCE.take("tolerance", tolerance))
    clearance = switch("clearance", clearance)
    requested = None
    if frequencies is not None:
        requested = [_FREQUENCY.take("frequencies", frequency) for frequency in frequencies]
    scenes = [base] if requested is None else [at_frequency(base, frequency) for frequency in requested]
    if not scenes:
        raise SceneError("frequencies", "[]", "must be one number at least")
    runs = [settling_scene(steady, measured) for steady in scenes]

    def work(kept: RunCache | None) -> xr.Dataset:
        with execution.side_by_side(kept, len(runs)) as compute:
            words = [word for _, word in compute(run_turns, runs, measured)]
        return _dataset(base, wear, requested, words, clearance=clearance)

    threshold_text = threshold if isinstance(threshold, str) else repr(float(threshold))
    settings = {
        "coefficient": wear.coefficient,
        "threshold": threshold_text,
        "spread": [wear.spread, len(wear.factors)],
        "clearance": clearance,
        "frequencies": requested,
        "length": wear.length,
        "turns": [measured.count, measured.tolerance],
    }
    return STUDY.compute(execution, runs[0], work, settings, origin=scene)


def at_frequency(scene: GearScene | TrainScene, frequency: float) -> GearScene | TrainScene:
    """Return the scene with another last frequency of its drive's law [Hz], schedule and initial speed in proportion.

    Raises
    ------
    SceneError
        If its drive has no law with a frequency, or one that ends at 0.
    """
    law = scene.to_dict()["drive"].get("law") or {}
    old = law.get("frequency")
    last = old[-1][1] if isinstance(old, list) else old
    if not last:
        raise SceneError("frequencies", frequency, "needs a drive whose law has a frequency, as microengine")
    ratio = frequency / last
    new = [[time, value * ratio] for time, value in old] if isinstance(old, list) else frequency
    speed = scene.initial.gear_speed * ratio
    return scene.replace({"drive.law.frequency": new, "initial.gear_speed": speed})


def _wear(
    scene: GearScene | TrainScene,
    coefficient: float | str,
    threshold: float | str,
    scatter: tuple[float | str, int],
    length: float | str | None,
) -> _Wear:
    """Read the numbers of the wear."""
    there = [joint for joint in joints(scene) if joint.radius > 0.0]
    if not there:
        hub = "shafts.NAME.hub_radius" if isinstance(scene, TrainScene) else "gears.pinion_hub_radius"
        allowed = f"must have a hub or a pin with a radius ({hub}, drive.pin_radius)"
        raise SceneError("scene", scene.name, allowed)
    if isinstance(scene, TrainScene):
        _check_pin(there)
    size = _face_width(scene) if length is None else _LENGTH.take("length", length)
    limit: Threshold = read_threshold(threshold)
    k, spread = _COEFFICIENT.take("coefficient", coefficient), _SPREAD.take("spread", scatter[0])
    count = scatter[1] if spread > 1.0 else 1
    radii = np.array([joint.radius for joint in there])
    volumes = limit.of(scene.surface, joint_area(radii, size))
    factors = drawn_factors(spread, count, len(there))
    return _Wear([joint.name for joint in there], radii, volumes, size, k, spread, factors)


def _check_pin(there: Sequence[Joint]) -> None:
    """Refuse a pin of a train whose loss does not say what it slides."""
    pin = next((joint for joint in there if joint.name == "pin"), None)
    if pin is not None and (pin.arm == 0.0 or pin.rise > 0.0):
        key, value = ("pin_friction_rise", pin.rise) if pin.rise > 0.0 else ("pin_friction", pin.coefficient)
        allowed = "must be 0" if pin.rise > 0.0 else "must be above 0"
        reason = f"{allowed} for lives of a train, which take the sliding of its pin from its loss"
        raise SceneError(f"drive.{key}", value, f"{reason}; without drive.pin_radius the pin is left out")


def _face_width(scene: GearScene | TrainScene) -> float:
    """Face width of all meshes [m]."""
    if not isinstance(scene, TrainScene):
        return scene.gears.face_width
    widths = {mesh.face_width for mesh in scene.train.meshes}
    if len(widths) > 1:
        raise SceneError("length", "(missing)", "is required where meshes differ in their face widths")
    return widths.pop()


def _dataset(
    scene: GearScene | TrainScene,
    wear: _Wear,
    requested: list[float] | None,
    words: list[str],
    *,
    clearance: bool,
) -> xr.Dataset:
    failures = [failure_of(word) for word in words]
    for failure in filter(None, failures):
        log.warning("one frequency has no life: %s", failure)
    if all(failures):
        raise SolverError(
            f"no run gives a life; the last one: {failures[-1]}",
            time=0.0,
            state={},
            last_event="none",
            advice="let the scene settle: a longer run.duration, schedules that end before it, a load that is carried",
        )
    names = names_of_sums(scene)
    none = Slid((math.nan,) * len(names), math.nan, math.nan)
    slides = [none if failure else Slid.read(word) for failure, word in zip(failures, words, strict=True)]
    indices = [names.index(name) for name in wear.names]
    sliding = np.array([slid.sliding for slid in slides])[:, indices]
    rates = np.array([slid.rate for slid in slides])
    asked = np.array(rates if requested is None else requested)
    values = {
        "frequency": np.where(np.isnan(rates), asked, rates),
        "joint": np.array(wear.names),
        "sliding": sliding,
        "volume": wear.volumes,
        "drift": np.array([slid.drift for slid in slides]),
        "status": np.array(["failed" if failure else "finished" for failure in failures]),
        "message": np.array(failures),
        **_lives(wear, sliding, rates),
    }
    if clearance:
        values |= _worn(wear, sliding)
    turning = shaft_of_turns(scene)
    attributes = {
        **provenance(scene, "found lives of hubs"),
        **({"shaft": turning} if isinstance(scene, TrainScene) else {}),
        "title": f"{scene.name}: lives of hubs and pin",
        "summary": f"Turns of {turning} until a joint has worn off a volume, by Archard's law. {FITTED}",
        "coefficient": wear.coefficient,
        "spread": wear.spread,
        "length": wear.length,
    }
    return STUDY.dataset(values, attributes)


def _lives(wear: _Wear, sliding: Floats, rates: Floats) -> dict[str, Any]:
    """Lives of the joints and of the devices, from what joints slide at each frequency."""
    turns = turns_to(wear.volumes, wear.coefficient, sliding)
    drawn = turns_to(wear.volumes, wear.coefficient * wear.factors, sliding[:, None, :])
    shares = np.array([first_shares(devices) for devices in drawn])
    lives = drawn.min(axis=2)
    quantiles = np.array(QUANTILES)
    return {
        "turns": turns,
        "hours": turns / rates[:, None] / _HOUR,
        "turns_quantile": lognormal_quantile(turns[..., None], wear.spread, quantiles),
        "first_share": np.where(np.isnan(turns), np.nan, shares),
        "seed": np.arange(lives.shape[1]),
        "life": lives,
        "quantile": quantiles,
        "life_quantile": np.quantile(lives, quantiles, axis=1).T,
    }


def _worn(wear: _Wear, sliding: Floats) -> dict[str, Any]:
    """Depth that each joint has worn when the first has reached its threshold, and the backlash that it adds."""
    end = turns_to(wear.volumes, wear.coefficient, sliding).min(axis=1, keepdims=True)
    depth = wear.coefficient * sliding * end / joint_area(wear.radii, wear.length)
    hubs = np.array([0.0 if name == "pin" else 2.0 for name in wear.names])
    return {"worn_depth": depth, "added_backlash": hubs * depth}
