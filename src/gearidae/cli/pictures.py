"""``gearidae plot``, ``report`` and ``explore``: a file of runs or of a study as a picture or a page."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
from matplotlib.figure import Figure

import gearidae as gd
from gearidae.archive.select import scene_of, single_run, swept_dims
from gearidae.archive.target import is_our_own
from gearidae.cli.case import default_output, selected
from gearidae.cli.codes import DONE
from gearidae.cli.output import print_line
from gearidae.drawing.picture import usual_style
from gearidae.errors import SceneError
from gearidae.plot.files import MOVING
from gearidae.plot.overview import usual_pictures
from gearidae.scene.group import did_you_mean
from gearidae.scene.pairs import quantity
from gearidae.studies.products import open_product

_NO_PICTURES = ("animate_teeth", "animate_train", "style", "tooth_outline", "write")
_MOVING = {"teeth": "animate_teeth", "train": "animate_train"}
"""Pictures of one time, and what draws them as time goes on."""
_INCH = 0.0254
_DPI_OF_FRAMES = 100.0


def picture_names() -> list[str]:
    """List the names of the pictures."""
    return [name for name in gd.plot.__all__ if name not in _NO_PICTURES]


@usual_style()
def draw(
    archive: Path,
    picture: str | None,
    output: Path | None,
    *,
    select: Sequence[str],
    time: str | None,
    span: tuple[str | None, str | None],
    frames: int | None,
    size: str | None,
    dpi: float | None,
    style: str | None,
    overwrite: bool,
) -> int:
    """Draw an archive, or another file of the commands, into an image file.

    Parameters
    ----------
    archive : Path
        What to draw.
    picture : str or None
        Name of a function of `gearidae.plot`; None for the overview, the map, or outcomes where there are no samples.
    output : Path or None
        Image to write, its format by its extension; None for the archive's name, with that of the picture where one is
        named, and ``.png``, or ``.gif`` for a moving picture.
    select : sequence of str
        ``dimension=value``: which run of a sweep.
    time : str or None
        When to draw the teeth or the train, in seconds or with a unit.
    span : tuple of str or None
        First and last time of a moving picture.
    frames : int or None
        Its number of pictures.
    size : str or None
        Width and height with their unit.
    dpi : float or None
        Dots per inch.
    style : str or None
        As for `gearidae.plot.style`.
    overwrite : bool
        Whether the image may replace any file; under a name of its own it replaces what this program has made.

    Returns
    -------
    int
        Exit code.

    Raises
    ------
    SceneError
        If the archive cannot be read, there is no such picture or run in it, or the image cannot be written.
    """
    pictures = picture_names()
    if picture is not None and picture not in pictures:
        meant = did_you_mean(picture, pictures)
        raise SceneError(
            "--picture", picture, f"must be one of {', '.join(pictures)}{'; ' if meant else ''}{meant}"
        )
    asked: dict[str, object] = {"--time": time, "--from": span[0], "--to": span[1], "--frames": frames}
    asked["--output"] = output if output is not None and _is_moving(output) else None
    options = {option: str(value) for option, value in asked.items() if value is not None}
    if options and picture not in _MOVING:
        raise SceneError(*next(iter(options.items())), "needs --picture teeth or --picture train")
    if dpi is not None and not 10.0 <= dpi <= 2400.0:
        raise SceneError("--dpi", dpi, "must lie in 10..2400")
    if style is not None:
        gd.plot.style(style)
    inches = None if size is None else _inches(size)
    if inches is not None:
        mpl.rcParams["figure.figsize"] = inches
    moves = bool(options.keys() - {"--time"})
    ds, kind = open_product(archive)
    usual = next(iter(usual_pictures(ds, kind)))
    ds = selected(ds, select, "--select", swept_dims(ds) if select else ())
    ending = ".gif" if moves else ".png"
    target, replaces = _place(
        archive, output, ending if picture is None else f"_{picture}{ending}", overwrite=overwrite
    )
    if moves:
        if time is not None:
            raise SceneError(
                "--time", time, "is for a single picture; a moving picture needs --from and --to"
            )
        start, stop = span
        getattr(gd.plot, _MOVING[str(picture)])(
            ds,
            target,
            start=0.0 if start is None else quantity("--from", start, "s"),
            stop=None if stop is None else quantity("--to", stop, "s"),
            frames=100 if frames is None else frames,
            overwrite=replaces,
            dpi=_DPI_OF_FRAMES if dpi is None else dpi,
        )
    else:
        at = {} if time is None else {"time": quantity("--time", time, "s")}
        drawn = getattr(gd.plot, picture or usual)(ds, **at)
        figure = drawn if isinstance(drawn, Figure) else drawn.get_figure(root=True)
        assert figure is not None
        if inches is not None:
            figure.set_size_inches(inches)
        gd.plot.write(figure, target, overwrite=replaces, dpi=dpi)
    print_line(f"Picture: {target}")
    return DONE


def _place(archive: Path, output: Path | None, ending: str, *, overwrite: bool) -> tuple[Path, bool]:
    """Name the file to write, and say whether it may replace one: by default a picture or page made before."""
    if output is not None:
        return output, overwrite
    target = default_output(str(archive), ending)
    return target, overwrite or is_our_own(target)


def _inches(text: str) -> tuple[float, float]:
    """Read a width and a height, in inches or in a unit of length."""
    parts = [part.strip() for part in text.split(",")]
    if len(parts) != 2:
        raise SceneError("--size", text, "must be a width and a height, such as 3.4 in, 2.4 in")
    lengths = [quantity("--size", part, "m") for part in parts]
    if not all(0.5 * _INCH <= length <= 50.0 * _INCH for length in lengths):
        raise SceneError("--size", text, "must lie in 0.5..50 inches (in, mm, cm)")
    return lengths[0] / _INCH, lengths[1] / _INCH


def _is_moving(path: Path) -> bool:
    return path.suffix.lower().removeprefix(".") in MOVING


def report_archive(
    archive: Path, output: Path | None, *, select: Sequence[str], overwrite: bool, teeth: bool | None
) -> int:
    """Write the report of an archive.

    Parameters
    ----------
    archive : Path
        What to report on.
    output : Path or None
        HTML file to write; None for the archive's name with ``.html``.
    select : sequence of str
        ``dimension=value``: which part of a sweep.
    overwrite : bool
        Whether the page may replace any file; under a name of its own it replaces what this program has made.
    teeth : bool or None
        Whether to show the teeth in mesh; None: unless it takes long.

    Returns
    -------
    int
        Exit code.

    Raises
    ------
    SceneError
        If the archive cannot be read, has no such runs, or the page cannot be written.
    """
    from gearidae.report import write_report
    from gearidae.runs.kept_validity import with_validity
    from gearidae.scene.validity_row import ATTRIBUTE

    ds, kind = open_product(archive)
    if select and kind != "runs":
        raise SceneError("--select", select[0], f"needs a sweep, not the file of a study ({kind})")
    if select:
        ds = selected(ds, select, "--select", swept_dims(ds))
        ds = ds if swept_dims(ds) else single_run(ds)
    if ATTRIBUTE not in ds.attrs:
        ds = with_validity(ds, gd.Scene.from_dict(scene_of(ds)))
    target, replaces = _place(archive, output, ".html", overwrite=overwrite)
    write_report(ds, target, overwrite=replaces, teeth=teeth)
    print_line(f"Report: {target}")
    return DONE


def explore_archive(
    archive: Path,
    output: Path | None,
    *,
    select: Sequence[str],
    span: tuple[str | None, str | None],
    overwrite: bool,
    teeth: bool,
) -> int:
    """Write the page to look through the runs of an archive.

    Parameters
    ----------
    archive : Path
        With runs of gears.
    output : Path or None
        HTML file to write; None for the archive's name with ``_explore.html``.
    select : sequence of str
        ``dimension=value``: which part of a sweep.
    span : tuple of str or None
        First and last time, in seconds or with a unit.
    overwrite : bool
        Whether the page may replace any file; under a name of its own it replaces what this program has made.
    teeth : bool
        Whether to add what each pair of teeth does.

    Returns
    -------
    int
        Exit code.

    Raises
    ------
    SceneError
        If the archive cannot be read, has no such runs or no samples of them, or the page cannot be written.
    """
    ds, _ = open_product(archive)
    ds = selected(ds, select, "--select", swept_dims(ds) if select else ())
    ends = [
        None if text is None else quantity(option, text, "s")
        for option, text in zip(("--from", "--to"), span, strict=True)
    ]
    if ends != [None, None] and "time" in ds.dims:
        ds = ds.sel(time=slice(*ends))
    target, replaces = _place(archive, output, "_explore.html", overwrite=overwrite)
    gd.explore(ds, target, overwrite=replaces, teeth=teeth)
    print_line(f"Page: {target}")
    return DONE
