"""Phases of a train's meshes: a gear in two meshes links them, and a loop of such gears closes or does not.

With ``p = xi/pb - approach/pb`` at a tooth's centre, a gear of z teeth on a shaft of sense s that is met in two
directions has ``p_2 = p_1 + z s (theta_1 - theta_2) / (2 pi)``, and half a pitch more where it is driven in one and
drives in the other; a direction is that from its centre to the other gear's.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Final, NamedTuple

from gearidae.errors import SceneError

if TYPE_CHECKING:
    from gearidae.scene.train import TrainMesh

_WHOLE: Final = 1e-12
"""A phase this little below a whole pitch is 0: rounding alone keeps it there."""


class Mount(NamedTuple):
    """How a gear stands in one of its meshes.

    Attributes
    ----------
    gear : int
        Number of the gear, from the drive on.
    shift : int
        Pair of this mesh that has the tooth which pair 0 of the gear's first mesh has.
    turned : bool
        Whether it drives here and is driven there, or the other way.
    """

    gear: int = 0
    shift: int = 0
    turned: bool = False


class _Met(NamedTuple):
    """A gear in the first of its meshes: p, the direction to the other gear [rad], whether it is driven; its number."""

    position: float
    direction: float
    driven: bool
    number: int


def with_phases(
    meshes: Sequence[TrainMesh],
    given: Sequence[float | None],
    senses: Sequence[int],
    default: float,
    gap: float,
    drive: int,
) -> list[TrainMesh]:
    """Give every mesh its phase: the first of each group of gears in mesh its own, the others what follows.

    Parameters
    ----------
    meshes : sequence of TrainMesh
        With their angles.
    given : sequence of float or None
        Phases that the scene gives.
    senses : sequence of int
        Of the shafts.
    default : float
        Phase of a first mesh that has none.
    gap : float
        Gap of the drive flanks at the start [m].
    drive : int
        Number of the drive's shaft.

    Returns
    -------
    list of TrainMesh
        Where a loop closes with a residual, it is added to the offset of its last mesh.

    Raises
    ------
    SceneError
        If a phase is given where it follows, or a loop cannot be assembled.
    """
    order = _from_the_drive(meshes, drive)
    known: dict[str, _Met] = {}
    phases: dict[int, float] = {}
    residuals: dict[int, float] = {}
    mounts: dict[int, tuple[Mount, Mount]] = {}
    source: dict[str, str] = {}
    left = list(order)
    while left:
        number, ends = _next(left, meshes, known, given)
        left.remove(number)
        mesh = meshes[number]
        follow = {
            side: _follow(mesh, side, known[gear], senses, gap)
            for side, gear in (("driven", mesh.driven), ("driver", mesh.driver))
            if gear in known
        }
        if ends and given[number] is not None:
            gear = mesh.driven if "driven" in follow else mesh.driver
            raise SceneError(
                f"meshes.{mesh.name}.phase",
                given[number],
                f"must be left out: it follows from meshes.{source[gear]}, by the gear {gear}",
            )
        if not follow:
            own = given[number]
            phases[number] = default if own is None else own
        else:
            phases[number] = _wrapped(follow.get("driven", follow.get("driver", 0.0)))
        if len(follow) == 2:
            residuals[number] = 0.5 - (0.5 - (follow["driven"] - follow["driver"])) % 1.0
        for side, gear in (("driver", mesh.driver), ("driven", mesh.driven)):
            direction = mesh.angle + math.pi * (side == "driven")
            position = phases[number] - _zero(mesh, side, gap)
            known.setdefault(gear, _Met(position, direction, side == "driven", len(known)))
            source.setdefault(gear, mesh.name)
        mounts[number] = (
            _mount(phases[number], follow.get("driver"), known[mesh.driver], driven=False),
            _mount(phases[number], follow.get("driven"), known[mesh.driven], driven=True),
        )
    for number, residual in residuals.items():
        _check_residual(meshes[number], residual)
    return [
        replace(
            mesh,
            phase=phases[number],
            residual=residuals.get(number, 0.0),
            offset=mesh.offset + residuals.get(number, 0.0) * mesh.geometry.base_pitch,
            mounts=mounts[number],
        )
        for number, mesh in enumerate(meshes)
    ]


def _from_the_drive(meshes: Sequence[TrainMesh], drive: int) -> list[int]:
    """Numbers of the meshes, those nearer to the drive first."""
    far = {drive: 0}
    for _ in meshes:
        for mesh in meshes:
            if mesh.a in far:
                far[mesh.b] = min(far.get(mesh.b, len(meshes)), far[mesh.a] + 1)
    return sorted(range(len(meshes)), key=lambda number: (far[meshes[number].a], meshes[number].closes))


def _next(
    left: Sequence[int],
    meshes: Sequence[TrainMesh],
    known: dict[str, _Met],
    given: Sequence[float | None],
) -> tuple[int, int]:
    """Choose the mesh whose phase is next, and the number of its gears that are known.

    One that follows from a mesh of the tree first, then one that closes a loop of shafts, then a first one: of those
    that are linked by gears the one that has its phase given.
    """

    def ends(number: int) -> int:
        return (meshes[number].driver in known) + (meshes[number].driven in known)

    for wanted, closing in ((1, False), (1, True), (2, True), (2, False)):
        for number in left:
            if ends(number) == wanted and meshes[number].closes == closing:
                return number, wanted
    linked = {meshes[left[0]].driver, meshes[left[0]].driven}
    group: list[int] = []
    while True:
        more = [
            number
            for number in left
            if number not in group and linked & {meshes[number].driver, meshes[number].driven}
        ]
        if not more:
            break
        group += more
        linked |= {gear for number in more for gear in (meshes[number].driver, meshes[number].driven)}
    return next((number for number in sorted(group, key=left.index) if given[number] is not None), left[0]), 0


def _zero(mesh: TrainMesh, side: str, gap: float) -> float:
    """Phase of a mesh at p = 0, counted by its driven gear or by its driver, which stands off by half the backlash."""
    geometry = mesh.geometry
    back = 0.0 if side == "driven" else 0.5 * mesh.mesh.backlash - gap
    return (geometry.approach - back) / geometry.base_pitch


def _follow(mesh: TrainMesh, side: str, gear: _Met, senses: Sequence[int], gap: float) -> float:
    """Phase of a mesh as it follows from one of its gears."""
    driven = side == "driven"
    teeth = mesh.geometry.gear_teeth if driven else mesh.geometry.pinion_teeth
    sense = senses[mesh.b if driven else mesh.a]
    direction = mesh.angle + math.pi * driven
    half = 0.5 * (driven != gear.driven)
    turned = teeth * sense * (gear.direction - direction) / (2.0 * math.pi)
    return gear.position + half + turned + _zero(mesh, side, gap)


def _mount(phase: float, follow: float | None, gear: _Met, *, driven: bool) -> Mount:
    """Find the pair that has the tooth of the gear's first pair: whole pitches lie between what follows and the phase.

    Along the way of a gear its driving flanks lie half a pitch ahead of its driven ones, and not behind them.
    """
    ahead = int(driven and not gear.driven)
    shift = 0 if follow is None else round(phase - (follow - ahead))
    return Mount(gear.number, shift, driven != gear.driven)


def _wrapped(phase: float) -> float:
    inside = phase % 1.0
    return 0.0 if 1.0 - inside < _WHOLE else inside


def _check_residual(mesh: TrainMesh, residual: float) -> None:
    """Refuse a loop whose last mesh would have to be pressed together."""
    length = residual * mesh.geometry.base_pitch
    if abs(length) >= 0.5 * mesh.mesh.backlash:
        raise SceneError(
            f"meshes.{mesh.name}",
            f"(residual {residual:.6g} pitches)",
            f"cannot be assembled: the loop closes {length:.4g} m off, and there are"
            f" {0.5 * mesh.mesh.backlash:.4g} m to either side",
        )
