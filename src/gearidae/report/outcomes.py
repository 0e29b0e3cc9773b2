"""Outcomes of the runs of a dataset for the scripts of a page: what was swept, and the verdict of each run."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from gearidae.analysis.verdict import outcomes
from gearidae.archive.select import swept_dims
from gearidae.archive.value_text import value_text
from gearidae.plot.outcome import style_of

_SIGNS = {"o": "●", "X": "✕", "D": "◆", "^": "▲", "v": "▼", "<": "◀", "s": "■", "P": "✚"}
"""The marks of matplotlib as characters."""


def ascending(ds: xr.Dataset) -> xr.Dataset:
    """Put the runs of a sweep in the order in which sliders and maps show them: numbers from small to large."""
    return ds.isel(_order(ds))


def numbers_ascending(ds: xr.Dataset) -> list[int]:
    """Number that each run of `ascending` has among the runs of the dataset; the last dimension changes fastest."""
    order = _order(ds)
    sizes = [len(positions) for positions in order.values()]
    numbers = np.arange(math.prod(sizes)).reshape(sizes)
    return [int(number) for number in np.ravel(numbers[np.ix_(*order.values())])]


def _order(ds: xr.Dataset) -> dict[str, NDArray[np.intp]]:
    """Order of the values along each swept dimension; what has no numbers stays as it is."""
    return {
        dim: np.argsort(ds[dim].values, kind="stable")
        if np.issubdtype(ds[dim].dtype, np.number)
        else np.arange(ds.sizes[dim])
        for dim in swept_dims(ds)
    }


def pack_outcomes(ds: xr.Dataset) -> dict[str, Any]:
    """Pack what was swept and how each run ended.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run or a sweep, from `ascending`.

    Returns
    -------
    dict
        ``dims``: for each dimension its ``name`` and the ``values`` in words, with those of keys that were walked
        together; ``styles``: ``word``, ``colour`` and ``sign`` of each verdict; ``verdicts``: which of them each run
        has, the last dimension fastest; ``words``: what each run did.
    """
    judged = outcomes(ds)
    verdicts = list(dict.fromkeys(outcome.verdict for outcome in judged))
    styles = [style_of(verdict) for verdict in verdicts]
    return {
        "dims": [{"name": dim.replace("_", " "), "values": _values(ds, dim)} for dim in swept_dims(ds)],
        "looks": [
            {"word": verdict, "colour": style.colour, "sign": _SIGNS[style.marker]}
            for verdict, style in zip(verdicts, styles, strict=True)
        ],
        "verdicts": [verdicts.index(outcome.verdict) for outcome in judged],
        "words": [outcome.words for outcome in judged],
    }


def _values(ds: xr.Dataset, dim: str) -> list[str]:
    """Values along a dimension, with the names and values of the keys that were walked together with its own."""
    others = [name for name in ds.coords if name != dim and ds[name].dims == (dim,)]
    texts = [
        [value_text(value, _unit(ds[name])) for value in ds[name].values.tolist()] for name in (dim, *others)
    ]
    return [
        ", ".join([own, *(f"{name} {text}" for name, text in zip(others, rest, strict=True))])
        for own, *rest in zip(*texts, strict=True)
    ]


def _unit(values: xr.DataArray) -> str:
    return str(values.attrs.get("units", "1"))
