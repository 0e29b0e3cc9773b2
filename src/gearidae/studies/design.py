r"""Designs of experiments: points of the unit cube, and values of the keys there.

A plain design draws every member on its own. The design for Sobol' indices (Saltelli et al. 2010,
doi:10.1016/j.cpc.2009.09.018) draws two independent matrices A and B of N rows, and for each key i a matrix
:math:`AB_i`, which is A with the column of that key taken from B: N (d + 2) members in all. Seeds, of populations and
of errors of teeth, are numbered from the scene's own on, and not drawn from a distribution.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from operator import attrgetter
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from gearidae.archive.specimen import SEED_KEYS
from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.runs.sweep_plan import MOST_RUNS
from gearidae.scene.group import shorten
from gearidae.scene.quantity import whole
from gearidae.studies.distributions import Distribution, read_distributions
from gearidae.studies.specimens import NEEDS, seeds_that_draw

if TYPE_CHECKING:
    from gearidae.scene import Scene

DESIGNS = ("sobol", "random")
SEEDS: Final = "seeds"
"""Text that stands for a distribution of a key of seeds."""
NO_INDEX: Final = (
    "A seed has no index, because it is no continuous input: the share of the variance that the keys leave over "
    "is the scatter between the gears of one design"
)
_MOST_DIMENSIONS = 21_201
"""Of Sobol' sequences whose direction numbers scipy has."""


@dataclass(frozen=True, slots=True)
class Design:
    """The members of an ensemble.

    Attributes
    ----------
    values : ndarray, shape (members, keys)
        In SI units.
    matrix : ndarray of str, shape (members,)
        ``A``, ``B``, or ``AB`` with the number of the key that is taken from B; empty in a plain design.
    row : ndarray of int64, shape (members,)
        Row of the matrix.
    """

    values: Floats
    matrix: NDArray[np.str_]
    row: NDArray[np.int64]

    @property
    def drawn(self) -> NDArray[np.bool_]:
        """Whether a member was drawn on its own, and is not a mixture of two others."""
        return np.array([not name.startswith("AB") for name in self.matrix.tolist()])


def check_design(size: int, design: str, seed: int, *, indices: bool) -> None:
    """Refuse designs that cannot be made.

    Parameters
    ----------
    size : int
        Number of rows.
    indices : bool
        Whether Sobol' indices are wanted.

    Raises
    ------
    SceneError
    """
    size = whole("size", size, 1, MOST_RUNS)
    if indices and (size < 2 or size & (size - 1)):
        raise SceneError("size", size, "must be a power of 2 for Sobol' indices, such as 256 or 1024")
    if design not in DESIGNS:
        raise SceneError("design", design, f"must be one of {', '.join(DESIGNS)}")
    whole("seed", seed, 0)


def plain_design(distributions: Sequence[Distribution], size: int, design: str, seed: int) -> Design:
    """Draw every member on its own.

    Parameters
    ----------
    size : int
        Number of members.
    design : {"sobol", "random"}
        Scrambled Sobol' points (doi:10.1016/0041-5553(67)90144-9), or pseudo-random ones.
    """
    points = _points(len(distributions), size, design, seed)
    return Design(_values(distributions, points), np.full(size, ""), np.arange(size, dtype=np.int64))


def pick_freeze_design(distributions: Sequence[Distribution], size: int, design: str, seed: int) -> Design:
    """Draw the matrices that Sobol' indices are estimated from.

    Parameters
    ----------
    size : int
        Rows N of each matrix, a power of 2.
    design, seed
        As for `plain_design`. Sobol' points are of twice as many dimensions as there are keys, so that A and B are
        independent.

    Returns
    -------
    Design
        Of N (d + 2) members: A, B, then each AB.
    """
    count = len(distributions)
    points = _points(2 * count, size, design, seed)
    first, second = (_values(distributions, part) for part in np.split(points, 2, axis=1))
    blocks, names = [first, second], ["A", "B"]
    for key in range(count):
        mixed = first.copy()
        mixed[:, key] = second[:, key]
        blocks.append(mixed)
        names.append(f"AB{key}")
    return Design(np.concatenate(blocks), np.repeat(names, size), np.tile(np.arange(size), len(blocks)))


def _points(dimensions: int, size: int, design: str, seed: int) -> Floats:
    """Points of the unit cube, shape (size, dimensions)."""
    from scipy.stats import qmc  # which takes half a second to load

    generator = np.random.default_rng(seed)
    if design == "random" or dimensions == 0:
        return generator.random((size, dimensions))
    if dimensions > _MOST_DIMENSIONS:
        raise SceneError(
            "vary", f"{dimensions} columns", f"must be at most {_MOST_DIMENSIONS} for Sobol' points"
        )
    # the first of the next power of two: the same points, whatever the number
    sequence = qmc.Sobol(dimensions, seed=generator)
    return np.asarray(sequence.random_base2((size - 1).bit_length())[:size], dtype=np.float64)


def _values(distributions: Sequence[Distribution], points: Floats) -> Floats:
    columns = [distribution.quantiles(points[:, number]) for number, distribution in enumerate(distributions)]
    return np.stack(columns, axis=1) if columns else points


def drawn_distributions(scene: Scene, vary: Mapping[str, Any]) -> tuple[Distribution, ...]:
    """Read the distributions of the keys of an ensemble: of all but seeds, which are numbered.

    Raises
    ------
    SceneError
        If a key is none of a number, what is given is no distribution, a seed is given one, or the scene draws nothing
        by a seed.
    """
    if not isinstance(vary, Mapping):
        return read_distributions(scene, vary)
    for key, text in vary.items():
        if text == SEEDS and key.startswith("meshes.") and key.endswith(".pitch_error_seed"):
            allowed = (
                "must be mesh.pitch_error_seed, the seed of all meshes; meshes.NAME.pitch_error_rms chooses those "
                "that are drawn"
            )
            raise SceneError("vary", key, allowed)
    if not any(key in vary for key in SEED_KEYS):
        return read_distributions(scene, vary)
    drawing = seeds_that_draw(scene)
    for key, allowed in NEEDS.items():
        if key in vary and vary[key] != SEEDS:
            numbered = f'must be "{SEEDS}": the seeds of the members are numbered from the scene\'s own on'
            raise SceneError(key, shorten(vary[key]), numbered)
        if key in vary and key not in drawing:
            raise SceneError(key, vary[key], allowed)
    others = {key: text for key, text in vary.items() if key not in SEED_KEYS}
    return read_distributions(scene, others) if others else ()


def seed_numbers(scene: Scene, drawn: Design, vary: Mapping[str, Any]) -> dict[str, NDArray[np.int64]]:
    """Seeds of the members of a design for each key of seeds that varies, shape (members,).

    Rows of the matrices A and B of a design for Sobol' indices have seeds of their own. A row of a matrix AB has the
    seed of the row of A, as it differs from it by one key alone.
    """
    rows = int(drawn.row.max()) + 1
    from_first = np.asarray(drawn.row + rows * (drawn.matrix == "B"), dtype=np.int64)
    return {key: attrgetter(key)(scene) + from_first for key in SEED_KEYS if key in vary}
