"""The loss laws by their names: the values of ``gearidae life --law``."""

from __future__ import annotations

from dataclasses import fields
from typing import Any, Final, TypeVar

from gearidae.errors import SceneError
from gearidae.references import Reference
from gearidae.registry import Registry
from gearidae.wear.base import LossLaw

Law = TypeVar("Law", bound=type[LossLaw])

_LAWS: Final = Registry[type[LossLaw]]("gearidae.wear", "law", "loss law")


def register_loss(law: Law) -> Law:
    """Register a loss law by its name; a decorator of its class.

    Raises
    ------
    SceneError
        If another law has this name already.
    """
    _LAWS.add(law.name, law)
    return law


def unregister_loss(name: str) -> None:
    """Remove a law.

    Raises
    ------
    SceneError
        If there is no such law.
    """
    _LAWS.remove(name)


def loss_law_names() -> tuple[str, ...]:
    """Return the names of all loss laws in alphabetical order."""
    return _LAWS.names()


def loss_law_units(name: str) -> dict[str, str]:
    """Return the SI units of the parameters of a loss law.

    Raises
    ------
    SceneError
        If there is no such law.
    """
    return _LAWS.find(name).parameter_units()


def loss_law_references(name: str) -> tuple[Reference, ...]:
    """Return the publications of a loss law; none of a law that is not registered in this process."""
    return _LAWS.find(name).references if name in _LAWS.names() else ()


def loss_law(name: str, **parameters: Any) -> LossLaw:
    """Make a loss law with its parameters.

    Parameters
    ----------
    name : str
        One of `loss_law_names`.
    **parameters
        SI numbers, or texts with a unit.

    Returns
    -------
    LossLaw

    Raises
    ------
    SceneError
        If there is no such law, or a parameter is unknown, missing or out of range.

    Examples
    --------
    >>> import gearidae as gd
    >>> gd.wear.loss_law("adhesion_work", energy="2 J/m^2").energy
    2.0
    """
    kind = _LAWS.find(name)
    known = {field.name: field for field in fields(kind)}
    for key, value in parameters.items():
        if key not in known:
            raise SceneError(f"{name}.{key}", value, "is no parameter of it; it takes " + ", ".join(known))
    for key, field in known.items():
        if key not in parameters:
            raise SceneError(f"{name}.{key}", "(missing)", f"is required: {field.metadata['description']}")
    return kind(**parameters)
