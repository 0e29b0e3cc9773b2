"""``gearidae init``, ``gearidae info`` and ``gearidae schema``: one file in, or out."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import xarray as xr

import gearidae as gd
from gearidae.archive.journal import file_of
from gearidae.archive.row_variables import DIMS
from gearidae.archive.select import is_roller, scene_of, swept_dims
from gearidae.archive.target import whole_file
from gearidae.citing import cite
from gearidae.cli.codes import DONE
from gearidae.cli.machine import archive_facts, print_json, product_facts
from gearidae.cli.output import print_line, show_rows
from gearidae.cli.tables import show_outcomes, show_summary, show_validity
from gearidae.errors import SceneError
from gearidae.records import ROWS, Events
from gearidae.runs.kept_validity import validity_of
from gearidae.scene.coating import MATERIAL_NAMES
from gearidae.scene.validity_row import ATTRIBUTE, contact_subject
from gearidae.studies.products import answer, open_product


def write_case(name: str, preset: str) -> int:
    """Write a preset as a commented case file.

    Parameters
    ----------
    name : str
        Name of the case, with or without ``.toml``.
    preset : str
        Preset to start from.

    Returns
    -------
    int
        Exit code.

    Raises
    ------
    SceneError
        If there is no such preset, or the file exists or cannot be written.
    """
    from gearidae.scene import dump_case

    path = Path(name if name.endswith(".toml") else f"{name}.toml")
    if path.stem.startswith("."):
        raise SceneError("init", name, "must be a name")
    text = dump_case(gd.preset(preset).replace({"name": path.stem}), every_key=True)
    with whole_file(path, name="init", remedy="choose another name") as part:
        part.write_text(
            f"# {path.name}: run it with: gearidae run {path.name}\n"
            f"# Quantities are SI numbers or texts with a unit; a missing key takes its default.\n"
            f"# Keys behind a # are not set; some take the place of others.\n\n{text}",
            encoding="utf-8",
        )
    print_line(f"Wrote {path}")
    return DONE


def describe(archive: Path, *, as_json: bool = False) -> int:
    """Print the content of an archive, or of what a study has written.

    Parameters
    ----------
    archive : Path
        What to describe.
    as_json : bool, optional
        Whether to print one JSON object in place of tables.

    Returns
    -------
    int
        Exit code.

    Raises
    ------
    SceneError
        If the archive cannot be read.
    """
    ds, kind = open_product(archive)
    if as_json:
        print_json(archive_facts(archive, ds) if kind == "runs" else product_facts(archive, ds, kind))
        return DONE
    if kind == "runs":
        show_rows(_description(archive, ds))
        show_outcomes(ds)
        show_summary(ds)
    else:
        result = answer(ds, kind)
        show_rows([*_contents(archive, ds), *_scene_rows(ds)])
        show_rows(result.rows)
        print_line(result.sentence)
    if kind == "runs" or ATTRIBUTE in ds.attrs:  # working the rows out loads the solver
        show_validity(validity_of(ds), about=contact_subject(roller=is_roller(ds), swept=swept_dims(ds)))
    print_line("Rests on (as BibTeX: gearidae.cite):")
    for line in cite(ds).splitlines():
        print_line(f"  {line}")
    return DONE


def _contents(archive: Path, ds: xr.Dataset) -> Iterator[tuple[str, str, str]]:
    """Attributes, dimensions and variables of what a study has written."""
    yield str(archive), f"{file_of(archive).stat().st_size / 1e6:.1f} MB", ""
    numbers: list[tuple[str, str, str]] = []
    for name, value in ds.attrs.items():
        if name in ("title", "summary", "history", "source"):
            yield str(name), str(value), ""
        elif isinstance(value, int | float) and not isinstance(value, bool):
            numbers.append((str(name).replace("_", " "), f"{value:.6g}", ""))
    yield from numbers
    for dim, size in ds.sizes.items():
        yield f"dimension: {dim}", str(size), ""
    yield "variables", "", ""
    for name, variable in ds.data_vars.items():
        yield str(name), f"({', '.join(map(str, variable.dims))})", str(variable.attrs.get("units", ""))


def _description(archive: Path, ds: xr.Dataset) -> Iterator[tuple[str, str, str]]:
    attributes = ds.attrs
    yield str(archive), f"{file_of(archive).stat().st_size / 1e6:.1f} MB", ""
    for name in ("title", "history", "source"):
        yield name, str(attributes[name]), ""
    ended = (
        f"{attributes['status']}: {attributes['message']}" if attributes["message"] else attributes["status"]
    )
    yield "status", str(ended), ""
    for dim in swept_dims(ds):
        yield f"swept: {dim}", _values(ds[dim]), str(ds[dim].attrs["units"])
    samples = ds.sizes.get("time", 0)
    span = f"{samples} samples, 0 to {float(ds['time'][-1]):g} s" if samples else "no samples"
    yield "time", span, f"requested {attributes['t_end']:g} s at rtol {attributes['rtol']:g}"
    for kind in ROWS:
        if kind is Events or kind.dim in ds.sizes:
            yield kind.field, str(ds.sizes.get(kind.dim, "not kept")), ""
    for name in ("steps", "residual_evaluations", "jacobian_evaluations", "restarts"):
        yield name.replace("_", " "), str(attributes[name]), ""
    yield "wall time", f"{attributes['wall_time']:.3g} s", f"backend {attributes['backend']}"
    yield "method", str(attributes.get("method", "")), ""
    for surface in MATERIAL_NAMES:
        if f"tabor_regime_{surface}" not in attributes:
            continue
        regime = attributes[f"tabor_regime_{surface}"]
        yield f"Tabor parameter, {surface}", f"{attributes[f'tabor_parameter_{surface}']:.4g}", str(regime)
    yield "variables", "", ""
    for quantity, variable in ds.data_vars.items():
        if not {"time", "shaft", "mesh", *DIMS} & {*variable.dims}:
            continue  # solver statistics of the runs; their totals are printed above
        yield str(quantity), f"({', '.join(map(str, variable.dims))})", str(variable.attrs.get("units", ""))
    yield from _scene_rows(ds)


def _scene_rows(ds: xr.Dataset) -> Iterator[tuple[str, str, str]]:
    yield "scene", "", ""
    for table, content in scene_of(ds).items():
        tables = {table: content}
        if table in ("shafts", "meshes"):
            tables = {f"{table}.{name}": entry for name, entry in content.items()}
        for title, entries in tables.items():
            if isinstance(entries, dict):
                for key, value in entries.items():
                    unit = "" if isinstance(value, dict) else _unit(f"{title}.{key}")
                    yield f"{title}.{key}", json.dumps(value), unit


def _values(coordinate: xr.DataArray) -> str:
    shown = [f"{value:g}" if isinstance(value, float) else str(value) for value in coordinate.values.tolist()]
    return ", ".join(shown if len(shown) <= 12 else [*shown[:6], "...", *shown[-3:]])


def _unit(key: str) -> str:
    from gearidae.scene import describe_key

    unit = describe_key(key).unit
    return "" if unit == "1" else unit


def write_schema(output: Path | None, *, overwrite: bool) -> int:
    """Print the JSON Schema of case files, or write it to a file.

    Parameters
    ----------
    output : Path or None
        File to write; None to print it.
    overwrite : bool
        Whether the file may be replaced.

    Returns
    -------
    int
        Exit code.

    Raises
    ------
    SceneError
        If the file exists or cannot be written.
    """
    text = json.dumps(gd.Scene.json_schema(), indent=2)
    if output is None:
        print_line(text)
        return DONE
    with whole_file(output, overwrite=overwrite, name="schema", remedy="allow --overwrite") as part:
        part.write_text(text + "\n", encoding="utf-8")
    print_line(f"Schema: {output}")
    return DONE
