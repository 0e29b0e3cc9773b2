"""What a study is: a question about a scene, how it is answered, and what its file says to those who read it.

The command, the kind of the file, ``gearidae info``, the report, the pictures and the tables of the reference follow
from a `Study`. The files that declare one are in `gearidae.studies.declared`.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import xarray as xr

from gearidae.archive.agreement import disagreement
from gearidae.archive.attributes import readable_scene
from gearidae.archive.netcdf_access import loaded
from gearidae.archive.output_selection import EVERYTHING, OutputSelection
from gearidae.errors import SceneError

if TYPE_CHECKING:
    from gearidae.runs.execution import Execution
    from gearidae.runs.run_cache import RunCache
    from gearidae.scene import Scene

_HEADERS = (b"\x89HDF\r\n\x1a\n", b"CDF")
"""How netCDF files begin, those of version 4 and the older ones."""
Rows: TypeAlias = Iterator[tuple[str, str, str]]
"""Names, values and remarks; a row without a value is a heading."""


@dataclass(frozen=True, slots=True)
class Column:
    """A variable of a study's dataset, or a coordinate, whose only dimension has its name.

    Attributes
    ----------
    dims : tuple of str
    units, words : str
        Its unit, empty where it differs along the variable, and what it is. ``{name}`` stands for what `Study.dataset`
        is given for that name.
    required : bool, optional
        Whether a file without it is something else.
    """

    dims: tuple[str, ...]
    units: str
    words: str
    required: bool = True

    def attributes(self, **named: str) -> dict[str, str]:
        """Attributes of the variable."""
        texts = {"units": self.units.format(**named), "long_name": self.words.format(**named)}
        return {name: text for name, text in texts.items() if text}


@dataclass(frozen=True, slots=True)
class Option:
    """How an option of a study's command is written, as the metadata of its annotation.

    Attributes
    ----------
    help : str
        What it is.
    repeatable : bool, optional
        Whether the option stands in front of each of its values.
    many : bool, optional
        Whether several values follow the option.
    completes : str, optional
        Function of `gearidae.cli.completing` that offers the shell its values.
    """

    help: str
    repeatable: bool = False
    many: bool = False
    completes: str = ""


@dataclass(frozen=True, slots=True)
class Picture:
    """A picture of what a study has found.

    Attributes
    ----------
    name : str
        In `gearidae.plot`.
    caption : str
    needs : callable, optional
        Whether a dataset has something to draw.
    draw : callable, optional
        Draws a dataset; without one, `gearidae.plot` has a file with the function of that name.
    """

    name: str
    caption: str
    needs: Callable[[xr.Dataset], bool] = bool
    draw: Callable[..., Any] | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Study:
    """A study.

    Attributes
    ----------
    kind : str
        Of its file.
    words : str
        What the file is.
    maker : str
        Command that makes one.
    sentence : callable
        Answers the question in a sentence, from the dataset.
    rows : callable
        Rows of the summary and the report, from the dataset.
    pictures : tuple of Picture
        The one that says most first.
    columns : mapping of str to Column, optional
        What the dataset has beside the variables of runs.
    check : callable, optional
        Raises a `SceneError` if a dataset is something else, in place of a look at the columns.
    run : str, optional
        The function of `gearidae.studies`, by default that of the kind's name.
    title, suffix : str, optional
        What the command calls it, and the end of the name of its file.
    command : callable, optional
        Makes arguments of the function from what is written otherwise on the command line: its parameters are options.
    options : tuple of str, optional
        Parameters of the function that are options as they are: their types, defaults and words are those of the
        function. ``life.fraction`` is a parameter of `gearidae.studies.life`.
    announcement : callable, optional
        Says what will be run, from the scene, the number of simultaneous runs (None on a cluster) and the arguments of
        the function as keywords. A study with it has a command.
    members : callable, optional
        Of an ensemble, the keys in which its members differ and their number, from the arguments as keywords.
    examples : tuple of str, optional
        Command lines.
    member_columns : tuple of str, optional
        Variables that the report lists for each member.
    rows_are_drawn : bool, optional
        Whether the picture shows what the rows say, so that the report needs no rows.
    viewer : str, optional
        Of the report, see `gearidae.report.page`.
    """

    kind: str
    words: str
    maker: str
    sentence: Callable[[xr.Dataset], str]
    rows: Callable[[xr.Dataset], Rows]
    pictures: tuple[Picture, ...]
    columns: Mapping[str, Column] = field(default_factory=dict)
    check: Callable[[xr.Dataset], object] | None = None
    run: str = ""
    title: str = ""
    suffix: str = ""
    command: Callable[..., Mapping[str, Any]] = dict
    options: tuple[str, ...] = ()
    announcement: Callable[..., str] | None = None
    members: Callable[..., tuple[Iterable[str], int]] | None = None
    examples: tuple[str, ...] = ()
    member_columns: tuple[str, ...] = ()
    rows_are_drawn: bool = False
    viewer: str = ""

    def require(self, ds: xr.Dataset) -> xr.Dataset:
        """Return a dataset of this study.

        Raises
        ------
        SceneError
            If it is something else.
        """
        if self.check is not None:
            self.check(ds)
            return ds
        lacking = [
            name
            for name, column in self.columns.items()
            if column.required
            and (
                name not in ds.variables
                or ds[name].dims[:1] != column.dims[:1]
                or not ds.sizes[column.dims[0]]
            )
        ]
        if lacking:
            allowed = f"is no {self.words}: it lacks {', '.join(lacking)}; make one with {self.maker}"
            raise SceneError("dataset", type(ds).__name__, allowed)
        return ds

    def open(self, path: str | os.PathLike[str]) -> xr.Dataset:
        """Read a file of this study.

        Raises
        ------
        SceneError
            If it cannot be read or is something else.
        """
        ds = self.read(path)
        try:
            self.require(ds)
        except SceneError as error:
            other = "; gearidae.open reads it as what it is" if "scene" in ds.attrs else ""
            raise SceneError(self._file, path, f"{error.allowed}{other}") from None
        return self.undamaged(ds, path)

    def undamaged(self, ds: xr.Dataset, path: str | os.PathLike[str]) -> xr.Dataset:
        """Return what has been read from a file of this study.

        Raises
        ------
        SceneError
            If it has lost its scene, or its parts do not fit together.
        """
        if readable_scene(ds.attrs.get("scene")) is None:
            wrong = f"its scene is {'not readable' if 'scene' in ds.attrs else 'missing'}"
        else:
            wrong = disagreement(ds, runs=False)
        for name, column in self.columns.items():
            units = column.units if "{" not in column.units else ""  # the scene says which
            if units and name in ds and ds[name].attrs.get("units", units) != units:
                wrong = (
                    wrong or f"its variable {name} is in {ds[name].attrs['units']}, and must be in {units}"
                )
        if wrong:
            raise SceneError(self._file, path, f"is damaged: {wrong}")
        return ds

    def read(self, path: str | os.PathLike[str]) -> xr.Dataset:
        """Read a netCDF file, whatever is in it; errors say that it is no file of this study."""
        source = Path(path)
        if not source.is_file():
            raise SceneError(self._file, path, "there is no such file")
        try:
            with source.open("rb") as file:
                head = file.read(8)
        except OSError as error:
            raise SceneError(self._file, path, f"cannot be read ({error.strerror})") from error
        if not head.startswith(_HEADERS):
            allowed = f"is no {self.words} but another kind of file; make one with {self.maker}"
            raise SceneError(self._file, path, allowed)
        try:
            return loaded(source)
        except Exception as error:
            raise SceneError(self._file, path, f"is damaged ({error})") from error

    @property
    def _file(self) -> str:
        """What errors call the file: ``map``."""
        return self.kind.rpartition("_")[2]

    def dataset(self, values: Mapping[str, Any], attributes: Mapping[str, Any], **named: str) -> xr.Dataset:
        """Make the dataset of what was found.

        Parameters
        ----------
        values : mapping of str to array_like
            Of the columns; of those that are missing the dataset has none.
        attributes : mapping of str to object
            Of the dataset.
        **named
            What the columns' units and words name in braces.
        """
        made = {
            name: (column.dims, values[name], column.attributes(**named))
            for name, column in self.columns.items()
            if name in values
        }
        coords = {name: variable for name, variable in made.items() if variable[0] == (name,)}
        return xr.Dataset(
            {name: variable for name, variable in made.items() if name not in coords},
            coords,
            dict(attributes),
        )

    def compute(
        self,
        execution: Execution,
        base: Scene,
        work: Callable[[RunCache | None], xr.Dataset],
        settings: object,
        *,
        origin: Scene | None = None,
        selection: OutputSelection = EVERYTHING,
        **more: Any,
    ) -> xr.Dataset:
        """Compute the dataset by `work`, whose runs are kept beside the archive until it is written.

        Parameters
        ----------
        base : Scene
            Any of the runs.
        settings : object
            What the result depends on besides the scene, ready for JSON.
        origin : Scene, optional
            The scene that the question was about; by default `base`.
        selection : OutputSelection, optional
            What each run leaves behind.
        **more
            As for `gearidae.runs.execution.run_kept`, whose errors these are too.
        """
        from gearidae.runs.execution import origin_of, run_kept
        from gearidae.runs.run_cache import RunCache

        def store(target: Path) -> RunCache:
            return RunCache(target, base, execution.driver, selection)

        about = {**origin_of(base if origin is None else origin), "settings": json.dumps(settings)}
        return run_kept(execution, store, work, about, read=self.open, **more)
