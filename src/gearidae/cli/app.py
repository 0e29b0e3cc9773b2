"""The commands and their options; each command is implemented in a module of this package."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

from cyclopts import App, Parameter

import gearidae
from gearidae.cli import completing
from gearidae.cli.output import Terminal

app = App(
    name="gearidae",
    help="Simulate the dynamics of rough, adhesive MEMS gears with a protective monolayer.",
    version=f"gearidae {gearidae.__version__}",
    default_parameter=Parameter(negative=()),
    suppress_keyboard_interrupt=False,  # `main` reports what is kept
    console=Terminal(),
)
app.meta.suppress_keyboard_interrupt = False

Case = Annotated[
    Path,
    Parameter(
        help="Case file (TOML), or the name of a preset or a shipped case.", completer=completing.cases
    ),
]
Output = Annotated[
    Path | None, Parameter(name=["--output", "-o"], help="File to write. Default: named after the input.")
]
Overwrite = Annotated[bool, Parameter(help="Replace the output if it exists.")]
Settings = Annotated[
    list[str] | None,
    Parameter(
        name="--set",
        help="Change keys of the scene: one or more key=value; repeatable. key=[] takes a schedule or harmonics away.",
        consume_multiple=False,
        completer=completing.keys,
    ),
]
Dask = Annotated[str | None, Parameter(help="Address of a Dask scheduler; its cluster computes the runs.")]
Json = Annotated[bool, Parameter(name="--json", help="Print one JSON object, in SI units.")]
Rtol = Annotated[float | None, Parameter(help="Relative tolerance of the solver.")]


@app.command
def run(
    case: Case,
    *,
    output: Output = None,
    settings: Settings = None,
    rtol: Rtol = None,
    overwrite: Overwrite = False,
    resume: Annotated[bool, Parameter(help="Resume the unfinished run in the output file.")] = False,
    start: Annotated[Path | None, Parameter(help="Archive of another run to go on from.")] = None,
    until: Annotated[str | None, Parameter(help="End the run before its time: sticks, or 'turns N'.")] = None,
    as_json: Json = False,
) -> int:
    """Run one scene and write a netCDF archive, which can be opened during the run."""
    from gearidae.cli.simulation import run_case

    changes = [*(settings or []), *([] if until is None else [f"run.stop={until}"])]
    return run_case(
        str(case), output, changes, rtol, overwrite=overwrite, resume=resume, start=start, as_json=as_json
    )


@app.command
def sweep(
    case: Case,
    *,
    over: Annotated[
        list[str],
        Parameter(
            help="Key and its values: key=start:stop:step (both ends included) or key=a,b,c; repeatable.",
            consume_multiple=False,
            completer=completing.keys,
        ),
    ],
    output: Output = None,
    settings: Settings = None,
    rtol: Rtol = None,
    zipped: Annotated[
        bool,
        Parameter(
            help="Combine the first values of all keys, then the second, and so on, instead of all combinations."
        ),
    ] = False,
    jobs: Annotated[int | None, Parameter(help="Number of simultaneous runs. Default: one per core.")] = None,
    dask: Dask = None,
    resume: Annotated[
        bool, Parameter(help="Resume an interrupted sweep; its finished runs are reused.")
    ] = False,
    overwrite: Overwrite = False,
    keep: Annotated[
        list[str] | None,
        Parameter(
            help="What each run leaves behind: variables, or verdict, extremes, statistics, energy_balance, scene, "
            "samples, events; repeatable. Default: everything.",
            consume_multiple=True,
        ),
    ] = None,
    as_json: Json = False,
) -> int:
    """Run a scene for several values of one or more keys, into one archive.

    Finished runs are kept beside the archive, in OUT.nc.journal, until the archive is written.
    """
    from gearidae.cli.simulation import sweep_case

    return sweep_case(
        str(case),
        over,
        output,
        settings or [],
        rtol,
        jobs,
        dask,
        zipped=zipped,
        resume=resume,
        overwrite=overwrite,
        keep=keep,
        as_json=as_json,
    )


@app.command
def plot(
    archive: Annotated[Path, Parameter(help="Archive or coating map to draw.")],
    *,
    picture: Annotated[
        str | None,
        Parameter(
            help="Name of a picture, such as power_spectrum or teeth. Default: an overview.",
            completer=completing.pictures,
        ),
    ] = None,
    select: Annotated[
        list[str] | None,
        Parameter(help="Select one run of a sweep: sam_fraction=0.5; repeatable.", consume_multiple=False),
    ] = None,
    time: Annotated[
        str | None,
        Parameter(help="Time of the picture teeth or train, such as 12.5 ms. Default: the last sample."),
    ] = None,
    start: Annotated[
        str | None,
        Parameter(name="--from", help="Draw a moving picture of the teeth or the train, from this time."),
    ] = None,
    stop: Annotated[str | None, Parameter(name="--to", help="End time of the moving picture.")] = None,
    frames: Annotated[
        int | None, Parameter(help="Number of frames of the moving picture. Default: 100.")
    ] = None,
    size: Annotated[
        str | None, Parameter(help="Width and height: '3.4 in, 2.4 in' or '86 mm, 60 mm'.")
    ] = None,
    dpi: Annotated[float | None, Parameter(help="Dots per inch. Default: 200.")] = None,
    style: Annotated[
        str | None,
        Parameter(help="Style: journal, one of matplotlib's (ggplot), or a file with its settings."),
    ] = None,
    output: Output = None,
    overwrite: Overwrite = False,
) -> int:
    """Draw an archive: speed and contact torque of gears, force and gap of a roller, or any other picture.

    The picture teeth shows the teeth in mesh at one time, the picture train a whole train. If the output ends in .gif,
    .webp or .mp4, it is a moving picture.
    """
    from gearidae.cli.pictures import draw

    return draw(
        archive,
        picture,
        output,
        select=select or [],
        time=time,
        span=(start, stop),
        frames=frames,
        size=size,
        dpi=dpi,
        style=style,
        overwrite=overwrite,
    )


@app.command
def report(
    archive: Annotated[Path, Parameter(help="Archive to report on.")],
    *,
    select: Annotated[
        list[str] | None,
        Parameter(help="Select a part of a sweep: sam_fraction=0.5; repeatable.", consume_multiple=False),
    ] = None,
    output: Output = None,
    overwrite: Overwrite = False,
    teeth: Annotated[
        bool | None,
        Parameter(
            help="Show the teeth in mesh, for which seven runs at most run again. Default: where that takes less than "
            "a minute, of a sweep of more than seven runs ten seconds."
        ),
    ] = None,
) -> int:
    """Write one self-contained HTML page about an archive: outcome, time series, pictures, events, scene."""
    from gearidae.cli.pictures import report_archive

    return report_archive(archive, output, select=select or [], overwrite=overwrite, teeth=teeth)


@app.command
def explore(
    archive: Annotated[Path, Parameter(help="Archive of gears to look through: a run or a sweep.")],
    *,
    select: Annotated[
        list[str] | None,
        Parameter(help="Select a part of a sweep: backlash=0.2e-6; repeatable.", consume_multiple=False),
    ] = None,
    start: Annotated[
        str | None, Parameter(name="--from", help="Begin at this time: fewer samples for each picture.")
    ] = None,
    stop: Annotated[str | None, Parameter(name="--to", help="End at this time.")] = None,
    output: Output = None,
    overwrite: Overwrite = False,
    teeth: Annotated[
        bool,
        Parameter(help="Add the force and state of each pair of teeth; seven runs at most run again."),
    ] = False,
) -> int:
    """Write one self-contained HTML page with sliders over swept keys and time, turning gears, and verdicts."""
    from gearidae.cli.pictures import explore_archive

    return explore_archive(
        archive, output, select=select or [], span=(start, stop), overwrite=overwrite, teeth=teeth
    )


@app.command
def assess(
    signal: Annotated[
        Path, Parameter(help="Gear speed over time: text (time [s], gear_speed [rad/s]) or netCDF.")
    ],
    *,
    map: Annotated[  # noqa: A002
        Path,
        Parameter(
            help="Coating map of the same gears at the torque of the signal; over drive.torque if that is not known."
        ),
    ],
    history: Annotated[
        str,
        Parameter(help="Whether the signal begins at the start of the map's runs: auto, start or unknown."),
    ] = "auto",
    anti_alias_filter: Annotated[
        str | None,
        Parameter(
            help="Cut-off frequency of a low-pass filter before the sampling, such as 4 kHz. Default: no filter."
        ),
    ] = None,
    calibration: Annotated[
        str | None, Parameter(help="Relative uncertainty of the measured speed. Default: 1.5 %.")
    ] = None,
    offset: Annotated[
        str | None, Parameter(help="Uncertainty of the sensor's zero, such as '0.06 rad/s'. Default: 0.")
    ] = None,
    columns: Annotated[
        list[str] | None,
        Parameter(
            help="Headings of time and speed, such as 'Zeit [ms]' 'Drehzahl [1/min]', or their numbers: "
            "'1 [s]' '2 [rad/s]'. Default: recognised.",
            consume_multiple=(1, 2),
        ),
    ] = None,
    interval: Annotated[
        str | None,
        Parameter(
            help="Time between samples, such as '10 us': no column of time is needed, and none is read. "
            "Default: the column of time, or what LabVIEW and Rigol state."
        ),
    ] = None,
    skip: Annotated[int | None, Parameter(help="Lines above the headings. Default: recognised.")] = None,
    delimiter: Annotated[
        str | None, Parameter(help="Between the cells: a character, tab or blanks. Default: recognised.")
    ] = None,
    decimal: Annotated[str | None, Parameter(help="Decimal sign: . or , Default: recognised.")] = None,
    bridge: Annotated[
        int | None, Parameter(help="Missing samples in a row to interpolate. Default: 0.")
    ] = None,
    select: Annotated[
        list[str] | None,
        Parameter(
            help="Select one run of a signal file with several: sam_fraction=0.5; repeatable.",
            consume_multiple=False,
        ),
    ] = None,
    line: Annotated[
        list[str] | None,
        Parameter(
            help="Select one line of a map with several, such as a known torque: torque=4.5e-18; repeatable.",
            consume_multiple=False,
        ),
    ] = None,
    as_json: Json = False,
) -> int:
    """Estimate from a speed signal how much of the coating is left.

    With a map over drive.torque, the torque is estimated from the speed of the gear.
    """
    from gearidae.cli.coating import assess_signal

    sensor = {
        "history": history, "anti_alias_filter": anti_alias_filter, "calibration": calibration, "offset": offset
    }  # fmt: skip
    reading = {
        "columns": columns, "skip": skip, "delimiter": delimiter, "decimal": decimal, "bridge": bridge,
        "interval": interval,
    }  # fmt: skip
    return assess_signal(signal, map, sensor, reading, select=select or [], line=line or [], as_json=as_json)


@app.command
def surfaces(*, as_json: Json = False) -> int:
    """List the surfaces that a case may name (surface = "polysilicon, OTS"), each number with its source."""
    from gearidae.cli.surface_table import show_library

    show_library(as_json=as_json)
    return 0


@app.command
def surface(
    scan: Annotated[
        Path, Parameter(help="Height map: .npy, .csv, .txt, or a format that SurfaceTopography reads.")
    ],
    *,
    size: Annotated[
        str | None,
        Parameter(
            help="Extent of the map, if the file does not say it: of its rows, or columns and rows: '2 um, 1 um'."
        ),
    ] = None,
    unit: Annotated[
        str | None, Parameter(help="Unit of the heights, if the file does not say it. Default: m.")
    ] = None,
    cutoff: Annotated[
        str | None, Parameter(help="Cut-off wavelength, such as 50 nm: shorter waves are left out.")
    ] = None,
    by: Annotated[
        Literal["summits", "moments"], Parameter(help="Where the asperities are taken from.")
    ] = "summits",
    both_flanks: Annotated[bool, Parameter(help="Combine the roughness of two such flanks.")] = False,
    align_rows: Annotated[
        bool, Parameter(help="Shift lines of the scan that drift or noise has offset against each other.")
    ] = False,
    into: Annotated[
        Path | None,
        Parameter(
            name="--case",
            help="Case or preset to put the surface into; -o is then a whole case file.",
            completer=completing.cases,
        ),
    ] = None,
    output: Annotated[
        Path | None,
        Parameter(name=["--output", "-o"], help="Part of a case file to write, the table surface."),
    ] = None,
    picture: Annotated[
        Path | None, Parameter(help="Image of the numbers against the cut-off to write.")
    ] = None,
    asperities: Annotated[
        Path | None, Parameter(help="List of the summits to write, for contact.asperities = {file = ...}.")
    ] = None,
    overwrite: Overwrite = False,
    as_json: Json = False,
) -> int:
    """Take roughness, density and tip radius of the asperities from a measured height map.

    They depend on the cut-off wavelength; without one, they are printed for the whole range.
    """
    from gearidae.cli.surface import Choices, analyse_scan

    case = None if into is None else str(into)
    choices = Choices(size, unit, cutoff, by, both_flanks, align_rows, case, asperities)
    return analyse_scan(scan, choices, output, picture, overwrite=overwrite, as_json=as_json)


@app.command
def check(case: Case, *, settings: Settings = None, as_json: Json = False) -> int:
    """Check a case file; print estimates and limits of the model without running it."""
    from gearidae.cli.checking import check_case

    return check_case(str(case), settings or [], as_json=as_json)


@app.command
def init(
    name: Annotated[str, Parameter(help="Name of the case; NAME.toml is written to the current folder.")],
    *,
    preset: Annotated[
        str, Parameter(help="Preset to start from.", completer=completing.presets)
    ] = "teodorescu2009_low_speed",
) -> int:
    """Write a commented case file to start from."""
    from gearidae.cli.files import write_case

    return write_case(name, preset)


@app.command
def info(archive: Annotated[Path, Parameter(help="Archive to describe.")], *, as_json: Json = False) -> int:
    """Print the content, origin and outcome of an archive."""
    from gearidae.cli.files import describe

    return describe(archive, as_json=as_json)


@app.command
def schema(*, output: Output = None, overwrite: Overwrite = False) -> int:
    """Print the JSON Schema of case files, by which editors complete and check them, or write it to a file."""
    from gearidae.cli.files import write_schema

    return write_schema(output, overwrite=overwrite)


@app.command(name="compile")
def compile_solver() -> int:
    """Compile the solver for this machine ahead of the first run: once, for some minutes."""
    from gearidae.cli.output import print_line
    from gearidae.compiled.cache import cache_folder

    gearidae.compile()
    print_line(f"Compiled code: {cache_folder()}")
    return 0
