"""Follow the coverage over the passages of the teeth until the gear sticks."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final

import numpy as np
import xarray as xr

from gearidae.archive.select import scene_of
from gearidae.errors import SceneError
from gearidae.studies.study import Column, Picture, Rows, Study
from gearidae.wear.lives.law_draws import ArrheniusFactor, LawName, LawParameters, name_of, written_law

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from gearidae.scene import Scene
    from gearidae.wear import LossLaw

_ENDINGS: Final = {
    "coverage": "the requested coverage is reached",
    "passages": "the requested passages are reached",
    "interrupted": "the study was interrupted",
}
_EXPOSURES: Final = {
    "contacts": ("m-2", "asperity contacts made on coated flank in a passage, per area of it"),
    "adhesion_work": ("J m-2", "energy lost to adhesion on coated flank in a passage, per area of it"),
    "sliding_work": ("J m-2", "normal force times sliding distance in a passage, per area"),
    "friction_work": ("J m-2", "energy lost to friction of the flanks in a passage, per area"),
    "pressure": ("Pa", "largest nominal pressure"),
}
_FLANKS: Final = ("passages", "side")


def _written(*, law: LawName, parameter: LawParameters, arrhenius: ArrheniusFactor = None) -> dict[str, Any]:
    return {"law": written_law(law, parameter, arrhenius or [], {})}


def _announced(_: Scene, __: int | None, *, law: LossLaw, passages: float, **___: Any) -> str:
    return f"{name_of(law)}; at most {passages:g} passages, of which few are simulated"


def _sentence(ds: xr.Dataset) -> str:
    last = float(ds["passages"][-1])
    ending = str(ds.attrs.get("ending", ""))
    if ending == "sticks":
        end = float(ds.attrs.get("passages_to_sticking", math.nan))
        between = f"between {last:.4g} and {end:.4g} passages of each tooth of the pinion"
        return f"The gear sticks {between}{_hours(ds, end)}."
    return (
        f"After {last:.4g} passages of each tooth of the pinion{_hours(ds, last)} "
        f"{_ENDINGS.get(ending, 'the life ends')}."
    )


def _hours(ds: xr.Dataset, passages: float) -> str:
    """Say how long passages take at the speed with which a life begins; nothing if that is not known."""
    gears, speed = scene_of(ds).get("gears"), float(ds["mean_gear_speed"][0])
    if not gears or not speed > 0.0 or not math.isfinite(passages):
        return ""
    hours = passages * 2.0 * math.pi * gears["pinion_teeth"] / (gears["gear_teeth"] * speed) / 3600.0
    return f" ({hours:.3g} h at {speed:.4g} rad/s)"


def _rows(ds: xr.Dataset) -> Rows:
    """Coverage, speed and frequency at the steps of the life."""
    yield "Passages of each tooth", "coverage", "mean speed, smallest speed, characteristic frequency"
    for number in range(ds.sizes["passages"]):
        state = ds.isel(passages=number)
        shares = ", ".join(f"{round(100.0 * share, 6):.4g} %" for share in state["coverage"].values)
        speed = f"{float(state['mean_gear_speed']):.4g} rad/s, {float(state['min_gear_speed']):.4g} rad/s"
        rings = float(state["characteristic_frequency"]) if "characteristic_frequency" in state else math.nan
        more = "" if math.isnan(rings) else f", {rings:.4g} Hz"
        yield f"{float(state['passages']):.4g}", shares, f"{state['verdict'].values!s}, {speed}{more}"
    counted = {name: ds.attrs.get(f"mesh_cycles_{name}") for name in ("jumped", "simulated")}
    if None not in counted.values():
        jumped = f"{float(counted['jumped']):.4g} jumped, {ds.attrs['windows']} windows"  # type: ignore[arg-type]
        yield "mesh cycles simulated", f"{float(counted['simulated']):.4g}", jumped  # type: ignore[arg-type]


def picture(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw coverage against passages, with the end of the life and the frequency that a speed sensor sees.

    Parameters
    ----------
    ds : xarray.Dataset
        From `gearidae.studies.life`; of `gearidae.studies.assess_life` what the signals say is drawn too, with its 95 %
        interval.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.

    Returns
    -------
    Axes
        The frequency is on a second axis, at the right.

    Raises
    ------
    SceneError
        If the dataset is no life.
    """
    from gearidae.drawing.style import label_axis, new_axes

    _require(ds, "coverage")
    ax = new_axes(ax, height=3.8)
    passages = ds["passages"].values
    if "assessed_coverage" in ds:
        _draw_assessed(ds, ax)
    for side in ds["side"].values:
        share = 100.0 * ds["coverage"].sel(side=side).values
        ax.plot(passages, share, marker=".", label=f"coverage, {side}")
    if ds.attrs.get("ending") == "sticks":
        ax.axvspan(
            passages[-1], float(ds.attrs["passages_to_sticking"]), color="0.6", alpha=0.5, label="sticks"
        )
    ax.set_xlabel("passages of each tooth of the pinion")
    ax.set_ylabel("coverage (%)")
    ax.set_ylim(0.0, 105.0)
    if "characteristic_frequency" in ds:
        right = ax.twinx()
        frequency = ds["characteristic_frequency"].values
        right.plot(
            passages, frequency, color="C1", marker=".", linestyle="--", label="characteristic frequency"
        )
        label_axis(right.yaxis, "characteristic frequency", "Hz")
        lines, labels = (
            a + b
            for a, b in zip(ax.get_legend_handles_labels(), right.get_legend_handles_labels(), strict=True)
        )
        right.legend(lines, labels, loc="center left", frameon=False)
    else:
        ax.legend(loc="lower left", frameon=False)
    return ax


def _draw_assessed(ds: xr.Dataset, ax: Axes) -> None:
    """Draw what signals along the life say, where they can tell."""
    passages, shares = ds["passages"].values, 100.0 * ds["assessed_coverage"].values
    below, above = 100.0 * ds["assessed_low"].values, 100.0 * ds["assessed_high"].values
    assessed = np.isfinite(shares)
    spread = [shares[assessed] - below[assessed], above[assessed] - shares[assessed]]
    ax.errorbar(
        passages[assessed],
        shares[assessed],
        yerr=spread,
        label="by the speed signal, 95 %",
        fmt="o",
        color="C2",
        markersize=4.0,
        capsize=2.5,
    )


def coverage_along_flank(ds: xr.Dataset, ax: Axes | None = None, *, tooth: int | None = None) -> Axes:
    """Draw the coverage along the flank over passages.

    Parameters
    ----------
    ds : xarray.Dataset
        From `gearidae.studies.life` with ``resolved="place"`` or ``"tooth"``.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.
    tooth : int, optional
        Tooth of the pinion; by default the mean of all.

    Returns
    -------
    Axes
        A line for each of up to six steps of the life, from light to dark.

    Raises
    ------
    SceneError
        If the dataset is no such life, or has no such tooth.
    """
    from gearidae.drawing.style import label_axis, new_axes

    _require(ds, "coverage_by_place")
    coverage = ds["coverage_by_place"].isel(side=0)
    if tooth is not None and tooth not in coverage["tooth"].values:
        raise SceneError("tooth", tooth, f"must lie in 0..{coverage.sizes['tooth'] - 1}")
    coverage = coverage.mean("tooth") if tooth is None else coverage.sel(tooth=tooth)
    ax = new_axes(ax, height=3.8)
    chosen = np.unique(np.linspace(0, coverage.sizes["passages"] - 1, 6).round().astype(int))
    for rank, number in enumerate(chosen):
        curve = coverage.isel(passages=int(number))
        shade = str(0.75 * (1.0 - rank / max(len(chosen) - 1, 1)))
        ax.plot(
            coverage["place"].values,
            100.0 * curve.values,
            color=shade,
            marker=".",
            label=f"{float(curve['passages']):.3g} passages",
        )
    label_axis(ax.xaxis, "place along the path of contact", "m")
    ax.set_ylabel("coverage (%)")
    ax.legend(frameon=False)
    return ax


def _require(ds: xr.Dataset, name: str) -> None:
    if "passages" not in ds.dims or name not in ds:
        raise SceneError(
            "dataset", type(ds).__name__, f"must be a life with {name}, from gearidae.studies.life"
        )


def _exposure_columns() -> dict[str, Column]:
    """Exposures of a passage, and their sums."""
    columns = {}
    for name, (unit, words) in _EXPOSURES.items():
        columns[f"passage_{name}"] = Column(_FLANKS, unit, words, required=False)
        if name != "pressure":
            summed = words.replace(" in a passage", "").replace("made ", "made so far ")
            columns[f"total_{name}"] = Column(_FLANKS, unit, f"{summed}, since the beginning", required=False)
    return columns


STUDY = Study(
    kind="life",
    words="life of a coating",
    maker="life",
    title="Life",
    command=_written,
    options=("passages", "fraction", "resolved", "tolerance"),
    announcement=_announced,
    examples=(
        'gearidae life mine.toml --law adhesion_work --parameter "energy=0.5 mJ/m^2"',
        'gearidae life mine.toml --law contacts --parameter "area=1 nm^2" --fraction 0.5 --resolved place',
    ),
    columns={
        "passages": Column(("passages",), "1", "passages of each tooth of the pinion", required=False),
        "coverage": Column(_FLANKS, "1", "mean covered share of the flanks"),
        "coverage_loss": Column(_FLANKS, "1", "share lost in a passage", required=False),
        "verdict": Column(("passages",), "1", "what the gear does"),
        "mean_gear_speed": Column(("passages",), "rad s-1", "mean speed of the gear"),
        "min_gear_speed": Column(("passages",), "rad s-1", "smallest speed of the gear"),
        **_exposure_columns(),
        "coverage_by_place": Column(
            (*_FLANKS, "tooth", "place"),
            "1",
            "covered share by tooth of the pinion and place along the flank",
            required=False,
        ),
        "characteristic_frequency": Column(
            ("passages",), "Hz", "frequency of the first impact response", required=False
        ),
        "side": Column(("side",), "", ""),
    },
    sentence=_sentence,
    rows=_rows,
    pictures=(
        Picture("life", "Coverage and frequency of the impact response over passages", draw=picture),
        Picture(
            "coverage_along_flank",
            "Coverage along the path of contact",
            lambda ds: "coverage_by_place" in ds,
            coverage_along_flank,
        ),
    ),
    viewer="life",
)
