r"""Errors of single teeth: how far each stands back from the position that its gear's other teeth give it.

A positive error p is that of a tooth that stands back from its drive flank, so that the drive gap of its pairs opens
and the coast gap closes. Pair i has the gaps

.. math::

    g = b - u + s + p_1[i] + p_2[i], \qquad g^c = b + u + s - p_1[i] - p_2[i + 1]

of tooth i modulo the number of teeth: the coast flank of a space of the pinion belongs to the next tooth of the gear.

Errors are listed for each tooth, or drawn from a seed with an rms that both gears share.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final

import numpy as np
from pydantic import BeforeValidator

from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.scene.carried import numbers_of
from gearidae.scene.coating_table import met_teeth
from gearidae.scene.quantity import Quantity
from gearidae.scene.table_head import open_table
from gearidae.scene.text_table import listed, split_unit

if TYPE_CHECKING:
    import xarray as xr

    from gearidae.scene.gears import Mesh
    from gearidae.scene.scene import GearScene, Scene
    from gearidae.scene.train import TrainMesh

SIDES: Final = ("pinion", "gear")
_MOST_TEETH: Final = 10_000
_LARGEST: Final = 5_000_000  # bytes of a file
_NAME: Final = "error"
"""Heading, before its unit, of the column of a file that has others besides."""
_ALLOWED: Final = 'must be a list of errors, one for each tooth, or { file = "name.csv" }'


def _as_errors(value: object) -> object:
    """Turn a file's column, an array or numbers with units into a list; what it holds is read later."""
    if isinstance(value, Mapping):
        if set(value) != {"file"} or not isinstance(value["file"], str | Path):
            raise ValueError(_ALLOWED)
        return _column(Path(value["file"]))
    if hasattr(value, "tolist") or hasattr(value, "magnitude"):
        value = numbers_of(value, "m").tolist()
    if not isinstance(value, (list, tuple)):
        raise ValueError(_ALLOWED)
    if len(value) > _MOST_TEETH:
        raise ValueError(f"has {len(value)} errors; there may be {_MOST_TEETH} at most")
    return tuple(value)


PitchErrors = Annotated[
    tuple[Annotated[float, Quantity(unit="m", at_least=-1, at_most=1, shown=("nm", -9))], ...],
    BeforeValidator(_as_errors),
]


def _column(path: Path) -> tuple[float, ...]:
    """Read the column of errors of a file [m]."""
    try:
        table = open_table(
            path,
            largest=_LARGEST,
            names=lambda headings: _error_column(headings) is not None,
            unit_row=True,
        )
        index = _error_column(table.headings)
        if index is None:
            raise ValueError(f"must have one column, or a column {_NAME!r} among {listed(table.headings)}")
        unit = split_unit(table.headings[index])[1]
        if not unit:
            raise ValueError(f"column {table.headings[index]!r} needs its unit, such as '{_NAME} [nm]'")
        cells = table.numbers([index], most=_MOST_TEETH)[:, 0]
        return tuple(numbers_of(cells, "m", unit).tolist())
    except (OSError, ValueError) as error:
        raise ValueError(f"the file {path.name}: {error}") from None


def _error_column(headings: Sequence[str]) -> int | None:
    """Index of the column of errors: the only one, or the one of that name."""
    if len(headings) == 1:
        return 0
    columns = [k for k, heading in enumerate(headings) if split_unit(heading.strip())[0] == _NAME]
    return columns[0] if len(columns) == 1 else None


def has_pitch_errors(scene: Scene) -> bool:
    """Whether teeth of a scene have errors of their own."""
    mesh = scene.mesh
    return mesh is not None and bool(
        mesh.pinion_pitch_error or mesh.gear_pitch_error or mesh.pitch_error_rms > 0.0
    )


def errors_of_teeth(scene: GearScene) -> tuple[Floats, Floats]:
    """Errors of the teeth of the pinion and of the gear [m], listed or drawn; zeros without any.

    Drawn ones are those of `drawn_errors`, side 0 for the pinion and 1 for the gear.

    Returns
    -------
    pinion, gear : ndarray, shape (teeth,)
    """
    mesh, gears = scene.mesh, scene.gears
    sides = []
    for side, name in enumerate(SIDES):
        teeth, given = getattr(gears, f"{name}_teeth"), getattr(mesh, f"{name}_pitch_error")
        if given:
            sides.append(np.array(given))
        elif mesh.pitch_error_rms > 0.0:
            sides.append(drawn_errors(mesh, side, teeth))
        else:
            sides.append(np.zeros(teeth))
    return sides[0], sides[1]


def drawn_errors(mesh: Mesh, gear: int, teeth: int) -> Floats:
    """Errors of the teeth of a gear [m] by the seed of its mesh.

    ``numpy.random.default_rng([seed, gear]).standard_normal(teeth)`` times ``rms / sqrt(2)``, so that sums of one tooth
    of each of two gears have the rms.

    Parameters
    ----------
    mesh : Mesh
    gear : int
        0 for the pinion, 1 for the gear; of a train the gears are numbered from the drive on.
    teeth : int
    """
    random = np.random.default_rng([mesh.pitch_error_seed, gear])
    return np.asarray(random.standard_normal(teeth) * (mesh.pitch_error_rms / math.sqrt(2.0)))


def errors_in_train(mesh: TrainMesh) -> tuple[Floats, Floats]:
    """Errors of the teeth of the driver and of the driven gear of a mesh [m], drawn once for each gear of the train.

    A tooth has one place on its gear. Standing forward opens the gap where its gear is driven, and closes it where its
    gear drives: there the error has the other sign.

    Returns
    -------
    driver, driven : ndarray, shape (teeth,)
        Of tooth i of pair i.
    """
    geometry = mesh.geometry
    sides = []
    for mount, teeth in zip(mesh.mounts, (geometry.pinion_teeth, geometry.gear_teeth), strict=True):
        drawn = np.roll(drawn_errors(mesh.mesh, mount.gear, teeth), mount.shift)
        sides.append(-drawn if mount.turned else drawn)
    return sides[0], sides[1]


def extreme_sums(scene: GearScene) -> tuple[tuple[float, float], tuple[float, float]]:
    """Smallest and largest sum of the errors of two teeth that meet [m], of the drive and of the coast flank.

    Teeth that meet have numbers that differ, on the coast flank by one more, by multiples of the greatest common
    divisor of the numbers of teeth.
    """
    pinion, gear = errors_of_teeth(scene)
    meets = math.gcd(pinion.size, gear.size)
    bounds = []
    for coast in (0, 1):
        first, second = (side.reshape(-1, meets) for side in (pinion, np.roll(gear, -coast)))
        low = float((first.min(axis=0) + second.min(axis=0)).min())
        bounds.append((low, float((first.max(axis=0) + second.max(axis=0)).max())))
    return bounds[0], bounds[1]


def rms_of_sums(scene: GearScene) -> float:
    """Root mean square, about their mean, of the sums of one tooth of each gear [m]."""
    return math.hypot(*(float(errors.std()) for errors in errors_of_teeth(scene)))


def errors_range(scene: GearScene) -> float:
    """By how much the gaps of two pairs of one flank may differ at one point of the path [m]."""
    return max(high - low for low, high in extreme_sums(scene)) if has_pitch_errors(scene) else 0.0


def error_on_path(scene: GearScene, *, coast: bool) -> float:
    """By how much less, or more, the smallest gap of a flank is at the start than without pitch errors [m].

    That of the pairs that are on the path of contact then; 0 where there are none.
    """
    if not has_pitch_errors(scene):
        return 0.0
    geometry, phase = scene.geometry, scene.initial.mesh_phase
    # the coast flank is mirrored about the pitch point, half a pitch later
    last = 2.0 * geometry.approach / geometry.base_pitch + 0.5 if coast else 0.0
    lowest = phase - last if coast else phase - geometry.contact_ratio
    numbers = np.arange(math.ceil(lowest), math.floor(lowest + geometry.contact_ratio) + 1)
    pinion, gear = errors_of_teeth(scene)
    first, second = met_teeth(numbers, coast=coast)
    sums = pinion[first % pinion.size] + gear[second % gear.size]
    return float((-sums if coast else sums).min(initial=math.inf)) if sums.size else 0.0


def pitch_errors(scene: Scene) -> xr.Dataset:
    """Return the errors of the teeth that a scene runs with, listed or drawn.

    Parameters
    ----------
    scene : Scene
        With gears.

    Returns
    -------
    xarray.Dataset
        ``pinion_pitch_error`` over ``pinion_tooth`` and ``gear_pitch_error`` over ``gear_tooth`` [m], positive where a
        tooth stands back from its drive flank; zeros without errors. The attribute ``meshes_to_meet`` is the number of
        meshes after which every pair of teeth that can meet has met, ``z1 z2 / gcd(z1, z2)``.

    Raises
    ------
    SceneError
        If the scene has no gears.

    Examples
    --------
    >>> import gearidae as gd
    >>> drawn = gd.preset("teodorescu2009").replace({"mesh.pitch_error_rms": "10 nm", "mesh.pitch_error_seed": 3})
    >>> gd.pitch_errors(drawn).sizes["gear_tooth"]
    76
    """
    import xarray as xr

    from gearidae.scene.scene import require_gears

    scene = require_gears(scene)
    sides = dict(zip(SIDES, errors_of_teeth(scene), strict=True))
    variables: dict[str, Any] = {}
    for name, errors in sides.items():
        words = f"distance by which teeth of the {name} stand back from their drive flanks"
        variables[f"{name}_pitch_error"] = (f"{name}_tooth", errors, {"units": "m", "long_name": words})
    tooth = {f"{name}_tooth": np.arange(errors.size) for name, errors in sides.items()}
    meets = math.lcm(sides["pinion"].size, sides["gear"].size)
    return xr.Dataset(variables, tooth, {"title": scene.name, "meshes_to_meet": meets})


def check_pitch_errors(scene: GearScene) -> None:
    """Refuse errors that do not fit the gears, and teeth that jam.

    Raises
    ------
    SceneError
        Naming ``mesh.pinion_pitch_error``, ``mesh.gear_pitch_error`` or ``mesh.pitch_error_rms``.
    """
    if not has_pitch_errors(scene):
        return
    mesh, gears = scene.mesh, scene.gears
    keys = [f"{name}_pitch_error" for name in SIDES if getattr(mesh, f"{name}_pitch_error")]
    drawn = "mesh.pitch_error_rms"
    if keys and mesh.pitch_error_rms > 0.0:
        raise SceneError(
            drawn, mesh.pitch_error_rms, f"cannot be given beside {keys[0]}: choose one of the two"
        )
    key = f"mesh.{keys[0]}" if keys else drawn
    for name, errors in zip(SIDES, errors_of_teeth(scene), strict=True):
        teeth, own = getattr(gears, f"{name}_teeth"), f"mesh.{name}_pitch_error"
        if errors.size != teeth:
            raise SceneError(
                own,
                f"({errors.size} errors)",
                f"must have {teeth}, one for each tooth",
            )
        worst = int(np.abs(errors).argmax())
        if abs(errors[worst]) > mesh.backlash:
            error = f"has an error of {errors[worst]:.4g} m on the {name}"
            allowed = f"{error}: must be at most the backlash, {mesh.backlash:.4g} m"
            raise SceneError(own if keys else drawn, f"(tooth {worst})", allowed)
    (low, high), (coast_low, coast_high) = extreme_sums(scene)
    spread = max(high, coast_high) - min(low, coast_low)
    if spread >= mesh.backlash:
        raise SceneError(
            key,
            f"(sums of two teeth differ by {spread:.4g} m)",
            f"teeth would jam: must differ by less than the backlash, {mesh.backlash:.4g} m",
        )
