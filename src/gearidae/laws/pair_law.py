"""What a law of a tooth pair is, and what it adds to: as `gearidae.laws.law` says it of the laws of a shaft."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final, NamedTuple

from gearidae.compiled import compiled
from gearidae.laws.law import Key, Loss, Verb


class PairForce(NamedTuple):
    """Force of one pair at one gap, rate and position, scaled, with its slopes.

    Attributes
    ----------
    load, by_gap, by_rate, by_position : float
        Force along the line of action, which drives the flanks apart, and its slopes in the gap, in the gap's rate and
        along the path of contact. The last is left out where it only steers Newton's iteration a little.
    contact, contact_by_gap : float
        What asperities in contact carry of it, on which friction acts, and its slope in the gap.
    path, path_by_gap, path_by_position : float
        Force along the path of contact at fixed gap, per pitch, and its slopes.
    limit, limit_by_gap, limit_by_position : float
        Largest friction, of a law that knows its contacts one by one, and its slopes.
    """

    load: float
    by_gap: float
    by_rate: float
    by_position: float
    contact: float
    contact_by_gap: float
    path: float
    path_by_gap: float
    path_by_position: float
    limit: float
    limit_by_gap: float
    limit_by_position: float


NO_PAIR_FORCE: Final = PairForce(*(0.0,) * 12)


@compiled(inline=True)
def of_contact(load: float, by_gap: float) -> PairForce:
    """Force that asperities in contact carry alone."""
    return PairForce(load, by_gap, 0.0, 0.0, load, by_gap, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@compiled(inline=True)
def of_path(path: float, by_gap: float, by_position: float) -> PairForce:
    """Force along the path of contact alone."""
    return PairForce(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, path, by_gap, by_position, 0.0, 0.0, 0.0)


@compiled(inline=True)
def of_gap(load: float, by_gap: float, by_rate: float) -> PairForce:
    """Force along the line of action alone, which no asperities carry."""
    return PairForce(load, by_gap, by_rate, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@compiled(inline=True)
def both_forces(a: PairForce, b: PairForce) -> PairForce:
    """Sum of what two laws say of the same pair."""
    return PairForce(
        a.load + b.load,
        a.by_gap + b.by_gap,
        a.by_rate + b.by_rate,
        a.by_position + b.by_position,
        a.contact + b.contact,
        a.contact_by_gap + b.contact_by_gap,
        a.path + b.path,
        a.path_by_gap + b.path_by_gap,
        a.path_by_position + b.path_by_position,
        a.limit + b.limit,
        a.limit_by_gap + b.limit_by_gap,
        a.limit_by_position + b.limit_by_position,
    )


@compiled(inline=True)
def in_reach(m: Any, gap: float) -> bool:
    """Whether laws act on a pair of this gap: by its position alone, whatever a history knows of it."""
    return bool(gap < m.scene.cutoff)


class GapMotion(NamedTuple):
    """Gap of a pair at one end of a step, its rate and the rate of that."""

    gap: float
    rate: float
    acceleration: float


@dataclass(frozen=True)
class MeshConstant:
    """A constant of a law of a pair that is a key of the mesh, ``mesh.NAME``, and a field of ``SCENE``.

    Attributes
    ----------
    name : str
    key : Key
    force, length, time : int
        Powers of the units of a scene in its own.
    """

    name: str
    key: Key
    force: int = 0
    length: int = 0
    time: int = 0


@dataclass(frozen=True, kw_only=True)
class PairLaw:
    """A law of a tooth pair, or of a whole mesh. A verb that it has no use for is left out, and adds nothing.

    All is scaled. `m` is the model of a run, `pair` a pair at a state (`PairState`), `k` the index of its history, `t`
    the time, `y` the state. A verb is asked of pairs within reach, of meshes that have the law: as force, energy,
    power and loss are asked under one condition, none of them can act where another does not.

    Attributes
    ----------
    name : str
        Of the feature of a scene, where the law has keys.
    acts : (scene) -> bool
        Whether a mesh has the law, by its constants in ``SCENE``. In Python.
    constants : tuple of MeshConstant
    losses : tuple of Loss
        Terms of the balance; what `loss` and `mesh_loss` add goes to the first.
    refuse : (mesh) -> None, optional
        Raises `SceneError` where keys do not go together. In Python.
    force : (m, t, y, pair, settling, value) -> value
        Adds to a `PairForce`. `settling` says whether deflections of elastic bodies are solved for.
    energy : (m, y, pair, value) -> value
        Adds what a pair stores, and what of that joining has lost since the last turning point.
    joining : (m, k, y, gap, value) -> value
        Adds what each material has lost per length by joining since then as if it covered everything, and slopes.
    in_contact : (m, k, y, gap, material, value) -> value
        Adds asperities of a material in contact per length, over their density.
    power : (m, t, y, k, gap, w_rate, value) -> value
        Adds the power of the changing length of a pair's contact, and its rate.
    loss : (m, h, before, now, value) -> value
        Adds what it takes from a pair in a step of the length h, between two `GapMotion`, and the error of that. Of a
        law that has it the force may jump at the cut-off: passing that is an event, and force and loss are asked of a
        pair throughout a step or not at all.
    mesh_force : (m, rate, value) -> value
        Adds the force on a whole mesh, by the rate of the transmission error alone.
    mesh_by_rate : (m, value) -> value
        Adds the slope of that.
    mesh_loss : (m, h, travel, rates, value) -> value
        Adds what that takes in a step, and the error.
    """

    name: str
    acts: Callable[[Any], bool]
    constants: tuple[MeshConstant, ...] = ()
    losses: tuple[Loss, ...] = ()
    refuse: Callable[[Any], None] | None = None
    force: Verb | None = None
    energy: Verb | None = None
    joining: Verb | None = None
    in_contact: Verb | None = None
    power: Verb | None = None
    loss: Verb | None = None
    mesh_force: Verb | None = None
    mesh_by_rate: Verb | None = None
    mesh_loss: Verb | None = None
