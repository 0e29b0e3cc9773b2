"""The tables of a report: outcome, events, parameters, provenance."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from gearidae.analysis.verdict import outcomes
from gearidae.analysis.verdict.table import cells, headings
from gearidae.archive.dataset import dimension_names
from gearidae.archive.pieces import pieces
from gearidae.archive.select import is_roller, runs, scene_of, swept_dims
from gearidae.archive.summary_rows import summary_rows
from gearidae.archive.value_text import label_cells, measure_text, number_text, value_text, values_text
from gearidae.records import EventKind
from gearidae.report import html
from gearidae.scene import describe_keys
from gearidae.scene.prefixes import with_prefix
from gearidae.scene.scene_display import flat
from gearidae.scene.validity_row import ATTRIBUTE, contact_subject, rows_from_json

_PROVENANCE = (
    ("title", "title"),
    ("date_created", "created"),
    ("source", "software"),
    ("history", "history"),
    ("status", "status"),
    ("message", "message"),
    ("backend", "driver of the solver"),
    ("method", "formulas of the solver"),
    ("rtol", "relative tolerance"),
    ("steps", "solver steps"),
    ("residual_evaluations", "evaluations of the residual"),
    ("jacobian_evaluations", "evaluations of the Jacobian"),
    ("restarts", "restarts"),
    ("wall_time", "time in the solver"),
    ("tabor_parameter_bare", "Tabor parameter, bare"),
    ("tabor_parameter_coated", "Tabor parameter, coated"),
    ("references", "reference"),
    ("license", "licence"),
    ("schema_version", "version of the layout"),
)


def outcome_table(ds: xr.Dataset) -> str:
    """List the outcome of each run."""
    judged = outcomes(ds)
    rtol = scene_of(ds)["run"]["rtol"]
    dims = swept_dims(ds)
    names = (*dims, *headings(judged[0]))
    rows = [[*label_cells(ds, outcome.label), *cells(outcome, rtol)] for outcome in judged]
    numeric = [offset for offset in range(len(names)) if offset != len(dims)]
    return html.table(names, rows, caption="Outcome of each run", numeric=numeric)


def answer_tables(rows: Sequence[tuple[str, str, str]]) -> str:
    """List what a study has found: a table for each heading, which is a row without a value."""
    tables: list[tuple[str, list[tuple[str, str, str]]]] = []
    for row in rows:
        if not row[1]:
            tables.append((" ".join(filter(None, (row[0], row[2]))), []))
        elif not tables:
            tables.append(("", [row]))
        else:
            tables[-1][1].append(row)
    return "\n".join(
        html.table(("quantity", "value", "remark"), listed, caption=caption)
        for caption, listed in tables
        if listed
    )


def member_table(ds: xr.Dataset, listed: Sequence[str]) -> str:
    """List the members of an ensemble with the values that were drawn, or the runs of a map, folded.

    Parameters
    ----------
    listed : sequence of str
        Variables to list for each member; without any, the outcomes of the runs.
    """
    if listed:
        drawn = [str(name) for name in ds.coords if name != "member" and ds[name].dims == ("member",)]
        columns = [*drawn, *listed]
        rows = [
            [str(number), *(value_text(member[name].item(), _unit(member[name])) for name in columns)]
            for number, member in ((number, ds.isel(member=number)) for number in range(ds.sizes["member"]))
        ]
        table = html.table(("member", *(name.replace("_", " ") for name in columns)), rows, caption="Members")
    elif "status" not in ds or "swept" not in ds.attrs:  # a map has no runs in it
        return ""
    elif "member" in ds.dims:
        judged, rtol = outcomes(ds), scene_of(ds)["run"]["rtol"]
        drawn = [str(name) for name in dimension_names(json.loads(ds.attrs["swept"])).values()]
        rows = [
            [
                str(number),
                *(value_text(values.item(), _unit(values)) for values in values_of),
                *cells(member, rtol),
            ]
            for number, (member, *values_of) in enumerate(
                zip(judged, *(ds[name] for name in drawn), strict=True)
            )
        ]
        table = html.table(("member", *drawn, *headings(judged[0])), rows, caption="Members")
    else:
        table = outcome_table(ds)
    return html.folded("Outcome of each run", table)


def _unit(values: xr.DataArray) -> str:
    return str(values.attrs.get("units", "1"))


def summary_tables(ds: xr.Dataset) -> str:
    """List the run summary and the energy balance of a single run; nothing of a sweep."""
    return answer_tables(summary_rows(ds))


def event_table(ds: xr.Dataset) -> str:
    """Count the events of each run and name the first and the hardest contact; nothing if events have not been kept."""
    if "event_kind" not in ds:
        return ""
    events = [(label, _count_events(run)) for label, run in runs(ds)]
    kinds = [kind for kind in EventKind if any(counted.counts[kind] for _, counted in events)]
    if not kinds:
        return html.paragraph("No events.")
    dims = swept_dims(ds)
    rows = []
    for label, counted in events:
        made = counted.counts[EventKind.ONSET]
        first = measure_text(counted.first, "s") if made else "-"
        fastest = with_prefix(max(counted.fastest, 0.0), "m/s") if made else "-"
        counts = [str(counted.counts[kind]) for kind in kinds]
        rows.append([*label_cells(ds, label), *counts, first, fastest])
    names = [kind.name.lower().replace("_", " ") for kind in kinds]
    headings = [*dims, *names, "first onset", "fastest closing at an onset"]
    return html.table(headings, rows, caption="Events of each run", numeric=range(len(headings)))


@dataclass(slots=True)
class _EventCounts:
    """Events of a run: how many of each kind, time of the first onset [s], fastest closing at one [m/s]."""

    counts: dict[EventKind, int]
    first: float = math.inf
    fastest: float = -math.inf


def _count_events(run: xr.Dataset) -> _EventCounts:
    counted = _EventCounts(dict.fromkeys(EventKind, 0))
    for offset, kinds in pieces(run["event_kind"]):
        for kind in EventKind:
            counted.counts[kind] += int(np.count_nonzero(kinds == kind))
        made = kinds == EventKind.ONSET
        if made.any():
            cut = slice(offset, offset + len(kinds))
            counted.first = min(counted.first, float(run["event_time"].variable[cut].values[made].min()))
            counted.fastest = max(
                counted.fastest, float(-run["event_gap_rate"].variable[cut].values[made].min())
            )
    return counted


def parameter_tables(ds: xr.Dataset) -> str:
    """List the scene key by key, in units with prefixes, with what each key means."""
    scene = scene_of(ds)
    swept = json.loads(ds.attrs.get("swept", "{}"))
    drawn = json.loads(ds.attrs.get("ensemble", "{}")).get("distributions", {})
    known = {info.key: info for info in describe_keys()}
    picked = {
        key: dim for key, dim in dimension_names(swept).items() if dim in ds.coords and not ds[dim].dims
    }
    rows = []
    for key, value in _flatten(scene, swept):
        info = known.get(".".join(part for part in key.split(".") if not part.isdecimal()))
        unit, meaning = (info.unit, info.description) if info else ("", "")
        shown = f"swept: {values_text(swept[key], unit)}" if key in swept else value_text(value, unit)
        if key in picked:
            shown = f"selected: {value_text(ds[picked[key]].values.item(), unit)}"
        if key in drawn:
            shown = f"drawn from {drawn[key]}: {values_text(swept.get(key, []), unit)}"
        rows.append((key, shown, meaning))
    return html.table(("key", "value", "meaning"), rows, caption="Parameters of the scene")


def law_table(ds: xr.Dataset) -> str:
    """List the loss law of a life with its parameters and its source; nothing if it names none."""
    try:
        law = json.loads(ds.attrs.get("law", ""))
    except ValueError:
        return ""
    if not isinstance(law, dict):
        return ""
    rows = [(key, value_text(value, "")) for key, value in law.items()]
    rows.append(("source", str(ds.attrs.get("law_source", ""))))
    return html.table(("loss law", "in SI units"), rows, caption="How coverage is lost")


def validity_table(ds: xr.Dataset) -> str:
    """List the limits of the model that an archive carries, marked where they are exceeded; nothing if it has none."""
    rows = [
        (row.quantity, row.value, "" if row.holds else "!", row.limit, row.verdict)
        for row in rows_from_json(ds.attrs.get(ATTRIBUTE))
    ]
    if not rows:
        return ""
    about = contact_subject(roller=is_roller(ds), swept=list(json.loads(ds.attrs.get("swept", "{}"))))
    caption = f"Limits of the model: contact {about}. ! marks a limit that is exceeded."
    return html.table(("quantity", "value", "", "limit", "what follows"), rows, caption=caption)


def provenance_list(ds: xr.Dataset) -> str:
    """List where the archive comes from and what it took to compute."""
    attributes = ds.attrs
    return html.definitions(
        (name, _provenance(key, attributes[key]))
        for key, name in _PROVENANCE
        if str(attributes.get(key, "")) != ""
    )


def _provenance(key: str, value: Any) -> str:
    if key == "wall_time" and isinstance(value, (int, float, np.number)):
        return measure_text(value, "s")
    return number_text(value)


def _flatten(tables: dict[str, Any], swept: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    """Go through the keys of a scene; a key that is swept but left out of the base scene comes last."""
    seen = set()
    for name, content in tables.items():
        if isinstance(content, dict):
            for key, value in flat(content).items():
                seen.add(f"{name}.{key}")
                yield f"{name}.{key}", value
    yield from ((key, None) for key in swept if key not in seen)
