"""The teeth in mesh as a moving picture."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, PillowWriter
from matplotlib.figure import Figure

from gearidae.errors import SceneError
from gearidae.plot.files import BY_FFMPEG, MOVING, whole_file
from gearidae.plot.teeth_view import TeethView, mesh_states, recorded_until

_MOST_FRAMES = 5000


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
    if not 2 <= frames <= _MOST_FRAMES:
        raise SceneError("frames", frames, f"must lie in 2..{_MOST_FRAMES}")
    if not 1 <= rate <= 100:
        raise SceneError("rate", rate, "must be 1 to 100 pictures per second")
    with whole_file(path, MOVING, overwrite=overwrite) as part:
        writer = _writer(Path(path), rate)
        last = recorded_until(ds) if stop is None else stop
        if not start < last:
            raise SceneError("stop", last, f"must come after the start, {start:g} s")
        states = mesh_states(ds, np.linspace(start, last, frames))
        view = TeethView(ds, states)
        assert isinstance(view.figure, Figure)
        with writer.saving(view.figure, str(part), dpi):
            for state in states:
                view.draw(state)
                writer.grab_frame()
    return Path(path)


def _writer(path: Path, rate: int) -> AbstractMovieWriter:
    if path.suffix.lower().removeprefix(".") not in BY_FFMPEG:
        return PillowWriter(fps=rate)
    if not FFMpegWriter.isAvailable():
        raise SceneError("picture", path, "needs the program ffmpeg, which is not installed; .gif does not")
    return FFMpegWriter(fps=rate)
