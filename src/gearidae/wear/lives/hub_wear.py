r"""Wear and life of plain joints: Archard's law, thresholds, and which joint fails first.

A joint j loses the volume :math:`V_j = k S_j` with :math:`S_j = \int N |v|\,\mathrm{d}t` of its load and the speed of
its surface. The wear coefficient k [m^2/N] is a wear coefficient over a hardness: a number that is fitted.

References
----------
J. F. Archard, J. Appl. Phys. 24 (1953) 981-988, doi:10.1063/1.1721448.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike
from scipy import special

from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.scene.quantity import Quantity

if TYPE_CHECKING:
    from gearidae.asperities.tip import Surface

_VOLUME = Quantity(unit="m^3", above=0, at_most=1)
_DEPTH = Quantity(unit="1", at_least=0, at_most=8)


@dataclass(frozen=True, slots=True)
class Threshold:
    """Worn volume at which a joint has failed.

    Attributes
    ----------
    volume : float
        Of every joint [m^3]; NaN where the surface gives it.
    depth : float
        Height above the mean plane, in roughnesses, down to which the tops are gone; NaN where the volume is given.
    """

    volume: float = math.nan
    depth: float = math.nan

    def of(self, surface: Surface, area: ArrayLike) -> Floats:
        """Volumes of joints of some areas [m^3]."""
        areas = np.asarray(area, dtype=np.float64)
        if math.isnan(self.depth):
            return np.full(areas.shape, self.volume)
        return tops_volume(surface, self.depth, 1.0) * areas


def read_threshold(value: float | str) -> Threshold:
    """Read a volume ("1e-21 m^3", or a number in m^3) or a height in roughnesses ("2 sigma").

    Raises
    ------
    SceneError
        If it is neither.
    """
    if isinstance(value, str) and value.split()[-1:] == ["sigma"]:
        return Threshold(depth=_DEPTH.take("threshold", value.rpartition("sigma")[0].strip() or "1"))
    try:
        return Threshold(volume=_VOLUME.take("threshold", value))
    except SceneError as error:
        allowed = f"{error.allowed}; or a height in roughnesses, such as '2 sigma'"
        raise SceneError("threshold", value, allowed) from None


def tops_volume(surface: Surface, depth: float, area: float) -> float:
    r"""Volume of the tops of Gaussian asperities above a height.

    Parameters
    ----------
    surface : Surface
        Density N, tip radius beta and roughness sigma of the asperities (SI).
    depth : float
        Height c above the mean plane of the summits, in roughnesses.
    area : float
        Area A of the surface [m^2].

    Returns
    -------
    float
        :math:`N \pi \beta \sigma^2 \left((1 + c^2) Q(c) - c\,\varphi(c)\right) A` [m^3] with the normal density phi and
        its upper tail Q: paraboloids of the height h over the cut have the volume :math:`\pi\beta h^2`.
    """
    mills = math.sqrt(0.5 * math.pi) * float(special.erfcx(depth / math.sqrt(2.0)))
    density = math.exp(-0.5 * depth**2) / math.sqrt(2.0 * math.pi)
    share = density * ((1.0 + depth**2) * mills - depth)
    tip = math.pi * surface.asperity_radius * surface.roughness**2
    return surface.asperity_density * tip * share * area


def joint_area(radius: ArrayLike, length: float) -> Floats:
    """Area of the surface of journals [m^2], of their radii and length [m]."""
    return np.asarray(2.0 * math.pi * length * np.asarray(radius, dtype=np.float64))


def turns_to(volume: ArrayLike, coefficient: ArrayLike, sliding: ArrayLike) -> Floats:
    """Turns until a volume is worn away.

    Parameters
    ----------
    volume : array_like
        [m^3].
    coefficient : array_like
        Wear coefficient k [m^2/N].
    sliding : array_like
        Integral of load times speed over a turn [N m].

    Returns
    -------
    ndarray
        ``V / (k S)``; infinite where nothing slides.
    """
    with np.errstate(divide="ignore"):
        return np.asarray(np.divide(volume, np.multiply(coefficient, sliding)), dtype=np.float64)


def lognormal_quantile(median: ArrayLike, spread: float, share: ArrayLike) -> Floats:
    """Quantiles of a lognormal number.

    Parameters
    ----------
    median : array_like
    spread : float
        Geometric standard deviation, 1 or more.
    share : array_like
        Share below the quantile.

    Returns
    -------
    ndarray
        ``median * spread^z`` with the normal quantile z.
    """
    return np.asarray(median * spread ** special.ndtri(np.asarray(share, dtype=np.float64)), dtype=np.float64)


def drawn_factors(spread: float, seeds: int, joints: int) -> Floats:
    """Draw what multiplies the wear coefficient of each joint of some devices.

    Parameters
    ----------
    spread : float
        Geometric standard deviation.
    seeds : int
        Devices, with the seeds 0, 1, ...

    Returns
    -------
    ndarray, shape (seeds, joints)
        Of the median 1; each joint has its own.
    """
    draws = [np.random.default_rng([seed, joints]).standard_normal(joints) for seed in range(seeds)]
    return np.asarray(spread ** np.array(draws))


def first_shares(lives: Floats) -> Floats:
    """Share of the devices in which each joint fails first.

    Parameters
    ----------
    lives : ndarray, shape (devices, joints)
        Turns; infinite for a joint that does not wear.

    Returns
    -------
    ndarray, shape (joints,)
        Joints of one life share a device; the sum is that of the devices of which a joint fails.
    """
    first = lives == lives.min(axis=1, keepdims=True)
    first &= np.isfinite(lives)
    counted = first / np.maximum(first.sum(axis=1, keepdims=True), 1)
    return np.asarray(counted.mean(axis=0))
