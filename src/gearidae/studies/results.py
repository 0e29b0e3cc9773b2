"""What `ds.gearidae` gives: the scene, single runs, verdicts and tables of a dataset."""

from __future__ import annotations

import html
import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from gearidae.archive.row_variables import LABELS, kinds_in, own_rows
from gearidae.archive.run_summary import RunSummary, summary_of
from gearidae.archive.select import is_roller, is_train, run_scene, runs, scene_of, single_run, swept_dims
from gearidae.archive.tables import LARGEST_TABLE, row_table, run_labels, time_series
from gearidae.archive.totals import energy_balance
from gearidae.archive.train import judged_view
from gearidae.archive.variables import EXTREMES, SAM_FRACTION, STANDSTILL_LIST
from gearidae.errors import SceneError
from gearidae.records import Events, Impacts, Passages
from gearidae.scene import Scene
from gearidae.scene.carried import number_of
from gearidae.scene.units import cf_unit, from_text
from gearidae.studies.declared import studies
from gearidae.studies.products import kind_of

if TYPE_CHECKING:
    import pandas as pd


class Results:
    """A dataset of gearidae, read as what it is; its text lists what it offers.

    Parameters
    ----------
    ds : xarray.Dataset

    Examples
    --------
    >>> import gearidae as gd
    >>> ds = gd.open("sweep.nc")  # doctest: +SKIP
    >>> ds.gearidae  # doctest: +SKIP
    >>> ds.gearidae.verdicts()  # doctest: +SKIP
    >>> ds.gearidae.run(sam_fraction=0.5).gearidae.scene.coating.sam_fraction  # doctest: +SKIP
    0.5
    """

    def __init__(self, ds: xr.Dataset) -> None:
        self._ds = ds

    def __repr__(self) -> str:
        """Say what the dataset is, and list what can be asked of it."""
        rows = list(self._offers())
        width = max((len(name) for name, _ in rows), default=0)
        return "\n".join([self._title(), *(f"  {name:<{width}}  {words}" for name, words in rows)])

    def _repr_html_(self) -> str:
        """Show the same in a notebook."""
        return f"<pre>{html.escape(repr(self))}</pre>"

    @property
    def kind(self) -> str:
        """What the dataset is: ``runs`` of `gearidae.simulate` and `gearidae.sweep`, else the name of a study.

        Raises
        ------
        SceneError
            If it is no dataset of gearidae.
        """
        scene_of(self._ds)
        return kind_of(self._ds)

    @property
    def scene(self) -> Scene:
        """The scene of a single run, also of one picked from a sweep by ``sel`` or ``isel``.

        Raises
        ------
        SceneError
            If the dataset carries none, or holds several runs: their scenes are `scenes`, what they were derived from
            is `template`.
        """
        return run_scene(self._ds)

    @property
    def scenes(self) -> list[Scene]:
        """The scenes of all runs; the last dimension changes fastest."""
        return [run_scene(run) for _, run in runs(self._ds)]

    @property
    def template(self) -> Scene:
        """The scene that the runs of a sweep were derived from; of a single run, its own."""
        return Scene.from_dict(scene_of(self._ds))

    @property
    def account(self) -> RunSummary | None:
        """Run summary of a single run; None for a roller, several runs, or without samples and events."""
        several = any(self._ds.sizes[dim] != 1 for dim in swept_dims(self._ds))
        return None if several else summary_of(single_run(self._ds))

    @property
    def energy_balance(self) -> dict[str, float] | None:
        """Energy balance of a single run [J] by the names of its variables, with ``time`` [s]; None without one."""
        return energy_balance(judged_view(self._ds))

    def sel(self, **labels: Any) -> xr.Dataset:
        """Pick runs by their labels, with only their own events.

        Parameters
        ----------
        **labels
            As for `run`.

        Returns
        -------
        xarray.Dataset

        Raises
        ------
        SceneError
            If a label is unknown.
        """
        ds = self._ds
        for name, value in labels.items():
            ds = _picked(ds, name, value)
        return own_rows(ds)

    def run(self, **labels: Any) -> xr.Dataset:
        """Pick one run by its labels, with its own scene and only its own events.

        Parameters
        ----------
        **labels
            Value of each swept key, by the name of its dimension or of a coordinate that was zipped with it
            (``sam_fraction=0.5``): numbers, as they are printed will do, or as in a scene with a unit (``"5 aN m"``).

        Returns
        -------
        xarray.Dataset
            What `gearidae.simulate` returns for that scene.

        Raises
        ------
        SceneError
            If a label is unknown, or the labels leave more runs than one.
        """
        ds = self.sel(**labels)
        several = [dim for dim in swept_dims(ds) if ds.sizes[dim] != 1]
        if several:
            named = ", ".join(f"{dim}={_shown(ds[dim].values[:1])}" for dim in several)
            raise SceneError(
                "run", _shown_labels(labels), f"leaves several runs: name one, such as run({named})"
            )
        return single_run(ds)

    def verdicts(self) -> pd.DataFrame:
        """Make a table of how the runs ended.

        Returns
        -------
        pandas.DataFrame
            A row for each run: the swept keys (of a single run ``sam_fraction``), ``verdict``, its ``words``,
            ``status``, what the solver has kept of the run (``min_gear_speed``, ``stick_time`` and so on, see the
            table of extremes in the reference; SI units), ``impacts`` and ``wall_time``.
        """
        import pandas as pd

        from gearidae.analysis.verdict import outcomes

        ds, dims = self._ds, swept_dims(self._ds)
        judged = outcomes(ds)
        columns: dict[str, Any] = run_labels(ds, dims)
        if (label := SAM_FRACTION.name) in ds.coords and not ds[label].dims:
            columns.setdefault(label, ds[label].values.item())
        for name in ("verdict", "words", "status"):
            columns[name] = [getattr(outcome, name) for outcome in judged]
        for name in EXTREMES:
            if name in ds and ds[name].dims == dims:
                columns[name] = ds[name].values.reshape(len(judged))
        for name in ("restitution", "impacts", "wall_time"):
            if hasattr(judged[0], name):
                columns[name] = [getattr(outcome, name) for outcome in judged]
        return pd.DataFrame(columns)

    def standstills(self) -> pd.DataFrame:
        """Make a table of the times at which the gears stood; see `gearidae.records.standing`.

        Returns
        -------
        pandas.DataFrame
            A row for each standstill, of more than 64 in a run the longest: the swept keys, ``begin`` and ``end`` [s],
            the end NaN where the run has ended before; ``advance`` and ``free_advance`` [pitches] of the gear and of
            free gears; ``held_torque`` [N m], the largest torque of the drive at the gear beyond the dry load;
            ``held_by``; ``verdict``, as if the run had ended there; ``rest_time`` [s], for which dry friction held
            all of the gear. Empty for a gear that never stood.

        Raises
        ------
        SceneError
            If the runs have not kept it: rollers, archives of version 0.2, sweeps that keep other parts.
        """
        import pandas as pd

        from gearidae.analysis.verdict.table import standstill_rows

        names, rows = standstill_rows(self._ds)
        return pd.DataFrame(rows, columns=names)

    def to_dataframe(
        self, variables: Sequence[str] | None = None, *, largest: float = LARGEST_TABLE
    ) -> pd.DataFrame:
        """Make a table of the samples; see `gearidae.archive.tables.time_series`.

        Parameters
        ----------
        variables : sequence of str, optional
            Which of the sampled variables; by default all.
        largest : float, optional
            Size that the table may have [bytes].

        Returns
        -------
        pandas.DataFrame
            By ``time``; of a sweep with a column for each swept key.
        """
        return time_series(self._ds, variables, largest=largest)

    def train(self) -> xr.Dataset:
        """Return a run of gears along ``shaft`` and ``mesh``, whatever the form of its scene.

        Returns
        -------
        xarray.Dataset
            A run of a train as it is; that of a pair with the shafts ``pinion`` and ``gear`` and the mesh ``mesh``.

        Raises
        ------
        SceneError
            If it is a run of a roller.
        """
        from gearidae.archive.train import train_form

        return train_form(self._ds)

    def work(self) -> pd.DataFrame:
        """Make a table of where the work of the drive goes in a run of a train.

        Returns
        -------
        pandas.DataFrame
            By ``name``, from the drive to the load (``mesh first``, ``hub of middle``, ``load``, ``kinetic energy``):
            ``energy`` [J] and its ``share`` of the drive's work. The shares add up to 1.

        Raises
        ------
        SceneError
            If it is no single run of a train of several meshes.
        """
        import pandas as pd

        from gearidae.archive.train import work_shares

        rows = work_shares(self._ds)
        table = {name: [getattr(row, name) for row in rows] for name in ("energy", "share")}
        return pd.DataFrame(table, index=pd.Index([row.name for row in rows], name="name"))

    def events(self) -> pd.DataFrame:
        """Make a table of the events of these runs; see `gearidae.archive.tables.row_table`."""
        return row_table(self._ds, Events)

    def passages(self) -> pd.DataFrame:
        """Make a table of the passages of these runs: forces since the last mesh exit, and running sums of energies."""
        return row_table(self._ds, Passages)

    def impacts(self) -> pd.DataFrame:
        """Make a table of the impacts of these runs, one row for each contact of a tooth pair, onset to separation.

        Times and speeds, forces, impulse and loss of each, from the engine's own steps; needs ``run.impacts``.
        """
        return row_table(self._ds, Impacts)

    def _title(self) -> str:
        """Say what the dataset is, in a line."""
        ds = self._ds
        try:
            kind = self.kind
        except SceneError as error:
            return f"<no dataset of gearidae: it {error.allowed}>"
        if kind != "runs":
            return f"<{studies()[kind].words}: {studies()[kind].sentence(ds)}>"
        name, dims = scene_of(ds).get("name", ""), swept_dims(ds)
        along = ", ".join(f"{dim} ({_shown(ds[dim].values)})" for dim in dims)
        count = math.prod(ds.sizes[dim] for dim in dims)
        of = "" if "name" in dims else f" of {name}"
        what = f"{count} runs{of} along {along}" if dims else f"run of {name}"
        ended = ": ".join(
            filter(None, (str(ds.attrs.get(attribute, "")) for attribute in ("status", "message")))
        )
        return f"<{what}, {ended}>"

    def _offers(self) -> Iterator[tuple[str, str]]:
        """What can be asked of the dataset, with what it is."""
        ds = self._ds
        if "scene" not in ds.attrs and "scene" not in ds.variables:
            return
        kind = kind_of(ds)
        dims = [dim for dim in swept_dims(ds) if ds.sizes[dim] != 1]
        single, of_runs = (
            not dims,
            kind == "runs" or ("swept" in ds.attrs and "min_gear_speed" in ds),
        )  # of ensembles, too
        labels = ", ".join(f"{dim}={_label(ds[dim])}" for dim in dims)
        names = {
            "scene": of_runs and single,
            f"run({labels})": of_runs and not single,
            "sel": of_runs and not single,
            "scenes": of_runs and not single,
            "template": not (of_runs and single),
            "account": of_runs and single and not is_roller(ds) and not is_train(ds),
            "energy_balance": of_runs and single,
            "verdicts()": of_runs,
            "work()": of_runs and single and is_train(ds),
            "standstills()": of_runs and STANDSTILL_LIST.name in ds,
            "to_dataframe()": "time" in ds.dims,
            **{f"{kind.field}()": True for kind in kinds_in(ds)},
        }
        for name, offered in names.items():
            if offered:
                yield name, _first_line(getattr(type(self), name.partition("(")[0]))
        if kind == "runs":
            yield "gearidae.plot.overview(ds)", "Pictures of the runs"
            return
        for picture in studies()[kind].pictures:
            if picture.needs(ds):
                yield f"gearidae.plot.{picture.name}(ds)", picture.caption


def _picked(ds: xr.Dataset, name: str, value: Any) -> xr.Dataset:
    """Pick the runs that have a value of a coordinate."""
    dims = swept_dims(ds)
    known = [str(coordinate) for coordinate in ds.coords if coordinate not in LABELS]
    if name not in known:
        raise SceneError("run", name, f"must be one of {', '.join(known)}")
    labels = np.atleast_1d(ds[name].values)
    asked, value = value, _plain(ds[name], value) if labels.dtype.kind in "fiu" else value
    if labels.dtype.kind in "fiu" and isinstance(value, int | float | np.number):
        # a value as it is printed is not always the same float
        exact = labels == value
        matches = exact if exact.any() else np.isclose(labels, float(value), rtol=1e-9, atol=0.0)
    else:
        matches = labels == value
    if not np.any(matches):
        raise SceneError(f"run({name})", asked, f"must be one of {_shown(labels)}")
    if not ds[name].dims:
        return ds
    (dim,) = ds[name].dims
    assert dim in dims
    indices = np.flatnonzero(matches)
    return ds.isel({dim: int(indices[0]) if len(indices) == 1 else indices})


def _plain(label: xr.DataArray, value: Any) -> Any:
    """Turn a value with a unit, in a text or a quantity, into the number that it is [SI]."""
    unit = cf_unit(str(label.attrs.get("units", "1")))
    try:
        number = from_text(value, unit) if isinstance(value, str) else number_of(value, unit)
    except ValueError as error:
        raise SceneError(f"run({label.name})", value, str(error)) from None
    return value if number is None else number


def _first_line(member: Any) -> str:
    return str(member.__doc__).partition("\n")[0].partition(";")[0].rstrip(".")


def _label(values: xr.DataArray) -> str:
    """Write the first label of a dimension as Python does."""
    return repr(values.values[:1].tolist()[0])


def _shown(values: np.ndarray[Any, Any]) -> str:
    shown = [f"{value:g}" if isinstance(value, float) else str(value) for value in values.tolist()]
    return ", ".join(shown if len(shown) <= 12 else [*shown[:6], "...", *shown[-3:]])


def _shown_labels(labels: dict[str, Any]) -> str:
    return ", ".join(f"{name}={value}" for name, value in labels.items()) or "()"
