"""Answers for programs: one JSON object on standard output, SI units, null where there is no number."""

from __future__ import annotations

import json
import math
from collections.abc import Collection, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gearidae.analysis.verdict import outcomes
from gearidae.archive.journal import file_of
from gearidae.archive.run_summary import summary_of
from gearidae.archive.select import is_train, scene_of, swept_dims
from gearidae.archive.tables import row_table
from gearidae.archive.totals import energy_balance
from gearidae.archive.train import judged_view, passed_on, work_shares
from gearidae.citing import cite
from gearidae.cli.output import print_answer
from gearidae.records import Impacts
from gearidae.runs.kept_validity import validity_of

if TYPE_CHECKING:
    import xarray as xr

_ATTRIBUTES = (
    "title", "history", "source", "product_version", "status", "message", "t_end", "rtol", "steps",
    "residual_evaluations", "jacobian_evaluations", "restarts", "wall_time", "backend", "method",
)  # fmt: skip


def print_json(facts: Mapping[str, Any]) -> None:
    """Print facts as one JSON object; what is not a number or infinite becomes null, which JSON has instead."""
    print_answer(json.dumps(_plain(facts), indent=2, allow_nan=False))


def archive_facts(archive: Path, ds: xr.Dataset) -> dict[str, Any]:
    """Say of an archive what ``gearidae info`` says.

    Parameters
    ----------
    archive : Path
        The file.
    ds : xarray.Dataset
        What is in it.
    """
    summary = summary_of(ds)
    return {
        "file": str(archive),
        "bytes": file_of(archive).stat().st_size,
        **{name: ds.attrs[name] for name in _ATTRIBUTES if name in ds.attrs},
        **_contents(ds),
        "swept": {dim: ds[dim].values.tolist() for dim in swept_dims(ds)},
        "outcomes": [{**asdict(outcome), "words": outcome.words} for outcome in outcomes(ds)],
        **({"impacts": _impacts(ds)} if Impacts.dim in ds.dims else {}),
        "run_summary": summary and summary.as_plain(),
        "energy_balance": energy_balance(judged_view(ds)),
        **({"work": _work(ds)} if is_train(ds) and not swept_dims(ds) else {}),
        "limits": [asdict(row) for row in validity_of(ds)],
        "references": cite(ds).splitlines(),
        "scene": scene_of(ds),
    }


def _work(ds: xr.Dataset) -> list[dict[str, Any]]:
    """Where the work of a train's drive goes, with what each mesh and hub passes on."""
    passes = passed_on(ds)
    return [{**share._asdict(), "passes": passes.get(share.name)} for share in work_shares(ds)]


def _impacts(ds: xr.Dataset) -> list[dict[str, Any]]:
    """Count the impacts of each flank of each run, with their forces, impulses and losses."""
    table = row_table(ds, Impacts)
    labels = [str(name) for name in table.columns[: table.columns.get_loc("time")]]
    groups = table.groupby([*labels, "flank"], observed=True, dropna=False)
    told = groups.agg(
        count=("time", "size"),
        median_force=("largest_force", "median"),
        largest_force=("largest_force", "max"),
        impulse=("impulse", "sum"),
        energy_lost=("energy_lost", "sum"),
    )
    rows: list[dict[str, Any]] = told.reset_index().to_dict("records")
    return rows


def product_facts(path: Path, ds: xr.Dataset, kind: str) -> dict[str, Any]:
    """Say of what a study has written what ``gearidae info`` says.

    Parameters
    ----------
    path : Path
        The file.
    ds : xarray.Dataset
        What is in it.
    kind : str
        From `gearidae.studies.products.open_product`.
    """
    from gearidae.studies.declared import studies  # which a run does without
    from gearidae.studies.products import answer

    result = answer(ds, kind)
    return {
        "file": str(path),
        "bytes": path.stat().st_size,
        "kind": kind,
        "attributes": {str(name): value for name, value in ds.attrs.items() if name != "scene"},
        **_contents(ds, studies()[kind].columns),
        "answer": result.sentence,
        "rows": [list(row) for row in result.rows],
        "references": cite(ds).splitlines(),
        "scene": scene_of(ds),
    }


def _contents(ds: xr.Dataset, whole: Collection[str] = ()) -> dict[str, Any]:
    """Sizes and variables of a dataset; those named `whole`, what a study has found, and coordinates with values."""
    described = {}
    for name in (*ds.coords, *ds.data_vars) if whole else ds.data_vars:
        variable = ds[name]
        described[str(name)] = {
            "dimensions": list(map(str, variable.dims)),
            "units": str(variable.attrs.get("units", "")),
            **({"values": variable.values} if name in whole or (whole and name in ds.coords) else {}),
        }
    return {"sizes": {str(name): size for name, size in ds.sizes.items()}, "variables": described}


def _plain(value: Any) -> Any:
    """Turn what numpy and dataclasses hold into what JSON knows."""
    if isinstance(value, Mapping):
        return {str(key): _plain(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(entry) for entry in value]
    if isinstance(value, np.ndarray | np.generic):
        return _plain(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value if isinstance(value, bool | int | float | str) or value is None else str(value)
