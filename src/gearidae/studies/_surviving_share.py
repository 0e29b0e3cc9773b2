"""Share of gears that still turn after some passages, from the lives of an ensemble."""

from __future__ import annotations

from statistics import NormalDist
from typing import Any

import numpy as np
import xarray as xr

from gearidae.arrays import Floats, Ints
from gearidae.errors import SceneError


def surviving_share(ds: xr.Dataset, *, confidence: float = 0.95) -> xr.Dataset:
    """Estimate the share of gears that still turn, by Kaplan and Meier.

    Lives that have ended otherwise count as long as they were followed. Of a life that ends by sticking the upper end
    of its bracket counts.

    Parameters
    ----------
    ds : Dataset
        From `gearidae.studies.lives`.
    confidence : float, optional
        Of the interval.

    Returns
    -------
    Dataset
        Along ``passages``, at which a gear sticks (and 0): ``share`` from there on, with the ends ``low`` and ``high``
        of its pointwise confidence interval (Greenwood's formula for log(-log share), as in J. D. Kalbfleisch and R. L.
        Prentice, The Statistical Analysis of Failure Time Data, 2002; NaN where all or none are left), and
        ``followed``, the lives that were followed so far. Unfinished lives do not count.

    Raises
    ------
    SceneError
        If the dataset has no lives, or none is finished, or the confidence is none.
    """
    if not 0.0 < confidence < 1.0:
        raise SceneError("confidence", confidence, "must be above 0 and below 1")
    if "member" not in ds.dims or "passages_to_sticking" not in ds or "passages_turning" not in ds:
        raise SceneError("dataset", type(ds).__name__, "must hold lives, from studies.lives")
    done = ds.isel(member=np.isfinite(ds["sticks"].values))
    if not done.sizes["member"]:
        raise SceneError("dataset", "no life", "has been finished")
    stuck = done["sticks"].values > 0.0
    ends, turning = done["passages_to_sticking"].values[stuck], done["passages_turning"].values[~stuck]
    at, counts = np.unique(ends, return_counts=True)
    followed = (ends >= at[:, None]).sum(axis=1) + (turning >= at[:, None]).sum(axis=1)
    share = np.cumprod(1.0 - counts / followed)
    low, high = _band(share, counts, followed, confidence)
    at, share = np.concatenate([[0.0], at]), np.concatenate([[1.0], share])
    low, high = (np.concatenate([[np.nan], each]) for each in (low, high))
    followed = np.concatenate([[done.sizes["member"]], followed])
    percent = f"{100.0 * confidence:g} %"
    return xr.Dataset(
        {
            "share": ("passages", share, _about("share of the gears that still turn")),
            "low": ("passages", low, _about(f"lower end of the {percent} confidence interval")),
            "high": ("passages", high, _about(f"upper end of the {percent} confidence interval")),
            "followed": ("passages", followed, _about("lives that have been followed so far")),
        },
        coords={"passages": ("passages", at, _about("passages of each tooth of the pinion"))},
        attrs=ds.attrs,
    )


def _band(share: Floats, stuck: Ints, followed: Ints, confidence: float) -> tuple[Floats, Floats]:
    """Ends of the interval of a share at each of the passages at which some of those followed stick."""
    left = followed > stuck  # the interval is not defined where none is left
    terms = np.divide(stuck, followed * (followed - stuck), out=np.zeros(len(share)), where=left)
    known = np.where(left, share, np.nan)
    spread = NormalDist().inv_cdf(0.5 + 0.5 * confidence) * np.sqrt(np.cumsum(terms)) / np.log(known)
    return known ** np.exp(-spread), known ** np.exp(spread)


def _about(words: str) -> dict[str, Any]:
    return {"long_name": words, "units": "1"}
