"""Probability of sticking from an ensemble, along one of the keys that were drawn, with its statistical band."""

from __future__ import annotations

import json
from typing import Any, Final

import numpy as np
import xarray as xr

from gearidae.analysis.verdict import outcomes
from gearidae.analysis.verdict.codes import sticking, verdict_codes
from gearidae.archive.dataset import dimension_names
from gearidae.archive.specimen import SEED_KEYS, has_seeds
from gearidae.errors import SceneError
from gearidae.scene.quantity import whole
from gearidae.studies.shares import check_confidence, wilson

_PER_BIN: Final = 25
"""Members that a bin has at least, by default: a probability of one half is then known to 0.1."""
_MOST_BINS: Final = 20
_MOST_VALUES: Final = 1000
"""Values of a key at most that have intervals of their own."""


def sticking_probability(
    ds: xr.Dataset, over: str | None = None, *, bins: int | None = None, confidence: float = 0.95
) -> xr.Dataset:
    """Share of an ensemble's members that stick, alone or against one of the keys.

    Parameters
    ----------
    ds : Dataset
        From `ensemble`, or from `gearidae.sweep` over seeds and other keys: then each run is a member.
    over : str, optional
        Key that was drawn; by default all members are taken together. A seed, of a population or of errors of teeth,
        is none: it has no order.
    bins : int, optional
        Number of intervals of the key, with as many members in each; by default as many as have 25 members or more, at
        most 20. A key of few values, such as that of a sweep, has an interval for each of them.
    confidence : float, optional
        Of the band.

    Returns
    -------
    Dataset
        ``probability`` with its confidence interval ``low`` to ``high`` (Wilson 1927, doi:10.2307/2276774), ``members``
        and ``stuck``; with `over` along a dimension of the key's name, at the members' mean, with the interval's ends
        ``lowest`` and ``highest``. Members that are unfinished do not count; nor do those that Sobol' indices need
        besides, which are mixtures of others.

    Raises
    ------
    SceneError
        If the dataset is no ensemble, the key was not drawn, or too few members are finished.
    """
    check_confidence(confidence)
    ds = as_ensemble(ds)
    names = {key: name for key, name in drawn_keys(ds).items() if key not in SEED_KEYS}
    finished = np.isfinite(ds["sticks"].values)
    if "matrix" in ds.coords:
        finished &= ~np.char.startswith(ds["matrix"].values.astype(str), "AB")
    members = ds.isel(member=finished)
    if not members.sizes["member"]:
        raise SceneError("dataset", "no member", "has been finished")
    if over is None:
        return xr.Dataset(_band([members["sticks"].values], (), confidence), attrs=ds.attrs)
    if over not in names:
        others = (
            ", ".join(names)
            or "seeds alone were, which have no order; without one all members count together"
        )
        raise SceneError("over", over, f"must be a key that was drawn: {others}")
    name = names[over]
    ordered = members.sortby(name)
    groups = _groups(ordered[name].values, bins)
    values, sticks = ordered[name].values, ordered["sticks"].values
    about = ds[name].attrs
    ends = {
        "lowest": (name, np.array([values[group[0]] for group in groups]), about),
        "highest": (name, np.array([values[group[-1]] for group in groups]), about),
    }
    centre = np.array([values[group].mean() for group in groups])
    return xr.Dataset(
        _band([sticks[group] for group in groups], (name,), confidence) | ends,
        coords={name: (name, centre, about)},
        attrs=ds.attrs,
    )


def drawn_keys(ds: xr.Dataset) -> dict[str, str]:
    """Keys that an ensemble's members were drawn in, and the coordinates that hold their values.

    Returns
    -------
    dict of str to str

    Raises
    ------
    SceneError
        If the dataset is no ensemble.
    """
    whole = "ensemble" in ds.attrs and "member" in ds.dims and "sticks" in ds
    if not whole and not _is_sweep_over_seeds(ds):
        raise SceneError(
            "dataset", type(ds).__name__, "must be an ensemble, from studies.ensemble, or a sweep over seeds"
        )
    return dimension_names(json.loads(ds.attrs["swept"]))


def as_ensemble(ds: xr.Dataset) -> xr.Dataset:
    """Return a sweep over seeds as an ensemble, its runs with their verdicts along ``member``; others as they are."""
    if not _is_sweep_over_seeds(ds):
        return ds
    dims = ds["status"].dims
    stacked = ds[["status"]].stack(member=dims).reset_index("member")
    words = [outcome.verdict for outcome in outcomes(ds)]
    codes = verdict_codes(words)
    judged = {"verdict": ("member", words), "sticks": ("member", sticking(codes))}
    return stacked.assign(judged).assign_attrs(ensemble="sweep")


def _is_sweep_over_seeds(ds: xr.Dataset) -> bool:
    return "ensemble" not in ds.attrs and has_seeds(ds) and "status" in ds and bool(ds["status"].dims)


def _groups(values: np.ndarray[Any, Any], bins: int | None) -> list[np.ndarray[Any, Any]]:
    """Put ordered members into intervals of their values."""
    _, first = np.unique(values, return_index=True)
    if bins is None and 2 * first.size <= values.size and first.size <= _MOST_VALUES:
        return np.split(np.arange(values.size), np.sort(first)[1:])
    return np.array_split(np.arange(values.size), _bin_count(values.size, bins))


def _bin_count(members: int, bins: int | None) -> int:
    if bins is None:
        return max(1, min(_MOST_BINS, members // _PER_BIN))
    return whole("bins", bins, 1, members)


def _band(groups: list[np.ndarray[Any, Any]], dims: tuple[str, ...], confidence: float) -> dict[str, Any]:
    """Probability, interval and counts of each group."""
    counts = [(int(group.sum()), group.size) for group in groups]
    intervals = [wilson(stuck, size, confidence) for stuck, size in counts]
    percent = f"{100.0 * confidence:g} %"
    columns = {
        "probability": ([stuck / size for stuck, size in counts], "share of the members that stick"),
        "low": ([low for low, _ in intervals], f"lower end of the {percent} confidence interval"),
        "high": ([high for _, high in intervals], f"upper end of the {percent} confidence interval"),
        "stuck": ([stuck for stuck, _ in counts], "members that stick"),
        "members": ([size for _, size in counts], "members that are finished"),
    }
    return {
        name: (dims, np.array(values).reshape(() if not dims else -1), {"long_name": words, "units": "1"})
        for name, (values, words) in columns.items()
    }
