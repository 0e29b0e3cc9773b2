"""Tables of the reference that follow from the code: scene keys, dataset variables, commands, the engine's state."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from cyclopts import Argument

from gearidae.archive.variables import (
    ENERGY_BALANCE,
    EVENTS,
    EXTREMES,
    IMPACTS,
    OF_SWEPT_RUN,
    PASSAGES,
    RUN,
    SAM_FRACTION,
    SAMPLES,
    TIME,
    VERDICT,
    Variable,
)
from gearidae.cli.session import app
from gearidae.engine.model.checkpoint_record import STATE_FIELDS
from gearidae.records import EventKind, Flank
from gearidae.records.quantity import Quantity
from gearidae.scene import describe_keys
from gearidae.scene.combinations import FEATURES, REFUSED
from gearidae.studies.declared import studies

__all__ = [
    "combination_tables",
    "command_tables",
    "dataset_tables",
    "key_table",
    "state_tables",
    "study_tables",
    "write_tables",
]


def write_tables(folder: Path) -> None:
    """Write all tables as files to be included."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in (
        ("keys", key_table()),
        ("dataset", dataset_tables()),
        ("commands", command_tables()),
        ("studies", study_tables()),
        ("state", state_tables()),
        ("combinations", combination_tables()),
    ):
        target = folder / f"{name}.inc.md"
        if not target.exists() or target.read_text(encoding="utf-8") != text:
            target.write_text(text, encoding="utf-8")


def key_table() -> str:
    """List the keys of a scene, a table for each table of the case file."""
    tables: dict[str, list[Sequence[str]]] = {}
    for info in describe_keys():
        table, _, key = info.key.partition(".")
        default = "required" if info.required else "" if info.default == () else f"`{info.default}`"
        unit = "" if info.unit == "1" else info.unit
        allowed = info.allowed.replace(f"a number in {info.unit} or a text with a unit", "").strip(" ,")
        tables.setdefault(table if key else "", []).append(
            (f"`{info.key}`", unit, default, allowed, info.description)
        )
    headings = ("key", "unit", "default", "allowed", "meaning")
    parts = [(f"## `[{name}]`\n\n" if name else "") + _table(headings, rows) for name, rows in tables.items()]
    return "\n".join(parts)


def dataset_tables() -> str:
    """List the variables of a dataset."""
    groups: tuple[tuple[str, Iterable[Variable]], ...] = (
        ("Coordinates", (TIME, SAM_FRACTION)),
        ("Samples", SAMPLES.values()),
        ("Events", EVENTS.values()),
        ("Passages", PASSAGES.values()),
        ("Impacts", IMPACTS.values()),
        ("Status and statistics of a run", RUN.values()),
        ("Extremes of a run", EXTREMES.values()),
        ("Energy balance of a run", ENERGY_BALANCE.values()),
        ("Of every run of a sweep besides", OF_SWEPT_RUN.values()),
        ("Of every run of a sweep that keeps parts of its runs", VERDICT.values()),
    )
    headings = ("name", "dimensions", "unit", "what it is")
    parts = []
    for title, variables in groups:
        rows = [
            (
                f"`{variable.name}`",
                ", ".join(variable.dims) or "-",
                variable.units,
                "; ".join(filter(None, (variable.long_name, variable.comment))),
            )
            for variable in variables
        ]
        parts.append(f"## {title}\n\n{_table(headings, rows)}")
    for title, flags in (("Kinds of events", EventKind), ("Flanks", Flank)):
        rows = [(str(flag.value), f"`{flag.name.lower()}`") for flag in flags]
        parts.append(f"## {title}\n\n{_table(('value', 'meaning'), rows)}")
    return "\n".join(parts)


def command_tables() -> str:
    """List the commands with their arguments and options."""
    parts = []
    common = {name for argument in app.meta.assemble_argument_collection() for name in argument.names}
    names = sorted(name for name in app if not name.startswith("-"))
    for name in names:
        command = app[name]
        rows = [
            (_names(argument), argument.parameter.help or "")
            for argument in command.assemble_argument_collection()
            if argument.show and not common.intersection(argument.names)
        ]
        parts.append(f"## `gearidae {name}`\n\n{command.help.strip()}\n\n{_table(('argument', ''), rows)}")
    rows = [
        (_names(argument), argument.parameter.help or "")
        for argument in app.meta.assemble_argument_collection()
        if argument.show
    ]
    parts.append(f"## With every command\n\n{_table(('option', ''), rows)}")
    return "\n".join(parts)


def study_tables() -> str:
    """List the files of studies with what they hold beside the variables of runs."""
    parts = []
    for study in studies().values():
        rows = [
            (
                f"`{name}`",
                ", ".join(column.dims),
                _unit_of(column.units),
                column.words.replace("{over}", "the key"),
            )
            for name, column in study.columns.items()
        ]
        title = f"{study.words[0].upper()}{study.words[1:]}: `gearidae {study.maker}`"
        parts.append(f"### {title}\n\n{_table(('name', 'dimensions', 'unit', 'what it is'), rows)}")
    return "\n".join(parts)


def _unit_of(declared: str) -> str:
    """Write the unit of a column; it may be that of a key."""
    return "" if not declared or declared.startswith("{") else declared


def state_tables() -> str:
    """List what a checkpoint carries, from the declarations in `gearidae.engine.model.checkpoint_record`."""
    return "\n".join(_record_tables("state", "STATE", STATE_FIELDS))


def combination_tables() -> str:
    """List the features of a scene with those that they are refused with, and the reasons."""
    rows = []
    for name, feature in FEATURES.items():
        others = [other for pair in REFUSED if name in pair for other in pair if other != name]
        rows.append((name, f"`{feature.key}`", ", ".join(others) or "none"))
    reasons = [(f"{first}, {second}", reason) for (first, second), reason in REFUSED.items()]
    features = _table(("feature", "key", "refused beside"), rows)
    return f"{features}\n{_table(('pair', 'reason'), reasons)}"


def _record_tables(access: str, title: str, fields: Iterable[Quantity]) -> Iterator[str]:
    """List the fields of a record, then those of the records within it."""
    rows, inner = [], []
    for field in fields:
        meaning = field.meaning
        if isinstance(field.kind, tuple):
            name = f"{access}.{field.name}" + ("[k]" if field.shape else "")
            inner.append((name, field.name.upper(), field.kind))
            meaning += f": the record `{field.name.upper()}`"
        elif field.unit.scaled != "1":
            meaning += f" [{field.unit.scaled}]"
        rows.append((f"`{access}.{field.name}`", meaning))
    yield f"## `{title}`\n\n{_table(('field', 'what it is'), rows)}"
    for name, heading, parts in inner:
        yield from _record_tables(name, heading, parts)


def _names(argument: Argument) -> str:
    """Name an argument as it is written: in capitals where it stands by its place."""
    if argument.index is not None:
        return f"`{argument.names[0].removeprefix('--').upper()}`"
    return ", ".join(f"`{name}`" for name in argument.names if not name.startswith(("--no-", "--empty-")))


def _table(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [headings, ["---"] * len(headings), *rows]
    return "".join(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in line)} |\n" for line in lines)
