"""``gearidae surface``: from a height map to a table of a case file."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import gearidae as gd
from gearidae.archive.target import check_target, whole_file
from gearidae.cli.case import read_scene
from gearidae.cli.codes import DONE
from gearidae.cli.machine import print_json
from gearidae.cli.output import is_quiet, print_line, quieted
from gearidae.cli.surface_table import show_surface
from gearidae.errors import SceneError
from gearidae.scene.prefixes import with_prefix
from gearidae.surfaces.files import read_lines


@dataclass(frozen=True, slots=True)
class Choices:
    """What the user chose about a scan.

    Attributes
    ----------
    size : str or None
        Extent, ``"2 um"`` or ``"2 um, 1 um"``; None to take it from the file.
    unit : str or None
        Unit of the heights in the file.
    cutoff : str or None
        Cut-off wavelength.
    by : str
        ``summits`` or ``moments``.
    both_flanks : bool
        Whether both flanks are as rough.
    align_rows : bool
        Whether to align the lines of the scan.
    case : str or None
        Case file or preset whose surface is to be replaced; None for a table ``[surface]`` alone.
    asperities : Path or None
        List of the summits to write.
    """

    size: str | None
    unit: str | None
    cutoff: str | None
    by: str
    both_flanks: bool
    align_rows: bool
    case: str | None
    asperities: Path | None = None


def analyse_scan(
    scan: Path,
    choices: Choices,
    output: Path | None,
    picture: Path | None,
    *,
    overwrite: bool,
    as_json: bool = False,
) -> int:
    """Print what a scan says about the asperities; write it as a part of a case file and as a picture.

    Parameters
    ----------
    scan : Path
        Height map.
    output : Path or None
        Case file to write, or part of one.
    picture : Path or None
        Image to write.
    overwrite : bool
        Whether files may be replaced.
    as_json : bool, optional
        Whether to print one JSON object in place of the table and the remarks.

    Returns
    -------
    int
        Exit code.

    Raises
    ------
    SceneError
        If the scan cannot be read or analysed, a file may not be written, or its cut-off has not been chosen.
    """
    with quieted(as_json or is_quiet()):
        surface = _analyse(scan, choices, output, picture, overwrite=overwrite)
    if as_json:
        print_json(_facts(surface))
    return DONE


def _facts(surface: gd.surfaces.MeasuredSurface) -> dict[str, Any]:
    """Say what the table says: a row for each cut-off and method, the remarks, and what a case takes."""
    chosen = surface.cutoff is not None
    return {
        "rows": surface.statistics.to_dataframe().reset_index().to_dict("records"),
        "remarks": surface.remarks,
        "cutoff": surface.cutoff,
        "settings": surface.settings if chosen else None,
        "planes": surface.planes if chosen else None,
    }


def _analyse(
    scan: Path, choices: Choices, output: Path | None, picture: Path | None, *, overwrite: bool
) -> gd.surfaces.MeasuredSurface:
    """Analyse a scan, print the table, and write the products."""
    if output is not None and choices.cutoff is None:
        raise SceneError("--cutoff", "(none)", "choose one before writing a case: the numbers depend on it")
    if choices.case is not None and output is None:
        raise SceneError("--case", choices.case, "needs -o, the case file to write")
    if choices.asperities is not None and choices.cutoff is None:
        raise SceneError("--cutoff", "(none)", "choose one before writing a list: the summits depend on it")
    targets = [target for target in (output, picture, choices.asperities) if target is not None]
    checked = [check_target(target, overwrite=overwrite, name="output") for target in targets]
    if len(set(checked)) < len(checked):
        raise SceneError("output", targets[-1], "is named for two products: give each a name of its own")
    heights, own_size = read_lines(scan, choices.unit)
    surface = gd.surface_from(
        heights,
        _size(choices.size, own_size),
        choices.cutoff,
        by=choices.by,
        both_flanks=choices.both_flanks,
        align_rows=choices.align_rows,
        source=scan.name,
    )
    text = None if output is None else _text(surface, choices.case)
    listed = None if choices.asperities is None else surface.asperity_list(_along(choices.case))
    show_surface(surface)
    if choices.asperities is not None and listed is not None:
        _write_list(choices.asperities, listed, surface, overwrite=overwrite)
    if picture is not None:
        from gearidae.drawing.picture import usual_style

        with usual_style():
            gd.plot.write(gd.plot.surface(surface.statistics, surface.cutoff), picture, overwrite=overwrite)
        print_line(f"Picture: {picture}")
    if output is not None and text is not None:
        with whole_file(output, overwrite=overwrite, name="output") as part:
            part.write_text(text, encoding="utf-8")
        print_line(f"{'Surface' if choices.case is None else 'Case'}: {output}")
    elif choices.cutoff is None:
        print_line("The numbers depend on the cut-off wavelength: choose one with --cutoff.")
    return surface


def _along(case: str | None) -> str:
    """Name what positions count along in a list: in a roller's case from the middle, else from the base circle."""
    return "arc" if case is None or read_scene(case, []).roller is None else "x"


def _write_list(path: Path, text: str, surface: gd.surfaces.MeasuredSurface, *, overwrite: bool) -> None:
    """Write a list of asperities, and say how much of a flank it is."""
    with whole_file(path, overwrite=overwrite, name="output") as part:
        part.write_text(text, encoding="utf-8")
    assert surface.asperities is not None
    length, width = (with_prefix(surface.asperities.attrs[side], "m", 3) for side in ("length", "width"))
    print_line(
        f"Note: the list covers a flank of {length}, {width} wide; teeth that meet beyond touch nothing."
    )
    print_line(f"Asperities: {path}")


def _size(asked: str | None, extent: tuple[float, float] | None) -> str | tuple[float | str, float | str]:
    if asked is not None:
        parts = [part.strip() for part in asked.split(",")]
        if len(parts) > 2:
            raise SceneError("--size", asked, "must be one length or two")
        if extent is not None:
            stated = ", ".join(with_prefix(length, "m", 4) for length in extent)
            print_line(f"Note: the file states an extent of {stated}; --size replaces it.")
        return parts[0] if len(parts) == 1 else (parts[0], parts[1])
    if extent is None:
        raise SceneError("--size", "(none)", "is needed: this file does not tell its extent, such as 2 um")
    return extent


def _text(surface: gd.surfaces.MeasuredSurface, case: str | None) -> str:
    """Text of the file: a table, or a whole case with the surface replaced."""
    if case is None:
        return surface.fragment()
    comments = "".join(line for line in _comments(surface.fragment()))
    return comments + gd.dump_case(read_scene(case, []).replace(surface.settings))


def _comments(fragment: str) -> Iterator[str]:
    for line in fragment.splitlines(keepends=True):
        if line.startswith("#"):
            yield line
