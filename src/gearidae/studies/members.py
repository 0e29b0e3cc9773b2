"""The runs of an ensemble: their scenes, and their results along one dimension ``member``."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from gearidae.analysis.verdict.codes import CODE_ATTRIBUTES, sticking, verdict_codes
from gearidae.errors import SceneError
from gearidae.runs.sweep_plan import SweepPlan
from gearidae.studies.design import SEEDS, Design, drawn_distributions, seed_numbers
from gearidae.studies.distributions import Distribution
from gearidae.studies.study import Rows

if TYPE_CHECKING:
    from gearidae.scene import Scene

Made = TypeVar("Made")

STICKS = {
    "long_name": "whether the gear sticks",
    "units": "1",
    "comment": "1 of the verdicts sticks and runs back, 0 of the others, NaN if unfinished",
}


@dataclass(frozen=True, slots=True)
class Members:
    """The members of an ensemble, drawn and not yet run.

    Attributes
    ----------
    plan : SweepPlan
        Their scenes.
    design : Design
    keys : tuple of str
        Those that have distributions.
    words : dict of str to str
        What each key is drawn from, seeds last.
    """

    plan: SweepPlan
    design: Design
    keys: tuple[str, ...]
    words: dict[str, str]

    @property
    def have_seeds(self) -> bool:
        """Whether the members differ in their seeds."""
        return len(self.words) > len(self.keys)


def draw_members(
    base: Scene, vary: Mapping[str, Any], draw: Callable[[Sequence[Distribution]], Design]
) -> Members:
    """Draw the keys of all members from their distributions, number their seeds, and make their scenes.

    Parameters
    ----------
    base : Scene
        What the runs have in common.
    vary : mapping of str to object
        Keys and their distributions, as for `gearidae.studies.ensemble`.
    draw : callable
        Makes a design of distributions; of none where seeds alone vary.

    Raises
    ------
    SceneError
        If a key or a distribution is not allowed, or a value that was drawn.
    """
    distributions = drawn_distributions(base, vary)
    design = draw(distributions)
    seeds = seed_numbers(base, design, vary)
    texts = names_of(distributions)
    words = texts | dict.fromkeys(seeds, SEEDS)
    values: dict[str, NDArray[Any]] = {**dict(zip(texts, design.values.T, strict=True)), **seeds}
    return Members(member_plan(base, values, words), design, tuple(texts), words)


def member_plan(base: Scene, values: Mapping[str, NDArray[Any]], drawn_from: Mapping[str, str]) -> SweepPlan:
    """Make the scenes of all members, before anything is run.

    Parameters
    ----------
    base : Scene
        What the runs have in common.
    values : mapping of str to ndarray, shape (members,)
        Of each key, in SI units.
    drawn_from : mapping of str to str
        The keys' distributions, for messages.

    Returns
    -------
    SweepPlan
        With one dimension, along which the keys are walked together.

    Raises
    ------
    SceneError
        If values are not allowed: distributions are not cut off on their own, as the result would be that of others.
    """
    columns = {key: column.tolist() for key, column in values.items()}
    scenes = drawn_members(base.replace, values, drawn_from)
    return SweepPlan(base, (columns,), scenes)


def drawn_members(
    make: Callable[[dict[str, float]], Made],
    values: Mapping[str, NDArray[Any]],
    drawn_from: Mapping[str, str],
) -> list[Made]:
    """Make something of the values of each member.

    Parameters
    ----------
    make : callable
        Called with the value of each key.
    values : mapping of str to ndarray, shape (members,)
        Of each key, in SI units.
    drawn_from : mapping of str to str
        The keys' distributions, for messages.

    Raises
    ------
    SceneError
        If values are not allowed.
    """
    made: list[Made] = []
    refused: list[SceneError] = []
    for row in zip(*(column.tolist() for column in values.values()), strict=True):
        try:
            made.append(make(dict(zip(values, row, strict=True))))
        except SceneError as error:
            refused.append(error)
    if refused:
        raise _refusal(refused, len(made) + len(refused), drawn_from)
    return made


def _refusal(refused: Sequence[SceneError], count: int, drawn_from: Mapping[str, str]) -> SceneError:
    """Say which distribution leaves the range of its key, and what to do about it."""
    first = refused[0]
    source = drawn_from.get(first.key)
    drawn = f"drawn from {source}" if source else f"where {', '.join(drawn_from)} are drawn"
    allowed = (
        f"{first.allowed} ({drawn}; {len(refused)} of {count} members are refused: "
        "cut the distribution off, as truncnormal(mean, standard deviation, lowest, highest) does)"
    )
    return SceneError(first.key, first.value, allowed)


def along_members(ds: xr.Dataset, keys: Sequence[str]) -> xr.Dataset:
    """Put runs that were walked together along the dimension ``member``, with their verdicts as numbers.

    Parameters
    ----------
    ds : Dataset
        Of a plan by `member_plan`.

    Returns
    -------
    Dataset
        With the coordinates ``member`` (from 0) and one for each key, ``verdict_code`` and ``sticks``.
    """
    (dim,) = map(str, ds["status"].dims)
    ds = ds.drop_indexes(dim).rename_dims({dim: "member"})
    numbers = np.arange(ds.sizes["member"], dtype=np.int64)
    codes = verdict_codes(ds["verdict"].values)
    about: dict[str, Any] = {"long_name": "number of the member", "units": "1"}
    return ds.assign_coords(member=("member", numbers, about)).assign(
        verdict_code=("member", codes, CODE_ATTRIBUTES), sticks=("member", sticking(codes), STICKS)
    )


def names_of(distributions: Sequence[Distribution]) -> dict[str, str]:
    """Distributions in words, by their keys."""
    return {distribution.key: distribution.text for distribution in distributions}


def count_rows(words: xr.DataArray) -> Rows:
    """Count the members of which words are true, the most frequent first; `words` are those of some or all of them."""
    for word, count in Counter(words.values.tolist()).most_common():
        yield str(word), str(count), f"{100.0 * count / words.size:.3g} % of the members"
