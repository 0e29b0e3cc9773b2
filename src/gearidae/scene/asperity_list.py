"""Lists of asperities: what stands on the flanks, asperity by asperity, in place of drawn ones.

``{file = "list.csv"}`` in a case file, in Python also ``{"data": DataFrame}``: a row for each asperity, the columns
``arc`` (along the pinion's flank from the base circle; of a roller ``x``, from its middle) and ``height``, and where
they are wanted ``radius``, ``q`` and ``q2`` (coverage numbers of both sides), ``tooth`` and ``flank``. Lengths have
their unit in the heading: ``height [nm]``. A cell that is left empty says nothing: the surface's own radius, a drawn
coverage number, every tooth, both flanks. Columns by their bare names are lists of SI numbers; so a scene keeps them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Final, NamedTuple

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, core_schema

from gearidae.errors import SceneError
from gearidae.scene.carried import number_of
from gearidae.scene.group import shorten
from gearidae.scene.table_head import open_table
from gearidae.scene.tables import MOST_KNOTS
from gearidae.scene.text_table import as_number, split_unit
from gearidae.scene.units import from_text

if TYPE_CHECKING:
    from gearidae.scene.scene import Scene

FLANKS: Final = ("drive", "coast")
_LENGTHS: Final = {"arc": (-1.0, 1.0), "x": (-1.0, 1.0), "height": (-0.1, 0.1), "radius": (1e-10, 0.1)}
_NUMBERS: Final = _LENGTHS | {"q": (0.0, 1.0), "q2": (0.0, 1.0), "tooth": (0.0, 9999.0)}
_COLUMNS: Final = (*_NUMBERS, "flank")
_MOST_ROWS: Final = MOST_KNOTS
_LARGEST: Final = 50_000_000  # bytes of a file


class ListedAsperity(NamedTuple):
    """One row of a list; None where it says nothing.

    Attributes
    ----------
    place : float
        Arc from the base circle of the pinion, or distance from the middle of a roller [m].
    height : float
        Above the mean plane [m].
    radius : float, optional
        Of the tip [m].
    q, q2 : float, optional
        Coverage numbers of the pinion's and the gear's side.
    tooth : int, optional
        Of the pinion.
    flank : str, optional
        One of `FLANKS`.
    """

    place: float
    height: float
    radius: float | None = None
    q: float | None = None
    q2: float | None = None
    tooth: int | None = None
    flank: str | None = None


class ListedAsperities(tuple[ListedAsperity, ...]):
    """The rows of a list, with the name of what its positions are counted along.

    Attributes
    ----------
    along : {"arc", "x"}
    """

    along: str

    def __new__(cls, rows: Iterable[ListedAsperity] = (), along: str = "arc") -> ListedAsperities:
        """Make a list of rows that have been checked."""
        made = super().__new__(cls, tuple(rows))
        made.along = along
        return made

    @property
    def columns(self) -> dict[str, list[Any]]:
        """Columns of which any row says something, by their bare names, in SI units."""
        names = (self.along, *ListedAsperity._fields[1:])
        columns = {name: list(column) for name, column in zip(names, zip(*self, strict=True), strict=True)}
        return {name: cells for name, cells in columns.items() if any(cell is not None for cell in cells)}


class AsperityList:
    """What ``contact.asperities`` holds: `ListedAsperities`, or nothing."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Let pydantic call `read`, and write the columns."""

        def write(value: ListedAsperities) -> dict[str, list[Any]]:
            return value.columns if value else {}

        return core_schema.no_info_plain_validator_function(
            self.read, serialization=core_schema.plain_serializer_function_ser_schema(write)
        )

    def __get_pydantic_json_schema__(
        self, core: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        """Describe what may stand here."""
        return {"type": "object", "description": f"a file, or lists {', '.join(_COLUMNS)}"}

    def read(self, value: object) -> ListedAsperities:
        """Read a list from a file, a DataFrame or columns in SI units.

        Parameters
        ----------
        value : object
            What the user gave.

        Raises
        ------
        ValueError
            Naming column and row.
        """
        if isinstance(value, ListedAsperities):
            return value
        if hasattr(value, "columns") and hasattr(value, "iloc"):
            value = {"data": value}
        if isinstance(value, (list, tuple)) and not value:
            return ListedAsperities()
        if not isinstance(value, Mapping):
            raise ValueError(f"must be a table with a file, or with the columns {', '.join(_COLUMNS)}")
        if not value:
            return ListedAsperities()
        source = next((key for key in ("file", "data") if key in value), None)
        if source is None:
            return _rows(
                {str(name): (list(cells), "") for name, cells in value.items() if _is_column(cells, name)}
            )
        if len(value) > 1:
            raise ValueError(
                f"has {source} and {next(key for key in value if key != source)}; {source} is enough"
            )
        if source == "file":
            return _rows(dict(_headed(name, cells) for name, cells in _read_file(value["file"]).items()))
        frame = value["data"]
        if not (hasattr(frame, "columns") and hasattr(frame, "iloc")):
            raise ValueError("data must be a DataFrame")
        return _rows(
            dict(_headed(str(name), frame.iloc[:, k].tolist()) for k, name in enumerate(frame.columns))
        )


if TYPE_CHECKING:
    Listed = ListedAsperities
else:
    Listed = Annotated[ListedAsperities, AsperityList()]


def check_asperities(scene: Scene) -> None:
    """Refuse a list that is of no use to a scene, and teeth that it does not have.

    Raises
    ------
    SceneError
        Naming ``contact.asperities`` or ``contact.radius_spread``.
    """
    contact, listed = scene.contact, scene.contact.asperities
    if not listed:
        return
    key, listing = "contact.asperities", f"({len(listed)} asperities)"
    if not contact.is_discrete:
        raise SceneError(key, listing, 'needs contact.roughness = "discrete"')
    along = "arc" if scene.roller is None else "x"
    if listed.along != along:
        raise SceneError(key, listing, f"must have the column {along} in place of {listed.along}")
    if contact.radius_spread != 0.0:
        raise SceneError(
            "contact.radius_spread",
            contact.radius_spread,
            "must be 0 beside contact.asperities, which has radii",
        )
    # of a train each mesh is checked as a pair
    teeth = scene.gears.pinion_teeth if scene.gears is not None else math.inf if scene.roller is None else 1
    for row, asperity in enumerate(listed, 1):
        if asperity.tooth is not None and asperity.tooth >= teeth:
            raise SceneError(
                key, f"(row {row}, tooth {asperity.tooth})", f"must be below {teeth}: teeth count from 0"
            )
        if asperity.flank == "coast" and scene.roller is not None:
            raise SceneError(key, f"(row {row}, flank coast)", "a roller has no coast flank")


def _read_file(file: object) -> dict[str, list[float | str]]:
    """Read the columns of a file: numbers, and texts for what is none, such as the name of a flank."""
    if not isinstance(file, str | Path):
        raise ValueError("file must be the name of a CSV file")
    path = Path(file)
    try:
        table = open_table(path, largest=_LARGEST, names=_has_heights, unit_row=True)
        columns: dict[str, list[float | str]] = {heading: [] for heading in table.headings}
        for line, row, cells in table.rows():
            if row > _MOST_ROWS:
                raise ValueError(f"must have 1..{_MOST_ROWS} rows")
            for heading, cell in zip(table.headings, cells, strict=True):
                number = as_number(cell, table.decimal)
                if number is None and as_number(cell, ".") is not None:
                    sign = f"{table.decimal!r} is taken for the decimal sign"
                    raise ValueError(
                        f"line {line}: column {heading[:40]!r}, row {row} is {cell[:40]!r}; {sign}"
                    )
                columns[heading].append(cell if number is None else number)
    except (OSError, ValueError) as error:
        raise ValueError(f"the file {path.name}: {error}") from None
    return columns


def _has_heights(headings: Iterable[str]) -> bool:
    return any(split_unit(heading)[0] == "height" for heading in headings)


def _is_column(cells: object, name: object) -> bool:
    """Whether something is a list, as each column of a scene's own is."""
    if not isinstance(cells, (list, tuple)) and not hasattr(cells, "tolist"):
        raise ValueError(f"column {str(name)[:40]!r} must be a list")
    return True


def _headed(heading: str, cells: list[Any]) -> tuple[str, tuple[list[Any], str]]:
    """Return the bare name of a column, its cells and its unit; lengths need one."""
    name, unit = split_unit(heading.strip())
    if name in _LENGTHS and not unit:
        raise ValueError(f"column {name!r} needs its unit in the heading, such as '{name} [nm]'")
    try:
        from_text(f"1 {unit}", "m" if name in _LENGTHS else "1")
    except ValueError as error:
        raise ValueError(f"column {heading[:60]!r}: {error}") from None
    return name, (cells, unit)


def _rows(columns: dict[str, tuple[list[Any], str]]) -> ListedAsperities:
    """Check columns, each with its unit, and make rows of them."""
    for name in columns:
        if name not in _COLUMNS:
            raise ValueError(f"unknown column {name[:40]!r}; there may be {', '.join(_COLUMNS)}")
    along = [name for name in ("arc", "x") if name in columns]
    if len(along) != 1 or "height" not in columns:
        raise ValueError("needs the columns arc (of a roller x) and height")
    lengths = {len(cells) for cells, _ in columns.values()}
    if len(lengths) > 1:
        raise ValueError("columns must have as many rows")
    if not 0 < lengths.pop() <= _MOST_ROWS:
        raise ValueError(f"must have 1..{_MOST_ROWS} rows")
    cells = {
        name: [_cell(cell, name, row, unit) for row, cell in enumerate(column, 1)]
        for name, (column, unit) in columns.items()
    }
    needed = (*along, "height")
    for name in needed:
        if None in cells[name]:
            raise ValueError(f"column {name!r}, row {cells[name].index(None) + 1} is empty")
    names = (along[0], *ListedAsperity._fields[1:])
    rows = zip_longest(*(cells.get(name, ()) for name in names))
    return ListedAsperities((ListedAsperity(*row) for row in rows), along[0])


def _cell(cell: Any, name: str, row: int, unit: str) -> Any:
    """Read one cell: a number within its limits, the name of a flank, or None where it is empty."""
    where = f"column {name!r}, row {row}"
    if (
        cell is None
        or (isinstance(cell, str) and not cell.strip())
        or (isinstance(cell, float) and math.isnan(cell))
    ):
        return None
    if name == "flank":
        word = str(cell).strip().lower()
        if word not in FLANKS:
            raise ValueError(f"{where} is {shorten(cell)}; must be drive, coast or empty")
        return word
    try:
        number = number_of(
            float(cell) if isinstance(cell, str) else cell, "m" if name in _LENGTHS else "1", unit
        )
    except ValueError:
        number = None
    if number is None:
        raise ValueError(f"{where} is {shorten(cell)}, no number")
    low, high = _NUMBERS[name]
    if not low <= number <= high:
        raise ValueError(f"{where} is {number:g}; must lie in {low:g}..{high:g}")
    if name != "tooth":
        return number
    if not number.is_integer():
        raise ValueError(f"{where} is {number:g}; must be a whole number")
    return int(number)
