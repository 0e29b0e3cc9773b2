"""Sobol' indices of a figure from the runs of a pick-freeze design, with their own uncertainty."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from gearidae.arrays import Floats
from gearidae.errors import SceneError

RESAMPLES: Final = 200
"""Bootstrap samples of rows: the standard deviation of so many is known to 5 %."""
FEWEST: Final = 8
"""Rows that indices can be estimated from at all."""


_ROUNDING: Final = 1e-12
"""Of the largest figure: what varies by less is constant, and its indices would be those of rounding."""


class Indices(NamedTuple):
    """Sobol' indices of one figure.

    Attributes
    ----------
    first_order, total_order : ndarray, shape (keys,)
        Share of the figure's variance that a key makes alone, and with all its interactions [1].
    first_order_uncertainty, total_order_uncertainty : ndarray, shape (keys,)
        Standard uncertainty, from a bootstrap over the rows [1].
    rows : int
        Rows that they were estimated from.
    """

    first_order: Floats
    total_order: Floats
    first_order_uncertainty: Floats
    total_order_uncertainty: Floats
    rows: int


def indices_of(figures: Floats, keys: int, *, seed: int = 0) -> Indices:
    """Estimate the indices of one figure.

    Parameters
    ----------
    figures : ndarray, shape (N (keys + 2),)
        Of each member, in the order of `gearidae.studies.design.pick_freeze_design`; NaN where there is none.
    keys : int
        Number of keys.
    seed : int, optional
        Of the bootstrap.

    Returns
    -------
    Indices
        NaN if fewer than 8 rows are complete, or the figure does not vary. Of incomplete designs the first complete
        rows are used, as many as the largest power of 2 that there are.

    Raises
    ------
    SceneError
        If there are not as many figures as such a design has members.

    Notes
    -----
    `scipy.stats.sobol_indices` does the estimation: the first-order index by Saltelli et al. 2010
    (doi:10.1016/j.cpc.2009.09.018), Table 2 b, the total one by Jansen 1999 (f there).
    """
    if figures.ndim != 1 or figures.size % (keys + 2):
        raise SceneError("figures", f"(shape {figures.shape})", f"must be as many as rows times {keys + 2}")
    table = figures.reshape(keys + 2, -1)
    complete = np.flatnonzero(np.isfinite(table).all(axis=0))
    rows = 1 << (complete.size.bit_length() - 1) if complete.size else 0
    nothing = np.full(keys, np.nan)
    if rows < FEWEST:
        return Indices(nothing, nothing, nothing, nothing, rows)
    used = table[:, complete[:rows]]
    if np.ptp(used[:2]) <= _ROUNDING * np.abs(used[:2]).max():
        return Indices(nothing, nothing, nothing, nothing, rows)
    generator = np.random.default_rng(seed)
    drawn = [_estimate(used[:, generator.integers(0, rows, rows)]) for _ in range(RESAMPLES)]
    first, total = _estimate(used)
    spread_first, spread_total = np.std(drawn, axis=0, ddof=1)
    return Indices(first, total, spread_first, spread_total, rows)


def _estimate(table: Floats) -> Floats:
    """First-order and total indices, shape (2, keys), of the rows of A, B and each AB."""
    from scipy.stats import sobol_indices  # which takes half a second to load

    # scipy drops dimensions of length one, which a single key has: the figure stands there twice
    twice = {
        "f_A": np.stack([table[0]] * 2),
        "f_B": np.stack([table[1]] * 2),
        "f_AB": np.stack([table[2:]] * 2, axis=1),
    }
    indices = sobol_indices(func=twice, n=table.shape[1])
    keys = len(table) - 2
    return np.stack(
        [np.reshape(order, (2, keys))[0] for order in (indices.first_order, indices.total_order)]
    ).astype(np.float64)
