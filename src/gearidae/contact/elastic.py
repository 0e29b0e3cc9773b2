r"""Two teeth with elastic bodies: the static curve of a rough roller on a rough half-space.

At every node of a `LineGrid` the mean gap is that of the rigid shapes plus the deflection of both bodies,

.. math::

    h_i = \frac{x_i^2}{2R} + g + \sum_k K_{ik}\, p(h_k, S_k), \qquad W = \sum_i w_i\, p(h_i, S_i),

and each node remembers the height zeta above which its asperities are joined, a play operator: S = h - zeta lies
between the distances at which an asperity joins and detaches.
The rigid gap g is moved in small steps. A step counts only if its solution lies where the tangent of the last one
pointed and is stable (``det(I - K dp/dh) > 0``). Where no step however small does, adhesion has outgrown the
stiffness of the bodies: the static curve folds back, and a real contact would jump. That is reported, not crossed.

References
----------
M. Teodorescu, S. Theodossiades, H. Rahnejat, Tribology International 42 (2009) 197-205, Eqs. 13-15,
doi:10.1016/j.triboint.2008.05.019.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearidae.asperities.tip import Surface, contact_modulus
from gearidae.contact.bulk import LineGrid, line_grid
from gearidae.contact.heights import Heights, heights_of, normal_density, normal_density_slope
from gearidae.errors import SceneError, SolverError

Array = NDArray[np.float64]

_TAIL = 5.5
"""Roughnesses of gap beyond which a node's share of the force is below the 1e-6 that the grid is made for."""
_FIRST_GAP = 13.0
"""Roughnesses of gap at which nothing touches yet."""


class ElasticFoldError(SolverError):
    """The static curve of an elastic contact folds back: here it would jump.

    Attributes
    ----------
    gap : float
        Rigid gap up to which the contact could be followed [m].
    motion : {"closing", "opening"}
        Which way it was moving.
    curve : ElasticCurve
        The part of the path that was reached; NaN beyond.
    """

    def __init__(self, gap: float, motion: Literal["closing", "opening"], curve: ElasticCurve) -> None:
        self.gap = gap
        self.motion = motion
        self.curve = curve
        super().__init__(
            "the static contact folds: adhesion outgrows the stiffness of the bodies",
            time=math.nan,
            state={"gap": gap},
            last_event=motion,
            advice="a real contact jumps here; use a rougher or stiffer surface, or the asperity model",
        )

    def __str__(self) -> str:
        """Return one line without the time, which a static curve has not."""
        return f"{self.message} at a gap of {self.gap:.6g} m while {self.motion}; {self.advice}"

    def __reduce__(self) -> tuple[Any, ...]:
        """Survive the trip between processes with every field in place."""
        return type(self), (self.gap, self.motion, self.curve)


@dataclass(frozen=True, slots=True, eq=False)
class ElasticCurve:
    """Static states of an elastic rough line contact along a path of rigid gaps.

    Attributes
    ----------
    gap : ndarray, shape (m,)
        Rigid gap g [m], as given.
    force : ndarray, shape (m,)
        Force W [N], positive pushes apart.
    x : ndarray, shape (n,)
        Distance of the nodes from the middle [m].
    node_gap : ndarray, shape (m, n)
        Deformed mean gap h at the nodes [m].
    pressure : ndarray, shape (m, n)
        Pressure at the nodes [Pa].
    """

    gap: Array
    force: Array
    x: Array
    node_gap: Array
    pressure: Array


def elastic_line_force(
    gap: ArrayLike,
    radius: float,
    width: float,
    surface: Surface,
    *,
    asperity: str = "jkr",
    coated_surface: Surface | None = None,
    sam_fraction: float = 0.0,
    nodes: int = 24,
) -> Array:
    """Static force between two rough elastic teeth along a path of gaps, loading and unloading.

    The path starts from bodies far apart with nothing joined, closes to the first gap and then visits the others in
    their order; asperities join, stretch and detach on the way, so that the same gap has another force on the way back.

    Parameters
    ----------
    gap : array_like, shape (m,)
        Path of rigid gaps g [m]: the mean gap in the middle if the bodies did not deflect; negative in compression.
    radius : float
        Reduced radius R of the two profiles [m].
    width : float
        Face width L [m].
    surface : Surface
        Elastic constants, energy and roughness (SI); its modulus is the bodies' too.
    asperity : str, optional
        Name of the law of one asperity: ``jkr``, ``dmt``, ``hertz`` or another that is registered.
    coated_surface : Surface, optional
        The same under a coating, if a share of the interface is covered.
    sam_fraction : float, optional
        Share of the interface that the coating covers, 0 to 1.
    nodes : int, optional
        Nodes on one side of the contact. For silicon teeth 24 bring the force to 1e-7 of its converged value while
        loading, and to 1e-5 of the loading force at the same gap while unloading, when the position at which asperities
        begin to detach travels across the nodes. A contact close to a fold wants more.

    Returns
    -------
    ndarray, shape (m,)
        Force W [N], positive pushes apart.

    Raises
    ------
    ElasticFoldError
        If the static curve ends in a fold before the path does; carries the part that was reached.
    SceneError
        If an argument is not valid.
    """
    return elastic_line_curve(
        gap,
        radius,
        width,
        surface,
        asperity=asperity,
        coated_surface=coated_surface,
        sam_fraction=sam_fraction,
        nodes=nodes,
    ).force


def elastic_line_curve(
    gap: ArrayLike,
    radius: float,
    width: float,
    surface: Surface,
    *,
    asperity: str = "jkr",
    coated_surface: Surface | None = None,
    sam_fraction: float = 0.0,
    nodes: int = 24,
) -> ElasticCurve:
    """Return `elastic_line_force` together with the gaps and pressures along the contact.

    Parameters
    ----------
    gap, radius, width, surface, asperity, coated_surface, sam_fraction, nodes
        As in `elastic_line_force`.

    Returns
    -------
    ElasticCurve

    Raises
    ------
    ElasticFoldError, SceneError
        As `elastic_line_force`.
    """
    path = np.asarray(gap, dtype=np.float64)
    if path.ndim != 1 or path.size == 0 or not np.all(np.isfinite(path)):
        raise SceneError(
            "gap", np.array2string(path, threshold=6), "must be a row of finite numbers of metres"
        )
    layer = _rough_layer(surface, asperity, coated_surface, sam_fraction)
    grid = _fitted_grid(float(path.min()), radius, width, surface, layer, nodes)
    return _Contact(grid, radius, width, layer).walk(path)


def _fitted_grid(
    lowest_gap: float, radius: float, width: float, surface: Surface, layer: _RoughLayer, nodes: int
) -> LineGrid:
    for key, value in (("radius", radius), ("width", width)):
        if not 0.0 < value < math.inf:
            raise SceneError(key, value, "must be a positive number of metres")
    modulus = contact_modulus(surface.youngs_modulus, surface.poisson_ratio)
    tail = _TAIL * layer.roughness + layer.reach
    least = math.sqrt(2.0 * radius * tail)
    reach = math.sqrt(2.0 * radius * (tail + max(-lowest_gap, 0.0)))
    # Elastic bodies leave the contact narrower than the rigid shapes would: see on a coarse grid how much.
    for _ in range(4):
        if reach <= least:
            break
        trial = _Contact(line_grid(reach, width, modulus, max(12, nodes // 2)), radius, width, layer)
        try:
            deepest = trial.walk(np.array([lowest_gap])).node_gap[0]
        except ElasticFoldError:  # following the path itself raises it again
            break
        beyond = np.flatnonzero(deepest > tail)
        shrunk = max(least, 1.05 * float(trial.grid.x[beyond[0]])) if beyond.size else reach
        if shrunk > 0.9 * reach:
            break
        reach = shrunk
    return line_grid(reach, width, modulus, nodes)


@dataclass(frozen=True, slots=True)
class _RoughLayer:
    """What lies between the bodies: shares of asperities that adhere differently, each with its own history."""

    roughness: float
    reach: float
    parts: tuple[tuple[float, Heights], ...]

    def far_apart(self, gap: Array) -> Array:
        """Joined heights of a contact with nothing joined, shape (parts, n)."""
        return np.stack([gap - part.law.detach * self.roughness for _, part in self.parts])

    def advance(self, gap: Array, joined: Array) -> Array:
        """Joined heights after a monotone motion to `gap`: the play operator."""
        highest = np.stack([gap - part.law.join * self.roughness for _, part in self.parts])
        return np.minimum(np.maximum(joined, self.far_apart(gap)), highest)

    def pressure(self, gap: Array, joined: Array) -> Array:
        """Pressure after a monotone motion to `gap` [Pa]."""
        total = np.zeros_like(gap)
        stretch = gap - self.advance(gap, joined)
        for (unit, part), extension in zip(self.parts, stretch, strict=True):
            S = np.clip(extension / self.roughness, part.law.join, part.law.detach)
            total += unit * part.integral(normal_density, gap / self.roughness, S, decays_left=True)
        return total

    def slope(self, gap: Array, joined: Array, opening: bool) -> Array:
        """dp/dh on the side towards which the gap moves [Pa/m]."""
        total = np.zeros_like(gap)
        H = gap / self.roughness
        for (unit, part), zeta in zip(self.parts, joined, strict=True):
            join, detach, extension = part.law.join, part.law.detach, (gap - zeta) / self.roughness
            S = np.clip(extension, join, detach)
            total += unit * part.integral(normal_density_slope, H, S, decays_left=True)
            if detach > join:
                # An end of the range belongs to the motion that leaves it inwards; give it room for rounding.
                room = 1e-9 * (detach - join) * (1.0 if opening else -1.0)
                stretching = (extension > join - room) & (extension < detach - room)
                total += np.where(stretching, unit * part.edge_load(S) * normal_density(H - S), 0.0)
        return total / self.roughness


def _rough_layer(
    surface: Surface, asperity: str, coated_surface: Surface | None, sam_fraction: float
) -> _RoughLayer:
    if not 0.0 <= sam_fraction <= 1.0:
        raise SceneError("coating.sam_fraction", sam_fraction, "must lie in 0..1")
    if coated_surface is None:
        if sam_fraction > 0.0:
            raise SceneError("coating.sam_fraction", sam_fraction, "needs a coated_surface")
        shares = [(1.0, surface)]
    else:
        shares = [(1.0 - sam_fraction, surface), (sam_fraction, coated_surface)]
        for key in ("youngs_modulus", "poisson_ratio", "asperity_density", "asperity_radius", "roughness"):
            if getattr(coated_surface, key) != getattr(surface, key):
                raise SceneError(
                    f"coated_surface.{key}", getattr(coated_surface, key), "must be the bare surface's"
                )
    parts = [(share, heights_of(which, asperity)) for share, which in shares if share > 0.0]
    return _RoughLayer(
        roughness=surface.roughness,
        reach=max(part.law.detach for _, part in parts) * surface.roughness,
        parts=tuple((share * surface.asperity_density * part.unit_load, part) for share, part in parts),
    )


@dataclass(frozen=True, slots=True)
class _Contact:
    """The equations of one contact on one grid."""

    grid: LineGrid
    radius: float
    width: float
    layer: _RoughLayer

    def walk(self, path: Array) -> ElasticCurve:
        """Follow the static curve along a path of rigid gaps, from far apart."""
        n = self.grid.x.size
        curve = ElasticCurve(
            path,
            np.full(path.size, np.nan),
            self.grid.x,
            np.full((path.size, n), np.nan),
            np.full((path.size, n), np.nan),
        )
        far = _FIRST_GAP * self.layer.roughness + self.layer.reach
        here = max(far, float(path[0]))
        gap = here + self.grid.x**2 / (2.0 * self.radius)
        joined = self.layer.far_apart(gap)
        for k, there in enumerate(path):
            here, gap, joined = self._move(here, float(there), gap, joined, curve)
            curve.node_gap[k] = gap
            curve.pressure[k] = self.layer.pressure(gap, joined)
            curve.force[k] = self.width * (self.grid.weights @ curve.pressure[k])
        return curve

    def _move(
        self, here: float, there: float, gap: Array, joined: Array, curve: ElasticCurve
    ) -> tuple[float, Array, Array]:
        """Move the rigid gap from `here` to `there` in steps that follow one branch."""
        sigma = self.layer.roughness
        opening = there > here
        step = 0.5 * sigma
        while here != there:
            target = there if abs(there - here) <= step else here + math.copysign(step, there - here)
            motion = (target - here) * np.linalg.solve(
                self._jacobian(gap, joined, opening), np.ones_like(gap)
            )
            solution = self._solve(target, gap + motion, joined, opening)
            allowed = 0.1 * min(float(np.abs(motion).max()), sigma) + 1e-3 * sigma
            if solution is not None and np.abs(solution - gap - motion).max() <= allowed:
                stable = np.linalg.slogdet(self._jacobian(solution, joined, opening)).sign > 0.0
            else:
                stable = False
            if stable and solution is not None:
                here, gap, joined = target, solution, self.layer.advance(solution, joined)
                step *= 2.0
            else:
                step = 0.5 * abs(target - here)
                if step < 1e-4 * sigma:
                    raise ElasticFoldError(here, "opening" if opening else "closing", curve)
        return here, gap, joined

    def _jacobian(self, gap: Array, joined: Array, opening: bool) -> Array:
        return np.asarray(np.eye(gap.size) - self.grid.compliance * self.layer.slope(gap, joined, opening))

    def _solve(self, rigid: float, guess: Array, joined: Array, opening: bool) -> Array | None:
        """Newton's method for the node gaps; None if it does not converge."""
        base = rigid + self.grid.x**2 / (2.0 * self.radius)
        gap = guess
        for _ in range(15):
            residual = gap - base - self.grid.compliance @ self.layer.pressure(gap, joined)
            change = np.linalg.solve(self._jacobian(gap, joined, opening), residual)
            gap = gap - change
            if np.abs(change).max() <= 1e-10 * self.layer.roughness:
                return gap
        return None
