"""Distributions of keys: frozen ones of scipy.stats, or texts with units such as ``normal(450 nm, 50 nm)``."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np

from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.scene.carried import carried_unit, numbers_of
from gearidae.scene.group import did_you_mean, shorten
from gearidae.scene.keys import find_key
from gearidae.scene.units import from_text, refuse_bare

if TYPE_CHECKING:
    from gearidae.scene import Scene

_CALL: Final = re.compile(r"\s*(\w+)\s*\((.*)\)\s*", re.DOTALL)
_FIXED: Final = ("run.duration", "run.samples")
_EDGE: Final = 2.0**-53
"""Probabilities stay this far within 0 and 1: of an unbounded distribution those have no finite value."""


class _Kind(NamedTuple):
    """A distribution that can be written as a text."""

    arguments: tuple[str, ...]
    pure: tuple[int, ...]
    """Places of arguments that are pure numbers, not of the key's unit."""
    spread: tuple[int, ...]
    """Places of arguments that are differences of two values: a standard deviation in degC is one in K."""
    sound: Callable[..., bool]
    rule: str
    frozen: Callable[..., Any]


def _stats() -> Any:
    from scipy import stats

    return stats


KINDS: Final[Mapping[str, _Kind]] = {
    "normal": _Kind(
        ("mean", "standard deviation"),
        (),
        (1,),
        lambda mean, deviation: deviation > 0.0,
        "a standard deviation above 0",
        lambda mean, deviation: _stats().norm(mean, deviation),
    ),
    "truncnormal": _Kind(
        ("mean", "standard deviation", "lowest", "highest"),
        (),
        (1,),
        lambda mean, deviation, low, high: deviation > 0.0 and low < high,
        "a standard deviation above 0 and lowest below highest",
        lambda mean, deviation, low, high: _stats().truncnorm(
            (low - mean) / deviation, (high - mean) / deviation, mean, deviation
        ),
    ),
    "uniform": _Kind(
        ("lowest", "highest"),
        (),
        (),
        lambda low, high: low < high,
        "lowest below highest",
        lambda low, high: _stats().uniform(low, high - low),
    ),
    "lognormal": _Kind(
        ("median", "geometric standard deviation"),
        (1,),
        (),
        lambda median, factor: median > 0.0 and factor > 1.0,
        "a median above 0 and a geometric standard deviation above 1, a pure number",
        lambda median, factor: _stats().lognorm(math.log(factor), scale=median),
    ),
}
"""Names of texts. 68 % of a lognormal lie between the median divided by, and times, its geometric deviation."""


@dataclass(frozen=True, slots=True)
class Distribution:
    """What the values of one key are drawn from.

    Attributes
    ----------
    key : str
        Dotted key of the scene, or parameter of a law.
    text : str
        The distribution in words.
    frozen : object
        Its quantiles are ``frozen.ppf(probability)``, in SI units.
    unit : str
        That SI unit.
    """

    key: str
    text: str
    frozen: Any
    unit: str = "1"

    def quantiles(self, probability: Floats) -> Floats:
        """Values [SI] below which a share of the distribution lies.

        Parameters
        ----------
        probability : ndarray, shape (n,)
            Between 0 and 1.

        Returns
        -------
        ndarray, shape (n,)

        Raises
        ------
        SceneError
            If they are no finite numbers.
        """
        inside = np.clip(probability, _EDGE, 1.0 - _EDGE)
        values = numbers_of(self.frozen.ppf(inside), self.unit)
        if values.shape != probability.shape or not np.isfinite(values).all():
            raise SceneError(self.key, self.text, "must be a distribution of finite numbers, one at a time")
        return values

    def log_density(self, values: Floats) -> Floats:
        """Logarithm of the density [1/SI]; -inf outside its support.

        Raises
        ------
        SceneError
            If the distribution has no density.
        """
        if not callable(getattr(self.frozen, "logpdf", None)):
            raise SceneError(self.key, self.text, "must have a density: a continuous distribution")
        return np.asarray(self.frozen.logpdf(values), dtype=np.float64)


def read_distributions(
    scene: Scene, vary: Mapping[str, Any], others: Callable[[str, Any], str | None] | None = None
) -> tuple[Distribution, ...]:
    """Read the distributions of some keys.

    Parameters
    ----------
    scene : Scene
        Whose keys they are.
    vary : mapping of str to object
        Dotted key to a frozen distribution of scipy.stats in SI units (anything with a method ``ppf``), or a text, see
        `KINDS`.
    others : callable, optional
        Called with a key and its value: the unit of a name that is no key of the scene, None for a possible key.

    Returns
    -------
    tuple of Distribution

    Raises
    ------
    SceneError
        If a key is none of a number, or what is given is no distribution.
    """
    if not isinstance(vary, Mapping) or not vary:
        allowed = 'must be a table of keys and distributions, {"surface.energy": "lognormal(1.5 J/m^2, 1.2)"}'
        raise SceneError("vary", shorten(vary), allowed)
    distributions = []
    for key, value in vary.items():
        unit = None if others is None else others(key, value)
        distributions.append(
            read_distribution(key, value, _unit_of(scene, key, value) if unit is None else unit)
        )
    return tuple(distributions)


def _unit_of(scene: Scene, key: str, value: Any) -> str:
    """Return the unit of a key of the scene that can be drawn."""
    info = find_key(type(scene), key, value)
    if not info.unit:
        raise SceneError(key, shorten(value), "is no key of a number: a distribution needs one")
    if key in _FIXED:
        raise SceneError(key, shorten(value), "cannot be drawn: all runs take the same time")
    return info.unit


def read_distribution(key: str, value: Any, unit: str) -> Distribution:
    """Read one distribution, as for `read_distributions`, of a key whose SI unit is known."""
    if isinstance(value, str):
        return Distribution(key, " ".join(value.split()), _of_text(key, value, unit), unit)
    if not callable(getattr(value, "ppf", None)):
        allowed = f"must be a frozen distribution of scipy.stats, or a text: {_known()}"
        raise SceneError(key, shorten(value), allowed)
    arguments = (*getattr(value, "args", ()), *getattr(value, "kwds", {}).values())
    if any(carried_unit(argument)[0] for argument in arguments):
        raise SceneError(
            key, shorten(value), "carries units, which scipy.stats loses: give numbers in SI units"
        )
    return Distribution(key, _described(value), value, unit)


def _of_text(key: str, text: str, unit: str) -> Any:
    """Make the frozen distribution that a text names."""
    match = _CALL.fullmatch(text) if len(text) <= 200 else None
    if match is None:
        raise SceneError(key, shorten(text), f"must be one of {_known()}")
    name, inside = match[1].lower(), match[2]
    if name not in KINDS:
        meant = did_you_mean(name, KINDS)
        raise SceneError(key, shorten(text), f"must be one of {_known()}{'; ' if meant else ''}{meant}")
    kind = KINDS[name]
    parts = [part.strip() for part in inside.split(",")]
    form = _form(name)
    if len(parts) != len(kind.arguments):
        raise SceneError(
            key, shorten(text), f"must be {form}: {len(kind.arguments)} values, not {len(parts)}"
        )
    numbers = []
    for index, part in enumerate(parts):
        try:
            part_unit = "1" if index in kind.pure else unit
            numbers.append(_number(part, part_unit, difference=index in kind.spread))
        except ValueError as error:
            raise SceneError(key, shorten(text), f"{kind.arguments[index]} {error}") from None
    try:
        refuse_bare(part for index, part in enumerate(parts) if index not in kind.pure)
    except ValueError as error:
        raise SceneError(key, shorten(text), str(error)) from None
    if not all(map(math.isfinite, numbers)) or not kind.sound(*numbers):
        raise SceneError(key, shorten(text), f"must be {form} with {kind.rule}")
    return kind.frozen(*numbers)


def _number(text: str, unit: str, *, difference: bool) -> float:
    """Read a number in SI or one with a unit."""
    try:
        return float(text)
    except ValueError:
        return from_text(text, unit, difference=difference)


def _form(name: str) -> str:
    return f"{name}({', '.join(KINDS[name].arguments)})"


def _known() -> str:
    return ", ".join(map(_form, KINDS))


def _described(frozen: Any) -> str:
    """Write a frozen distribution with its parameters."""
    family = getattr(getattr(frozen, "dist", frozen), "name", type(frozen).__name__)
    texts = [f"{value:g}" for value in getattr(frozen, "args", ())]
    texts += [f"{name}={value:g}" for name, value in getattr(frozen, "kwds", {}).items()]
    return f"{family}({', '.join(texts)})"
