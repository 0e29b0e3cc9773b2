"""Loss laws whose parameters are drawn from distributions: keys such as ``law.energy``."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, replace
from typing import Annotated, Any, Final

import numpy as np
from numpy.typing import NDArray

from gearidae.errors import SceneError
from gearidae.scene.group import did_you_mean, shorten
from gearidae.scene.pairs import assignments
from gearidae.studies.distributions import read_distribution
from gearidae.studies.members import drawn_members
from gearidae.studies.study import Option
from gearidae.wear import Arrhenius, LossLaw, loss_law
from gearidae.wear.registry import loss_law_units

_LAW: Final = "law."

LawName = Annotated[str, Option("Loss law: contacts, adhesion_work, sliding_work or friction_work.")]
_PARAMETER = Option("Parameter of the law, such as energy='2 J/m^2'; repeatable.", repeatable=True)
LawParameters = Annotated[list[str], _PARAMETER]
OtherParameters = Annotated[list[str] | None, _PARAMETER]
ArrheniusFactor = Annotated[
    list[str] | None,
    Option(
        "Factor of Arrhenius: activation_energy, activation_volume and temperature; repeatable.",
        repeatable=True,
    ),
]


def written_law(
    name: str, parameters: Sequence[str], arrhenius: Sequence[str], vary: Mapping[str, Any]
) -> LossLaw:
    """Make the loss law of a command line, of texts ``name=value``; parameters that are drawn may be missing."""
    law = law_of_medians(name, assignments(parameters, "--parameter", "energy=2 J/m^2"), vary)
    if not arrhenius:
        return law
    values = assignments(arrhenius, "--arrhenius", "activation_energy=1 eV")
    known = ("activation_energy", "activation_volume", "temperature")
    if sorted(values) != sorted(known):
        raise SceneError("--arrhenius", ", ".join(values), "needs " + ", ".join(known))
    return Arrhenius(law, **values)


def name_of(law: LossLaw) -> str:
    """Return the name of a law, or of the one that a factor of Arrhenius stands before."""
    return law.law.name if isinstance(law, Arrhenius) else law.name


def law_of_medians(name: str, parameters: Mapping[str, Any], vary: Mapping[str, Any]) -> LossLaw:
    """Make a loss law of which some parameters are drawn.

    Parameters
    ----------
    name : str
        One of `gearidae.wear.loss_law_names`.
    parameters : mapping of str to object
        SI numbers, or texts with a unit.
    vary : mapping of str to object
        Keys and their distributions. A parameter that has one, as ``law.`` and its name, and none in `parameters` is
        its median.

    Raises
    ------
    SceneError
        If there is no such law, or its parameters are others.
    """
    middle = np.array([0.5])
    medians = {
        parameter: float(
            read_distribution(_LAW + parameter, vary[_LAW + parameter], unit).quantiles(middle)[0]
        )
        for parameter, unit in loss_law_units(name).items()
        if parameter not in parameters and _LAW + parameter in vary
    }
    return loss_law(name, **medians, **parameters)


def parameter_units(law: LossLaw) -> Callable[[str, Any], str | None]:
    """Say which unit the parameters of a law have, for `read_distributions`.

    Parameters
    ----------
    law : LossLaw
        Its own parameters, and those of a law that it is a factor of.

    Returns
    -------
    callable
        Called with a key and its value: the unit of a parameter, None of what does not begin with ``law.``; raises
        `SceneError` of what is none of its parameters.
    """
    units = _units(law)

    def unit_of(key: str, value: Any) -> str | None:
        if not key.startswith(_LAW):
            return None
        name = key.removeprefix(_LAW)
        if name not in units:
            known = [f"{_LAW}{parameter}" for parameter in units]
            meant = did_you_mean(key, known)
            allowed = f"is no parameter of the loss law {law.name}; it has {', '.join(known)}"
            raise SceneError(key, shorten(value), f"{allowed}{'; ' if meant else ''}{meant}")
        return units[name]

    return unit_of


def drawn_laws(
    law: LossLaw, values: Mapping[str, NDArray[np.float64]], size: int, drawn_from: Mapping[str, str]
) -> list[LossLaw]:
    """Make the laws of all members.

    Parameters
    ----------
    law : LossLaw
        What they have in common.
    values : mapping of str to ndarray, shape (members,)
        Of each key, in SI units; those that begin with ``law.`` are taken.
    size : int
        Number of members.
    drawn_from : mapping of str to str
        The keys' distributions, for messages.

    Raises
    ------
    SceneError
        If values are not allowed.
    """
    columns = {key: column for key, column in values.items() if key.startswith(_LAW)}
    if not columns:
        return [law] * size

    def make(drawn: dict[str, float]) -> LossLaw:
        try:
            return _changed(law, {key.removeprefix(_LAW): value for key, value in drawn.items()})
        except SceneError as error:
            name = error.key.rpartition(".")[2]
            raise SceneError(f"{_LAW}{name}", error.value, error.allowed) from None

    return drawn_members(make, columns, drawn_from)


def _units(law: LossLaw) -> dict[str, str]:
    """Units of the parameters of a law and of those within it; the outer ones go before."""
    units: dict[str, str] = {}
    for value in (getattr(law, field.name) for field in fields(law)):
        if isinstance(value, LossLaw):
            units |= _units(value)
    return units | law.parameter_units()


def _changed(law: LossLaw, values: Mapping[str, float]) -> LossLaw:
    """Change parameters of a law, and those that it has not of the law within it."""
    changes = {field.name: values[field.name] for field in fields(law) if field.name in values}
    rest = {name: value for name, value in values.items() if name not in changes}
    within = {field.name: getattr(law, field.name) for field in fields(law)} if rest else {}
    inner = {name: _changed(value, rest) for name, value in within.items() if isinstance(value, LossLaw)}
    return replace(law, **changes, **inner)
