"""Follow the wear of hubs and pin, and say after how many turns of the drive's shaft which of them fails first."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated, Any, Final

import numpy as np
import xarray as xr

from gearidae.errors import SceneError
from gearidae.scene.pairs import quantity
from gearidae.scene.prefixes import with_prefix
from gearidae.studies.study import Column, Option, Picture, Rows, Study

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from gearidae.scene import Scene

QUANTILES: Final = (0.1, 0.5, 0.9)
FITTED: Final = "One number is fitted: the wear coefficient k, of which no open measurement was found."
_ALONG: Final = ("frequency", "joint")


def _written(
    *,
    coefficient: Annotated[str, Option("Wear coefficient over hardness, 1e-16 m^2/N: fitted.")],
    threshold: Annotated[str, Option("Worn volume at which a joint has failed, 1e-21 m^3, or 2 sigma.")],
    frequencies: Annotated[
        str | None, Option("Frequencies of the drive's law in Hz, 150,600,1200. Default: its own.")
    ] = None,
    length: Annotated[str | None, Option("Length of the joints, 2 um. Default: the face width.")] = None,
) -> dict[str, Any]:
    parts = [] if frequencies is None else frequencies.split(",")
    return {
        "coefficient": quantity("--coefficient", coefficient, "m^2/N"),
        "threshold": threshold if "sigma" in threshold else quantity("--threshold", threshold, "m^3"),
        "frequencies": [quantity("--frequencies", part.strip(), "Hz") for part in parts] or None,
        "length": None if length is None else quantity("--length", length, "m"),
    }


def _announced(_: Scene, __: int | None, *, frequencies: list[float] | None, **___: Any) -> str:
    count = len(frequencies or [0.0])
    many = "1 frequency" if count == 1 else f"{count} frequencies"
    return f"{many}, until the sliding of the joints in a turn is steady"


def _turning(ds: xr.Dataset) -> str:
    """Name the shaft whose turns count: of a train that of the drive."""
    return str(ds.attrs.get("shaft", "the pinion"))


def _first(point: xr.Dataset) -> str:
    """Name the joint that fails first at a frequency, in most of the devices."""
    return str(point["joint"].values[int(np.argmax(point["first_share"].values))])


def _answered(ds: xr.Dataset) -> xr.Dataset:
    """Leave out frequencies without an answer."""
    return ds.isel(frequency=np.flatnonzero(ds["status"].values == "finished"))


def _sentence(ds: xr.Dataset) -> str:
    answered = _answered(ds)
    if not answered.sizes["frequency"]:
        return f"No run gives a life. {FITTED}"
    lives, rates = answered["life_quantile"].sel(quantile=0.5).values, answered["frequency"].values
    if not np.isfinite(lives).any():
        return f"No joint slides under a load: none wears. {FITTED}"
    names = [_first(answered.isel(frequency=number)) for number in range(rates.size)]
    who = f"The {names[0]} fails first" if len(set(names)) == 1 else "The first joint to fail changes"
    median = ""
    if ds.attrs["spread"] > 1.0:
        shares = [f"{share:.3g}" for share in 100.0 * answered["first_share"].max("joint").values]
        who += f" in {_range(shares)} % of the devices" if len(set(names)) == 1 else ""
        median = f" in the median of {ds.sizes['seed']} devices"
    turns = _range([f"{life:.3g}" for life in lives])
    hours = _range([f"{life / rate / 3600.0:.3g}" for life, rate in zip(lives, rates, strict=True)])
    speeds = _range([f"{rate:.4g}" for rate in rates])
    return f"{who}, after {turns} turns of {_turning(ds)} ({hours} h at {speeds} turns/s){median}. {FITTED}"


def _range(texts: Sequence[str]) -> str:
    """Write numbers as the first and the last of them, or as one where all look alike."""
    return texts[0] if len(set(texts)) == 1 else f"{texts[0]} to {texts[-1]}"


def _rows(ds: xr.Dataset) -> Rows:
    """Lives of the joints at each frequency, the first of them, and what they have worn."""
    drawn = ds.attrs["spread"] > 1.0
    for number in range(ds.sizes["frequency"]):
        point = ds.isel(frequency=number)
        yield (
            f"Lives at {float(point['frequency']):.4g} turns/s of {_turning(ds)}",
            "turns",
            "hours, sliding in a turn",
        )
        if str(point["status"].values) != "finished":
            yield "no answer", "-", str(point["message"].values)
            continue
        for index, name in enumerate(point["joint"].values.tolist()):
            joint = point.isel(joint=index)
            more = f"{float(joint['hours']):.3g} h, {float(joint['sliding']):.4g} N m"
            if drawn:
                low, _, high = joint["turns_quantile"].values
                share = 100.0 * float(joint["first_share"])
                more += f"; 80 % of {low:.3g} to {high:.3g} turns, the first in {share:.3g} % of the devices"
            if "worn_depth" in joint:
                depth, play = (float(joint[field]) for field in ("worn_depth", "added_backlash"))
                more += f"; worn by {with_prefix(depth, 'm')} when the life is over"
                more += f", which adds {with_prefix(play, 'm')} of backlash at most" if play > 0.0 else ""
            yield name, f"{float(joint['turns']):.3g}", more
        yield "first to fail", _first(point), f"blocks of turns differ by {float(point['drift']):.2g}"
    k = f"{float(ds.attrs['coefficient']):.3g} m^2/N"
    yield "wear coefficient", k, f"spread {ds.attrs['spread']:g}; fitted: lives are as good as this number"


def picture(ds: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Draw the lives of the joints against the turns of the pinion, of a train the drive's shaft, in a second.

    Parameters
    ----------
    ds : xarray.Dataset
        From `gearidae.studies.hub_life`.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.

    Returns
    -------
    Axes
        With logarithmic lives; of drawn devices 80 % lie in the shaded band of a joint.

    Raises
    ------
    SceneError
        If the dataset is none of lives of hubs, or no joint wears.
    """
    from gearidae.drawing.style import line_colour, line_style, new_axes, tidy

    answered = _answered(STUDY.require(ds)).sortby("frequency")
    if not np.isfinite(answered["turns"]).any():
        raise SceneError("plot", "hub_life", "no joint wears")
    ax = new_axes(ax, height=3.4)
    for number, name in enumerate(answered["joint"].values.tolist()):
        joint = answered.isel(joint=number)
        if not np.isfinite(joint["turns"]).any():
            continue
        style = {"color": line_colour(number), "linestyle": line_style(number), "label": name}
        ax.plot(joint["frequency"], joint["turns"], marker="o", markersize=3.5, **style)
        if answered.attrs["spread"] > 1.0:
            low, _, high = joint["turns_quantile"].values.T
            ax.fill_between(
                joint["frequency"], low, high, color=line_colour(number), alpha=0.15, linewidth=0.0
            )
    ax.set_yscale("log")
    ax.set_xlabel(f"turns of {_turning(ds)} in a second")
    ax.set_ylabel("life (turns)")
    tidy(ax)
    ax.legend(frameon=False, fontsize="small")
    return ax


STUDY = Study(
    kind="hub_life",
    words="study of lives of hubs",
    maker="hub-life",
    title="Hub life",
    command=_written,
    options=("spread", "seeds", "clearance"),
    announcement=_announced,
    examples=(
        'gearidae hub-life engine.toml --coefficient "1e-16 m^2/N" --threshold "1e-21 m^3"',
        'gearidae hub-life engine.toml --coefficient "1e-16 m^2/N" --threshold "2 sigma" --spread 2',
    ),
    columns={
        "frequency": Column(
            ("frequency",), "s-1", "turns of the pinion, of a train the drive's shaft, in a second"
        ),
        "joint": Column(("joint",), "", "hub or pin"),
        "sliding": Column(_ALONG, "N m", "load of the joint times the way of its surface, in a turn"),
        "volume": Column(("joint",), "m3", "worn volume at which the joint has failed"),
        "turns": Column(
            _ALONG,
            "1",
            "turns of the pinion, of a train the drive's shaft, until then, with the median coefficient",
        ),
        "hours": Column(_ALONG, "h", "the same in hours"),
        "turns_quantile": Column((*_ALONG, "quantile"), "1", "quantiles of the life of the joint"),
        "first_share": Column(_ALONG, "1", "share of the devices in which the joint fails first"),
        "life": Column(
            ("frequency", "seed"),
            "1",
            "turns of the pinion, of a train the drive's shaft, until the first joint of a device fails",
        ),
        "life_quantile": Column(("frequency", "quantile"), "1", "quantiles of that over the devices"),
        "drift": Column(("frequency",), "1", "difference of the last two blocks of turns"),
        "worn_depth": Column(_ALONG, "m", "worn depth all round when the life is over", required=False),
        "added_backlash": Column(
            _ALONG, "m", "play that it adds along the line of action at most", required=False
        ),
        "status": Column(("frequency",), "", "how the run ended"),
        "message": Column(("frequency",), "", "the same in a sentence"),
        "seed": Column(("seed",), "1", "seed of the device"),
        "quantile": Column(("quantile",), "1", "share below the quantile"),
    },
    sentence=_sentence,
    rows=_rows,
    pictures=(Picture("hub_life", "Lives of the joints against the turns in a second", draw=picture),),
)
