"""The teeth in mesh, and whole trains, as moving pictures."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple, Protocol, TypeVar

import numpy as np
import xarray as xr
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, PillowWriter
from matplotlib.figure import Figure, SubFigure

from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.plot.files import BY_FFMPEG, MOVING, note_in_gif, whole_file
from gearidae.plot.teeth_view import TeethView, mesh_states, recorded_until
from gearidae.plot.train_view import TrainState, TrainView, train_run, train_states
from gearidae.records.tooth_states import MeshState

_MOST_FRAMES = 5000
_State = TypeVar("_State")
_Shown = TypeVar("_Shown", contravariant=True)


def animate_teeth(
    ds: xr.Dataset,
    path: str | os.PathLike[str],
    *,
    start: float = 0.0,
    stop: float | None = None,
    frames: int = 100,
    rate: int = 12,
    overwrite: bool = False,
    dpi: float = 100.0,
) -> Path:
    """Draw the teeth in mesh from one time to another, as `teeth` does for a single one, into a file.

    Teeth with errors of their own stand where they are, errors and gaps enlarged by the factor that the picture states.

    Parameters
    ----------
    ds : xarray.Dataset
        One run of a gear pair; from a sweep, one selected with ``sel``.
    path : path-like
        File to write; its extension determines the format: gif or webp, or mp4 or webm where ffmpeg is installed.
    start, stop : float, optional
        First and last time [s]; by default the whole record.
    frames : int, optional
        Number of pictures, evenly spaced in time.
    rate : int, optional
        Pictures per second.
    overwrite : bool, optional
        Whether a file that is there may be replaced.
    dpi : float, optional
        Dots per inch; a picture is 7.6 inches wide.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    SceneError
        If the dataset is of a roller, of several runs, or has no samples, or its run cannot be repeated; if a time lies
        outside of them, a number makes no sense, or the file exists and may not be replaced, is of another kind or
        cannot be written.
    """

    def seen(times: Floats) -> tuple[TeethView, list[MeshState]]:
        states = mesh_states(ds, times)
        return TeethView(ds, states), states

    options = _Options(start, stop, frames, rate, overwrite, dpi)
    return _animate(path, options, lambda: recorded_until(ds), seen)


def animate_train(
    ds: xr.Dataset,
    path: str | os.PathLike[str],
    *,
    start: float = 0.0,
    stop: float | None = None,
    frames: int = 100,
    rate: int = 12,
    overwrite: bool = False,
    dpi: float = 100.0,
) -> Path:
    """Draw a whole train from one time to another, as `train` does for a single one, into a file.

    Parameters
    ----------
    ds : xarray.Dataset
        One run of a train of several meshes; from a sweep, one selected with ``sel``.
    path : path-like
        File to write; its extension determines the format: gif or webp, or mp4 or webm where ffmpeg is installed.
    start, stop : float, optional
        First and last time [s]; by default the whole record.
    frames : int, optional
        Number of pictures, evenly spaced in time, each of the nearest sample.
    rate : int, optional
        Pictures per second.
    overwrite : bool, optional
        Whether a file that is there may be replaced.
    dpi : float, optional
        Dots per inch; a picture is 7.6 inches wide.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    SceneError
        If the dataset is not of a train, of several runs, or has no samples; if a time lies outside of them, a number
        makes no sense, or the file exists and may not be replaced, is of another kind or cannot be written.
    """

    def seen(times: Floats) -> tuple[TrainView, list[TrainState]]:
        run = train_run(ds)
        states = train_states(run, times)
        return TrainView(run, states), states

    options = _Options(start, stop, frames, rate, overwrite, dpi)
    return _animate(path, options, lambda: float(train_run(ds)["time"][-1]), seen)


class _Options(NamedTuple):
    start: float
    stop: float | None
    frames: int
    rate: int
    overwrite: bool
    dpi: float


class _View(Protocol[_Shown]):
    """A figure in which states can be drawn one after the other."""

    figure: Figure | SubFigure

    def draw(self, state: _Shown) -> None: ...


def _animate(
    path: str | os.PathLike[str],
    options: _Options,
    until: Callable[[], float],
    seen: Callable[[Floats], tuple[_View[_State], list[_State]]],
) -> Path:
    """Draw what is seen at evenly spaced times."""
    if not 2 <= options.frames <= _MOST_FRAMES:
        raise SceneError("frames", options.frames, f"must lie in 2..{_MOST_FRAMES}")
    if not 1 <= options.rate <= 100:
        raise SceneError("rate", options.rate, "must be 1 to 100 pictures per second")
    with whole_file(path, MOVING, overwrite=options.overwrite) as part:
        writer = _writer(Path(path), options.rate)
        last = until() if options.stop is None else options.stop
        if not options.start < last:
            raise SceneError("stop", last, f"must come after the start, {options.start:g} s")
        view, states = seen(np.linspace(options.start, last, options.frames))
        assert isinstance(view.figure, Figure)
        with writer.saving(view.figure, str(part), options.dpi):
            for state in states:
                view.draw(state)
                writer.grab_frame()
        if part.suffix == ".gif":
            note_in_gif(part)
    return Path(path)


def _writer(path: Path, rate: int) -> AbstractMovieWriter:
    if path.suffix.lower().removeprefix(".") not in BY_FFMPEG:
        return PillowWriter(fps=rate)
    if not FFMpegWriter.isAvailable():
        raise SceneError("picture", path, "needs the program ffmpeg, which is not installed; .gif does not")
    return FFMpegWriter(fps=rate)
