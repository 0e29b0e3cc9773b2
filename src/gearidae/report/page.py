"""The page: its sections put together, written whole or not at all."""

from __future__ import annotations

import math
import os
from pathlib import Path

import xarray as xr

from gearidae.analysis.verdict.headline import headline
from gearidae.archive.select import is_train, swept_dims
from gearidae.archive.specimen import specimen_note
from gearidae.archive.target import whole_file
from gearidae.drawing.style import number_shown
from gearidae.errors import SceneError
from gearidae.plot.overview import usual_pictures
from gearidae.progress import in_words
from gearidae.report import html
from gearidae.report.frame import page
from gearidae.report.life import life_table, life_viewer
from gearidae.report.pictures import figures, pictures
from gearidae.report.series import pack
from gearidae.report.tables import (
    answer_tables,
    event_table,
    law_table,
    member_table,
    outcome_table,
    summary_tables,
)
from gearidae.report.teeth import pack_runs, runs_with_teeth, time_to_repeat
from gearidae.studies.declared import studies
from gearidae.studies.products import answer, kind_of

_SOON, _SOON_OF_MANY = 60.0, 10.0
"""Wall times [s] up to which runs are repeated for the view of the teeth without being asked for; of large sweeps,
whose page shows all runs without it, the latter."""
_STATES_OF_MANY = 1400
"""States of the teeth that the page of a large sweep holds: 200 of each of its seven runs."""
_LONG_TABLE = 20
"""Rows above which a table is folded."""


def build_report(ds: xr.Dataset, *, most_values: int | None = None, teeth: bool | None = None) -> str:
    """Make one self-contained HTML page about a dataset.

    Parameters
    ----------
    ds : xarray.Dataset
        From `simulate`, `sweep`, `open_archive` or `gearidae.studies.life`. What runs have not kept (samples, events)
        is left out.
    most_values : int, optional
        Numbers to embed at most in the viewer of the time series; by default 1.5 million, of more than seven runs
        half a million.
    teeth : bool, optional
        Whether to show the teeth in mesh, for which seven runs at most run again; by default where they have taken no
        more than a minute, of more than seven runs ten seconds. What the page does not show it says.

    Returns
    -------
    str
        A page that loads nothing: styles, script, pictures and data are in it.

    Raises
    ------
    SceneError
        If the dataset carries no scene.
    """
    kind = kind_of(ds)
    if kind != "runs":
        return _study_page(ds, kind)
    if is_train(ds):
        return _train_page(ds)
    sections = (
        html.section("outcome", "Outcome", _specimen(ds), _long(outcome_table(ds), ds), summary_tables(ds)),
        html.section("series", "Time series", _viewer(ds, most_values)),
        html.section("teeth", "Teeth in mesh", _teeth(ds, teeth)),
        html.section("pictures", "Pictures", pictures(ds)),
        html.section("events", "Events", _long(event_table(ds), ds)),
    )
    scripts = ("common.js", "save.js", "box.js", "map.js", "viewer.js", "player.js", "mesh.js", "teeth.js")
    return page(ds, "report", headline(ds), sections, scripts)


def _train_page(ds: xr.Dataset) -> str:
    """Make the page of a run of a train: its outcome, and where the work of the drive goes."""
    sections = (
        html.section("outcome", "Outcome", outcome_table(ds), summary_tables(ds)),
        html.section("pictures", "Pictures", figures(ds, usual_pictures(ds, "runs"))),
    )
    return page(ds, "report", headline(ds), sections, ("common.js", "save.js"))


def _long(table: str, ds: xr.Dataset) -> str:
    """Fold a table that has a row for each run, where there are many."""
    count = math.prod(ds.sizes[dim] for dim in swept_dims(ds))
    return html.folded(f"Table of {count} runs", table) if table and count > _LONG_TABLE else table


def _specimen(ds: xr.Dataset) -> str:
    """Say of a run with real asperities that it is one specimen of its design."""
    note = specimen_note(ds)
    return html.paragraph(note) if note else ""


def _study_page(ds: xr.Dataset, kind: str) -> str:
    """Make the page about what a study has found."""
    study = studies()[kind]
    result = answer(ds, kind)
    shown = html.section("pictures", "Pictures", figures(ds, usual_pictures(ds, kind)))
    sections: tuple[str, ...]
    if study.viewer == "life":
        viewer = html.section("life", "Over passages", life_viewer(ds))
        sections = (viewer, html.section("outcome", "Steps", life_table(ds)), shown)
        return page(ds, "report", result.sentence, sections, ("common.js", "save.js", "life.js"))
    rows = () if study.rows_are_drawn else result.rows
    sections = (
        html.section("outcome", "Outcome", answer_tables(rows), law_table(ds)),
        shown,
        html.section("members", "Runs", member_table(ds, study.member_columns)),
    )
    return page(ds, "report", result.sentence, sections, ("common.js", "save.js"))


def write_report(
    ds: xr.Dataset, path: str | os.PathLike[str], *, overwrite: bool = False, teeth: bool | None = None
) -> Path:
    """Write the report of a dataset to a file.

    Parameters
    ----------
    ds : xarray.Dataset
        From `simulate`, `sweep` or `open_archive`.
    path : path-like
        HTML file to write.
    overwrite : bool, optional
        Whether a file that is there may be replaced.
    teeth : bool, optional
        As for `gearidae.report.build_report`.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    SceneError
        If the dataset carries no scene, the file exists and may not be replaced, or it cannot be written.
    """
    with whole_file(path, overwrite=overwrite, name="report") as part:
        part.write_text(build_report(ds, teeth=teeth), encoding="utf-8")
    return Path(path)


def _viewer(ds: xr.Dataset, most_values: int | None) -> str:
    """Place the viewer and its data; without samples there is nothing to view."""
    data = pack(ds, most_values)
    if not data:
        return ""
    choice = '<div id="choice"></div>\n' if len(data["runs"]) > 1 else ""
    return (
        choice
        + '<div id="viewer"><p class="hint">Drag to move, Shift + drag (or b) for a box to zoom into, pinch or Ctrl + '
        "wheel to zoom; with a plot focused: arrows, + and -, 0 for everything. All plots share their time.</p></div>\n"
        "<noscript><p>The viewer needs JavaScript; the pictures below do not.</p></noscript>\n"
        + html.json_block("data", data)
    )


def _teeth(ds: xr.Dataset, wanted: bool | None) -> str:
    """Place the view of the teeth and its data, or say why there is none; rollers have no teeth."""
    shown = runs_with_teeth(ds) if wanted is not False else []
    if not shown:
        return ""
    many = len(shown) < shown[0].of
    if wanted is None and (seconds := time_to_repeat(shown)) > (_SOON_OF_MANY if many else _SOON):
        again = f"run again, which takes about {in_words(seconds)}: gearidae report --teeth (teeth=True)"
        return html.paragraph(f"Not shown. For the teeth in mesh the scene must {again}.")
    try:
        data = pack_runs(shown, _STATES_OF_MANY) if many else pack_runs(shown)
    except SceneError as error:
        return html.paragraph(f"Not shown. {error}")
    which = f"{number_shown(shown)}: the first, the last, and those at which the outcome changes."
    return (
        (html.paragraph(which, "hint") if many else "")
        + '<div id="teeth-viewer"></div>\n'
        + html.json_block("teeth-data", data)
    )
