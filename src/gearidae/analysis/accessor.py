"""What `ds.gearidae` gives: the scene, single runs, verdicts and tables of a dataset."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from gearidae.archive.energy import energy_balance
from gearidae.archive.run_summary import Account, account
from gearidae.archive.select import run_scene, runs, scene_of, swept_dims
from gearidae.archive.single import single_run
from gearidae.archive.tables import LARGEST_TABLE, event_table, run_labels, time_series
from gearidae.archive.variables import EXTREMES
from gearidae.errors import SceneError
from gearidae.scene import Scene

if TYPE_CHECKING:
    import pandas as pd


class Results:
    """A dataset of `gearidae.simulate`, `gearidae.sweep` or `gearidae.open_archive`, read as what it is.

    Parameters
    ----------
    ds : xarray.Dataset

    Examples
    --------
    >>> import gearidae as gd
    >>> ds = gd.open_archive("sweep.nc")  # doctest: +SKIP
    >>> ds.gearidae.verdicts()  # doctest: +SKIP
    >>> ds.gearidae.run(sam_fraction=0.5).gearidae.scene.coating.sam_fraction  # doctest: +SKIP
    0.5
    """

    def __init__(self, ds: xr.Dataset) -> None:
        self._ds = ds

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
    def account(self) -> Account | None:
        """Run summary of a single run; None for a roller, several runs, or without samples and events."""
        several = any(self._ds.sizes[dim] != 1 for dim in swept_dims(self._ds))
        return None if several else account(single_run(self._ds))

    @property
    def energy_balance(self) -> dict[str, float] | None:
        """Energy balance of a single run [J] by the names of its variables, with ``time`` [s]; None without one."""
        return energy_balance(self._ds)

    def run(self, **labels: Any) -> xr.Dataset:
        """Pick one run, with its own scene and only its own events.

        Parameters
        ----------
        **labels
            Value of each swept key, by the name of its dimension or of a coordinate that was zipped with it
            (``sam_fraction=0.5``); numbers as they are printed will do.

        Returns
        -------
        xarray.Dataset
            What `gearidae.simulate` returns for that scene.

        Raises
        ------
        SceneError
            If a label is unknown, or the labels leave more runs than one.
        """
        ds = self._ds
        for name, value in labels.items():
            ds = _picked(ds, name, value)
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
        if "sam_fraction" in ds.coords and not ds["sam_fraction"].dims:
            columns.setdefault("sam_fraction", ds["sam_fraction"].values.item())
        for name in ("verdict", "words", "status"):
            columns[name] = [getattr(each, name) for each in judged]
        for name in EXTREMES:
            if name in ds and ds[name].dims == dims:
                columns[name] = ds[name].values.reshape(len(judged))
        for name in ("restitution", "impacts", "wall_time"):
            if hasattr(judged[0], name):
                columns[name] = [getattr(each, name) for each in judged]
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

        from gearidae.analysis.verdict.standstills import standstill_rows

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

    def events(self) -> pd.DataFrame:
        """Make a table of the events of these runs; see `gearidae.archive.tables.event_table`."""
        return event_table(self._ds)


def _picked(ds: xr.Dataset, name: str, value: Any) -> xr.Dataset:
    """Pick the runs that have a value of a coordinate."""
    dims = swept_dims(ds)
    known = [str(each) for each in ds.coords if each not in ("time", "event")]
    if name not in known:
        raise SceneError("run", name, f"must be one of {', '.join(known)}")
    labels = np.atleast_1d(ds[name].values)
    if labels.dtype.kind in "fiu" and isinstance(value, int | float | np.number):
        # a value as it is printed is not always the same float
        exact = labels == value
        found = exact if exact.any() else np.isclose(labels, float(value), rtol=1e-9, atol=0.0)
    else:
        found = labels == value
    if not np.any(found):
        raise SceneError(f"run({name})", value, f"must be one of {_shown(labels)}")
    if not ds[name].dims:
        return ds
    (dim,) = ds[name].dims
    assert dim in dims
    places = np.flatnonzero(found)
    return ds.isel({dim: int(places[0]) if len(places) == 1 else places})


def _shown(values: np.ndarray[Any, Any]) -> str:
    shown = [f"{value:g}" if isinstance(value, float) else str(value) for value in values.tolist()]
    return ", ".join(shown if len(shown) <= 12 else [*shown[:6], "...", *shown[-3:]])


def _shown_labels(labels: dict[str, Any]) -> str:
    return ", ".join(f"{name}={value}" for name, value in labels.items()) or "()"
