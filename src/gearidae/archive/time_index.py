"""Look-up of sample times that stay in the file.

xarray's usual index holds every label in memory, twice while it is made: of a run of 30 million samples, half a
gigabyte before any request. Sample times increase, so that a label is found by bisection in the file, from
some twenty of its chunks. A part that is picked out and small enough gets the usual index again.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Hashable, Iterable, Mapping
from typing import Any, Self

import numpy as np
import pandas as pd
import xarray as xr
from xarray.core.indexing import IndexSelResult
from xarray.indexes import PandasIndex

from gearidae.scene.carried import numbers_of

LARGEST_IN_MEMORY = 2**20
"""Labels that an index may hold in memory."""


class TimeIndex(xr.Index):
    """Index of a one-dimensional coordinate that increases, wherever its values are.

    Parameters
    ----------
    name : hashable
        Of the coordinate and of its dimension.
    times : xarray.Variable
        Its values, not necessarily in memory.
    """

    def __init__(self, name: Hashable, times: xr.Variable) -> None:
        self._name = name
        self._times = times

    @classmethod
    def from_variables(cls, variables: Mapping[Any, xr.Variable], *, options: Mapping[str, Any]) -> Self:
        """Make the index of one coordinate."""
        ((name, times),) = variables.items()
        return cls(name, times)

    def create_variables(self, variables: Mapping[Any, xr.Variable] | None = None) -> dict[Any, xr.Variable]:
        """Return the coordinate."""
        return {self._name: self._times}

    def to_pandas_index(self) -> pd.Index:
        """Read all labels."""
        return pd.Index(self._times.values, name=self._name)

    def isel(self, indexers: Mapping[Any, Any]) -> xr.Index | None:
        """Keep the index of a part: the usual one if it is small, none of a single sample or one turned round."""
        picked = indexers[self._name]
        if isinstance(picked, xr.Variable):
            if picked.dims != self._times.dims:
                return None  # the labels lie along another dimension from here on
            picked = picked.values
        if not isinstance(picked, slice):
            return PandasIndex(self._times[picked].values, self._name) if np.ndim(picked) else None
        if (picked.step or 1) < 0:
            return None
        part = self._times[picked]
        if part.size > LARGEST_IN_MEMORY:
            return TimeIndex(self._name, part)
        return PandasIndex(part.values, self._name)

    def sel(self, labels: dict[Any, Any], method: Any = None, tolerance: Any = None) -> IndexSelResult:
        """Find labels: a slice with both ends included, single times, or lists of them, as the usual index does.

        Raises
        ------
        KeyError
            If a time is not in the coordinate and no `method` is given.
        ValueError
            If the method is not known, or a slice has a step.
        """
        ((_, label),) = labels.items()
        if isinstance(label, slice):
            if label.step is not None:
                raise ValueError("a slice of times takes no step")
            first = 0 if label.start is None else self._before(float(label.start))
            last = self._times.size if label.stop is None else self._after(float(label.stop))
            return IndexSelResult({self._name: slice(first, last)})
        wanted = label.variable if isinstance(label, xr.DataArray) else label
        values = numbers_of(wanted, "s")
        indices = np.array(
            [self._index_of(float(time), method, tolerance) for time in values.ravel()], dtype=np.int64
        )
        chosen: Any = indices.reshape(values.shape)
        if isinstance(wanted, xr.Variable):
            chosen = xr.Variable(wanted.dims, chosen)
        return IndexSelResult({self._name: chosen if values.ndim else int(indices[0])})

    def equals(self, other: xr.Index, *, exclude: frozenset[Hashable] | None = None) -> bool:
        """Whether another index has the same labels."""
        if not isinstance(other, TimeIndex):
            return False
        return self._times is other._times or bool(self._times.equals(other._times))  # type: ignore[no-untyped-call]

    def join(self, other: xr.Index, how: str = "inner") -> TimeIndex:
        """Find the labels of both indexes (``inner``), or of either (``outer``); these are kept in memory."""
        ours, theirs = self.to_pandas_index(), other.to_pandas_index()
        both = ours.intersection(theirs) if how == "inner" else ours.union(theirs)
        times = xr.Variable(self._times.dims, np.sort(both.to_numpy()), self._times.attrs)
        return type(self)(self._name, times)

    def reindex_like(
        self, other: Self, method: Any = None, tolerance: Any = None
    ) -> dict[Hashable, np.ndarray[Any, Any]]:
        """Find the positions of another index's labels; -1 where a label is not there."""
        labels = other.to_pandas_index()
        return {self._name: self.to_pandas_index().get_indexer(labels, method=method, tolerance=tolerance)}

    def __repr__(self) -> str:
        """Say what it is and, for xarray's message where two kinds of index meet, how to get the usual one."""
        size = self._times.size
        return (
            f'TimeIndex({size} times, in their file; ds.drop_indexes("time").set_xindex("time") reads them)'
        )

    def rename(self, name_dict: Mapping[Any, Hashable], dims_dict: Mapping[Any, Hashable]) -> Self:
        """Give the coordinate another name."""
        times = self._times.copy(deep=False)
        times.dims = (dims_dict.get(self._name, self._name),)
        return type(self)(name_dict.get(self._name, self._name), times)

    def _at(self, index: int) -> float:
        return float(self._times[index].values)

    def _before(self, wanted: float) -> int:
        """Position of the first label that is not smaller."""
        return bisect_left(range(self._times.size), wanted, key=self._at)

    def _after(self, wanted: float) -> int:
        """Position of the first label that is larger."""
        return bisect_right(range(self._times.size), wanted, key=self._at)

    def _index_of(self, wanted: float, method: str | None, tolerance: float | None) -> int:
        """Position of one label."""
        if method not in _METHODS:
            raise ValueError(f"method must be one of {', '.join(filter(None, _METHODS))}")
        after = self._before(wanted)
        around: Iterable[int] = (after - 1, after)
        if after < self._times.size and self._at(after) == wanted:
            around = (after,)
        elif method is None:
            around = ()
        elif _METHODS[method] is not None:
            around = (after + int(_METHODS[method] or 0),)
        inside = [index for index in around if 0 <= index < self._times.size]
        if tolerance is not None:
            inside = [index for index in inside if abs(self._at(index) - wanted) <= tolerance]
        if not inside:
            raise KeyError(wanted)
        return min(inside, key=lambda index: (abs(self._at(index) - wanted), -index))


_METHODS: dict[str | None, int | None] = {
    None: None, "nearest": None, "pad": -1, "ffill": -1, "backfill": 0, "bfill": 0
}  # fmt: skip
"""What to take where a label is not there: its neighbour below (-1) or above (0), or the nearer one."""


def with_times(ds: xr.Dataset, times: xr.Variable) -> xr.Dataset:
    """Add sample times to a dataset without reading them."""
    return ds.assign_coords(xr.Coordinates({"time": times}, indexes={"time": TimeIndex("time", times)}))


def in_memory(ds: xr.Dataset) -> xr.Dataset:
    """Read a dataset whole, and give it the usual index."""
    ds.load()
    if "time" in ds.xindexes and isinstance(ds.xindexes["time"], TimeIndex):
        return ds.drop_indexes("time").set_xindex("time")
    return ds
