"""The asperity laws by their names: the values of ``contact.asperity``.

Every file of this folder that registers a law is found automatically. Each process that uses a law from elsewhere has
to register it before it makes scenes that name it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
from typing import Final, NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from gearidae.arrays import Floats
from gearidae.asperities.base import AsperityLaw
from gearidae.asperities.tip import Asperity, Surface, asperity_of, make_tip
from gearidae.errors import SceneError
from gearidae.registry import Registry

Law = TypeVar("Law", bound=type[AsperityLaw])

_LAWS: Final = Registry[type[AsperityLaw]]("gearidae.asperities", "contact.asperity", "asperity law")


def register(law: Law) -> Law:
    """Register a law by its name; a decorator of its class.

    Parameters
    ----------
    law : type of AsperityLaw

    Returns
    -------
    type of AsperityLaw
        The same.

    Raises
    ------
    SceneError
        If another law has this name already.
    """
    _LAWS.add(law.name, law)
    return law


def unregister(name: str) -> None:
    """Remove a law.

    Parameters
    ----------
    name : str

    Raises
    ------
    SceneError
        If there is no such law.
    """
    _LAWS.remove(name)


def law_names() -> tuple[str, ...]:
    """Return the names of all laws in alphabetical order."""
    return _LAWS.names()


def law_class(name: str) -> type[AsperityLaw]:
    """Return the class of a law, which says what it needs, where it was published and whether it has an area.

    Parameters
    ----------
    name : str
        The law's name.

    Raises
    ------
    SceneError
        If there is no such law.
    """
    return _LAWS.find(name)


def law_of_tip(name: str, tip: Asperity, unit: float) -> AsperityLaw:
    """Return a law for one tip, in a unit of length.

    Parameters
    ----------
    name : str
        The law's name.
    tip : Asperity
        The tip (SI).
    unit : float
        Unit of length [m]. With 1.0 loads are in units of ``tip.hertz_factor`` newtons.

    Raises
    ------
    SceneError
        If there is no such law, or it fails.
    """
    law = law_class(name)
    with _naming(law, "of"):
        made = law.of(tip, unit)
    if not isinstance(made, AsperityLaw):
        raise SceneError(
            "contact.asperity", name, f"{law.__qualname__}.of must return an AsperityLaw, not {made!r}"
        )
    with _naming(law, "__hash__"):  # equal laws share their tables
        hash(made)
    _try_out(made)
    return made


class TipLaw(NamedTuple):
    """Law of a tip in a unit of length of its own; this unit [m] and that of its load [N]."""

    law: AsperityLaw
    length: float
    load: float


def tip_law(name: str, surface: Surface, radius: float) -> TipLaw:
    """Return the law of an asperity of a surface with a radius of its own.

    Parameters
    ----------
    name : str
        The law's name.
    surface : Surface
        Elastic constants, energy and roughness (SI).
    radius : float
        Of the tip [m].

    Returns
    -------
    TipLaw
        Its unit of length is the stretch limit, and the roughness where nothing adheres.

    Raises
    ------
    SceneError
        As `law_of_tip`.
    """
    tip = asperity_of(surface, radius)
    length = tip.stretch_limit if tip.stretch_limit > 0.0 else surface.roughness
    return TipLaw(law_of_tip(name, tip, length), length, tip.hertz_factor * length**1.5)


@lru_cache(maxsize=32)
def _try_out(law: AsperityLaw) -> None:
    """Call what a law must give, so that one that fails is named here and not somewhere in a table."""
    for function in ("join", "detach", "pull_off"):
        with _naming(type(law), function):
            float(getattr(law, function))
    with _naming(type(law), "load"):
        np.asarray(law.load(np.zeros(1)), np.float64).reshape(1)


@contextmanager
def _naming(law: type[AsperityLaw], function: str) -> Iterator[None]:
    """Name the law, which may be the user's own, and its function in whatever goes wrong in it."""
    try:
        yield
    except SceneError:
        raise
    except Exception as error:
        failed = f"{law.__qualname__}.{function} fails: {error!r}"
        raise SceneError("contact.asperity", law.name, failed) from error


def law_of(name: str, surface: Surface) -> AsperityLaw:
    """Return a law for the asperities of a surface, in units of its roughness.

    Parameters
    ----------
    name : str
        The law's name.
    surface : Surface
        Elastic constants, energy and roughness (SI).

    Returns
    -------
    AsperityLaw
        Lengths in roughnesses sigma, loads in ``4/3 E* sqrt(beta) sigma^1.5``.

    Raises
    ------
    SceneError
        If there is no such law.
    """
    return law_of_tip(name, asperity_of(surface), surface.roughness)


def asperity(name: str, *, tabor: float = 5.0) -> AsperityLaw:
    """Return the law of one asperity in the units of adhesion.

    Parameters
    ----------
    name : str
        The law's name, such as ``jkr``, ``dmt``, ``hertz`` or ``maugis``.
    tabor : float, optional
        Tabor's parameter, see `gearidae.contact.tabor_parameter`; for laws in which the adhesive forces have a range.

    Returns
    -------
    AsperityLaw
        With `join`, `detach`, `pull_off`, `loss`, and ``load(displacement)`` on the stable branch: lengths over
        ``(pi^2 dgamma^2 beta / K^2)^(1/3)`` with ``K = 4 E*/3``, loads over ``pi beta dgamma``, losses over both.

    Raises
    ------
    SceneError
        If there is no such law, or Tabor's parameter is not a positive number.

    References
    ----------
    D. Maugis, J. Colloid Interface Sci. 150 (1992) 243-269, doi:10.1016/0021-9797(92)90285-T.
    """
    # K = 1, beta = 1 and pi dgamma = 1: the units are those of this tip
    if not 0.0 < tabor < math.inf:
        raise SceneError("tabor", tabor, "must be a positive number")
    modulus, adhesion = 0.75, 1.0 / math.pi
    reach = (adhesion / modulus) ** (2.0 / 3.0) / tabor
    return law_of_tip(name, make_tip(modulus, 1.0, adhesion, reach), 1.0)


def asperity_load(displacement: ArrayLike, asperity: Asperity, law: str = "jkr") -> Floats:
    """Load of one asperity in contact, in newtons.

    Parameters
    ----------
    displacement : array_like
        Displacement delta [m], positive in compression.
    asperity : Asperity
        The tip.
    law : str, optional
        Name of the law. ``jkr``: stretches down to ``-dc``. ``dmt``: Hertz minus ``2 pi beta dgamma`` while delta >= 0,
        no stretch. ``hertz``: ``4/3 E* sqrt(beta) delta^1.5`` while delta >= 0.

    Returns
    -------
    ndarray
        Load [N], positive pushes apart, the shape of `displacement`; zero where the asperity is out of reach.

    Raises
    ------
    SceneError
        If there is no such law.
    """
    return np.asarray(asperity.hertz_factor * law_of_tip(law, asperity, 1.0).load(displacement))
