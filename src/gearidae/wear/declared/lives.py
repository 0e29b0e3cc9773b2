"""Follow the coatings of gears with keys drawn from distributions: how long they last.

Parameters of the law are drawn as law.NAME, such as --vary "law.energy=lognormal(0.5 mJ/m^2, 3)"; --parameter gives
those that are not drawn. Lives so far are kept beside the archive, in OUT.nc.lives, until the archive is written.
"""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import xarray as xr

from gearidae.errors import SceneError
from gearidae.scene.pairs import texts
from gearidae.studies.members import count_rows
from gearidae.studies.options import VARY_EXAMPLE, Vary
from gearidae.studies.study import Column, Picture, Rows, Study
from gearidae.wear.lives.law_draws import ArrheniusFactor, LawName, OtherParameters, name_of, written_law

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from gearidae.scene import Scene
    from gearidae.wear import LossLaw

_SHARES: Final = (0.9, 0.5, 0.1)
"""Of the gears that still turn, for which the passages are given."""


def _written(
    *, law: LawName, vary: Vary, parameter: OtherParameters = None, arrhenius: ArrheniusFactor = None
) -> dict[str, Any]:
    keys = texts(vary, "--vary", VARY_EXAMPLE)
    return {"law": written_law(law, parameter or [], arrhenius or [], keys), "vary": keys}


def _announced(_: Scene, __: int | None, *, law: LossLaw, size: int, passages: float, **___: Any) -> str:
    return f"{size} gears, {name_of(law)}; at most {passages:g} passages, of which few are simulated"


def _sentence(ds: xr.Dataset) -> str:
    members, stuck = ds.sizes["member"], int((ds["sticks"] > 0.0).sum())
    if not stuck:
        return f"None of {members} gears sticks as far as they were followed."
    half = next(value for name, value, _ in _surviving_rows(ds) if " 50 % " in name)
    return f"{stuck} of {members} gears stick; half still turn after {half} passages of each tooth of the pinion."


def _rows(ds: xr.Dataset) -> Rows:
    """How the lives end, and after how many passages shares of the gears still turn."""
    yield str(ds.attrs["title"]), "", ""
    yield from count_rows(ds["ending"])
    if (ds["sticks"] > 0.0).any():
        yield from _surviving_rows(ds)
    if np.isfinite(ds["final_coverage"]).any():
        low, middle, high = np.nanquantile(ds["final_coverage"].values, (0.05, 0.5, 0.95))
        spread = f"90 % between {100.0 * low:.4g} % and {100.0 * high:.4g} %"
        yield "coverage at the end", f"{100.0 * middle:.4g} %", spread
    yield "windows", str(int(np.nansum(ds["windows"].values))), "simulated"


def _surviving_rows(ds: xr.Dataset) -> Rows:
    surviving = surviving_share(ds)
    passages, shares = surviving["passages"].values, surviving["share"].values
    followed = max(passages[-1], np.nanmax(ds["passages_turning"].values))
    for share in _SHARES:
        fallen = np.flatnonzero(shares <= share)
        value = f"{passages[fallen[0]]:.4g}" if fallen.size else f"more than {followed:.4g}"
        yield f"passages until {100.0 * share:.0f} % still turn", value, "of each tooth of the pinion"


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
    from scipy.stats import CensoredData, ecdf  # which take half a second to load

    if not 0.0 < confidence < 1.0:
        raise SceneError("confidence", confidence, "must be above 0 and below 1")
    if "member" not in ds.dims or "passages_to_sticking" not in ds or "passages_turning" not in ds:
        raise SceneError("dataset", type(ds).__name__, "must hold lives, from studies.lives")
    done = ds.isel(member=np.isfinite(ds["sticks"].values))
    if not done.sizes["member"]:
        raise SceneError("dataset", "no life", "has been finished")
    stuck = done["sticks"].values > 0.0
    ends, turning = done["passages_to_sticking"].values[stuck], done["passages_turning"].values[~stuck]
    estimate = ecdf(CensoredData(uncensored=ends, right=turning)).sf
    with warnings.catch_warnings(
        action="ignore", category=RuntimeWarning
    ):  # undefined where all or none are left
        interval = estimate.confidence_interval(confidence, method="log-log")
    known = np.isin(estimate.quantiles, ends)
    at = np.append(0.0, estimate.quantiles[known])
    share = np.append(1.0, estimate.probabilities[known])
    low, high = (np.append(np.nan, bound.probabilities[known]) for bound in (interval.low, interval.high))
    followed = (np.append(ends, turning) >= at[:, None]).sum(axis=1)
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


def _about(words: str) -> dict[str, Any]:
    return {"long_name": words, "units": "1"}


def picture(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw the share of gears that still turn against passages, with its 95 % band.

    Parameters
    ----------
    ds : xarray.Dataset
        From `gearidae.studies.lives`.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.

    Returns
    -------
    Axes
        Lives that were followed no further are ticks on the curve.

    Raises
    ------
    SceneError
        If the dataset has no lives, or none is finished.
    """
    from gearidae.drawing.style import POSITIVE, line_width, new_axes, tidy

    surviving = surviving_share(ds)
    ax = new_axes(ax, height=3.8)
    turning = ds["passages_turning"].values[ds["sticks"].values == 0.0]
    end = max([float(surviving["passages"][-1]), *turning.tolist()])
    at = np.append(surviving["passages"].values, end)
    share, low, high = (
        np.append(surviving[name].values, surviving[name].values[-1]) for name in ("share", "low", "high")
    )
    ax.fill_between(at, low, high, step="post", color=POSITIVE, alpha=0.25, linewidth=0, label="95 % band")
    ax.step(at, share, where="post", color=POSITIVE, linewidth=line_width(1.4), label="still turn")
    if turning.size:
        there = share[np.searchsorted(at[:-1], turning, side="right") - 1]
        ax.plot(turning, there, "|", color="0.3", markersize=8.0, label="followed no further")
    ax.set_ylim(-0.02, 1.02)
    ax.set_xlim(left=0.0)
    ax.set_xlabel("passages of each tooth of the pinion")
    ax.set_ylabel("share of the gears")
    tidy(ax)
    ax.legend(frameon=False, fontsize="small")
    return ax


STUDY = Study(
    kind="lives",
    words="ensemble of lives",
    maker="lives",
    title="Lives",
    command=_written,
    options=(
        "size",
        "design",
        "seed",
        "life.passages",
        "life.fraction",
        "life.resolved",
        "life.tolerance",
    ),
    announcement=_announced,
    examples=("gearidae lives mine.toml --law contacts --size 64 --vary law.area=lognormal(1e-19,3)",),
    columns={
        "member": Column(("member",), "1", "number of the member", required=False),
        "passages_to_sticking": Column(
            ("member",), "1", "passages of each tooth of the pinion by which the gear sticks"
        ),
        "passages_turning": Column(
            ("member",), "1", "passages up to which it turns, as far as it was followed"
        ),
        "final_coverage": Column(("member",), "1", "mean coverage there", required=False),
        "windows": Column(("member",), "1", "windows that were simulated", required=False),
        "sticks": Column(
            ("member",), "1", "whether the gear sticks at the end of its life; NaN if the life is unfinished"
        ),
        "ending": Column(("member",), "1", "what ended the life"),
        "status": Column(("member",), "1", "status of the member"),
        "message": Column(("member",), "1", "message of the member", required=False),
    },
    sentence=_sentence,
    rows=_rows,
    pictures=(Picture("lives", "Share of the gears that still turn", draw=picture),),
    member_columns=("ending", "passages_to_sticking", "passages_turning", "final_coverage", "status"),
)
