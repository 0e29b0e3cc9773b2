"""``gearidae report``: one self-contained page about an archive."""

from __future__ import annotations

from pathlib import Path

import gearidae as gd
from gearidae.cli.case import default_output
from gearidae.cli.codes import DONE
from gearidae.cli.output import say


def report_archive(archive: Path, output: Path | None, *, overwrite: bool, teeth: bool | None) -> int:
    """Write the report of an archive.

    Parameters
    ----------
    archive : Path
        What to report on.
    output : Path or None
        HTML file to write; None for the archive's name with ``.html``.
    overwrite : bool
        Whether the page may replace a file.
    teeth : bool or None
        Whether to show the teeth in mesh; None: unless it takes long.

    Returns
    -------
    int
        Exit code.

    Raises
    ------
    SceneError
        If the archive cannot be read or the page cannot be written.
    """
    from gearidae.archive.select import scene_of
    from gearidae.report import write_report
    from gearidae.runs.kept_validity import with_validity
    from gearidae.scene.validity_row import ATTRIBUTE
    from gearidae.studies.products import open_product

    ds, _ = open_product(archive)
    if ATTRIBUTE not in ds.attrs:
        ds = with_validity(ds, gd.Scene.from_dict(scene_of(ds)))
    target = output or default_output(str(archive), ".html")
    target = write_report(ds, target, overwrite=overwrite, teeth=teeth)
    say(f"Report: {target}")
    return DONE
