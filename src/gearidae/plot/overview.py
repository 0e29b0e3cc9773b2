"""The picture that says most about a dataset, for those who ask for one without saying which."""

from __future__ import annotations

import xarray as xr
from matplotlib.figure import Figure, SubFigure

from gearidae.archive.select import is_roller, is_train, scene_of, swept_dims
from gearidae.archive.specimen import specimen_label
from gearidae.archive.train import work_shares
from gearidae.archive.value_text import coverage_text
from gearidae.archive.variables import SAM_FRACTION
from gearidae.drawing.picture import new_picture
from gearidae.drawing.style import runs_of
from gearidae.plot.gears import gear_speed
from gearidae.plot.roller import roller_force, roller_gap
from gearidae.plot.torque import contact_torque
from gearidae.plot.work import work
from gearidae.records import sampled_columns
from gearidae.studies.declared import studies


def usual_pictures(ds: xr.Dataset, kind: str) -> dict[str, str]:
    """Name the pictures of a dataset that there is something to draw of.

    Parameters
    ----------
    kind : str
        From `gearidae.studies.products.open_product`.

    Returns
    -------
    dict of str to str
        Functions of `gearidae.plot` and their captions, the one that says most first.
    """
    if kind == "runs" and is_train(ds):
        if swept_dims(ds):
            return {"overview": ""}
        moved = {"train": "The train at the end of the run"} if ds.sizes["time"] else {}
        works = {"work": "Where the work of the drive goes"} if work_shares(ds) else {}
        return works | moved or {"overview": ""}
    if kind == "runs":
        sampled = any(name in ds for name in sampled_columns(roller=is_roller(ds)))
        return {"overview" if sampled or not swept_dims(ds) else "outcome": ""}
    return {picture.name: picture.caption for picture in studies()[kind].pictures if picture.needs(ds)}


def overview(ds: xr.Dataset, *, figure: Figure | SubFigure | None = None) -> Figure | SubFigure:
    """Draw a dataset: gear speed and contact torque of a gear pair, force and gap of a roller.

    Of a train the speed of the judged shaft, and of a single run where the work of the drive goes.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run or a sweep; of more than seven runs, seven are shown.
    figure : matplotlib Figure or SubFigure, optional
        Where to draw; by default a new one.

    Returns
    -------
    matplotlib Figure or SubFigure

    Raises
    ------
    SceneError
        If the dataset has no samples.
    """
    if is_train(ds):
        return _train_overview(ds, figure)
    above, below = (roller_force, roller_gap) if is_roller(ds) else (gear_speed, contact_torque)
    strips = 1 if is_roller(ds) else len(runs_of(ds, "gear_contact_torque"))
    lower = 2.8 if strips == 1 else 0.8 + 0.62 * strips
    figure = figure or new_picture((7.6, 3.2 + lower), panels=True, layout="constrained")
    grid = figure.add_gridspec(2, 1, height_ratios=(3.2, lower))
    top, bottom = figure.add_subplot(grid[0]), figure.add_subplot(grid[1])
    above(ds, top)
    below(ds, bottom)
    top.set_xlabel("")
    top.tick_params(labelbottom=False)
    if is_roller(ds) and (repeated := bottom.get_legend()) is not None:
        repeated.remove()
    figure.suptitle(_title(ds), x=0.01, ha="left", fontsize="large")
    return figure


def _train_overview(ds: xr.Dataset, figure: Figure | SubFigure | None) -> Figure | SubFigure:
    single = not swept_dims(ds) and bool(work_shares(ds))
    figure = figure or new_picture((7.6, 6.4 if single else 3.6), panels=True, layout="constrained")
    top, *bottom = figure.subplots(1 + single, 1, squeeze=False)[:, 0]
    gear_speed(ds, top)
    for ax in bottom:
        work(ds, ax)
    figure.suptitle(_title(ds), x=0.01, ha="left", fontsize="large")
    return figure


def _title(ds: xr.Dataset) -> str:
    words = [str(scene_of(ds).get("name", "")).replace("_", " ")]
    if (label := SAM_FRACTION.name) in ds.coords and not ds[label].dims:
        words.append(coverage_text(ds[label].item()))
    return ", ".join(filter(None, (*words, specimen_label(ds))))
