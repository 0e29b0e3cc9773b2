"""Pick a part of a dataset by the values of its dimensions, as ``--select`` and ``--line`` ask for."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from gearidae.errors import SceneError
from gearidae.scene.pairs import assignments

_MOST_SHOWN = 20


def selected(ds: xr.Dataset, pairs: Sequence[str], option: str, dims: Sequence[str]) -> xr.Dataset:
    """Pick a part of a dataset.

    Parameters
    ----------
    pairs : sequence of str
        ``dimension=value``.
    option : str
        That they were given with, for errors.
    dims : sequence of str
        Dimensions that a value may be picked of.

    Returns
    -------
    xarray.Dataset
        Without the dimensions of `pairs`.

    Raises
    ------
    SceneError
        If there is no such dimension or value, naming those that there are.
    """
    if not pairs:
        return ds
    for dim, value in assignments(pairs, option, "sam_fraction=0.5").items():
        if dim not in dims:
            known = f"must be one of {', '.join(dims)}" if dims else "there is nothing to select from"
            raise SceneError(option, dim, known)
        labels = ds[dim].values
        numeric = np.issubdtype(labels.dtype, np.number) and isinstance(value, int | float)
        # a value as it is printed is not always the same float
        matches = (
            np.isclose(labels, value, rtol=1e-9, atol=0.0) if numeric else labels.astype(str) == str(value)
        )
        if not matches.any():
            shown = ", ".join(f"{label:g}" if numeric else str(label) for label in labels[:_MOST_SHOWN])
            raise SceneError(f"{option} {dim}", value, f"must be one of {shown}")
        ds = ds.isel({dim: int(np.flatnonzero(matches)[0])})
    return ds
