"""Records from CSV files: as rigs and numpy write them, fast, and with the bad row named."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pandas as pd
import pytest
import xarray as xr

from gearidae.analysis import read_signal
from gearidae.errors import SceneError
from gearidae.scene import text_table

TIME = np.arange(64) * 1e-5
SPEED = 1.5 + 0.01 * np.sin(7e3 * TIME)
TABLE = np.column_stack([TIME, SPEED])
HEADER = "time [ms], gear_speed [rad/s]"
SPEED_44 = "line 44: column 'gear_speed [rad/s]', row 41"


@pytest.fixture
def file(tmp_path):
    def write(text):
        path = tmp_path / "record.csv"
        path.write_text(text)
        return path

    return write


def rows(separator=",", first=0, last=64):
    return "".join(f"{time!r}{separator}{speed!r}\n" for time, speed in TABLE[first:last].tolist())


@pytest.fixture
def at_once(monkeypatch):
    """The file is read at once; looking at each line is for small files, and those in which something is wrong."""
    monkeypatch.setattr(text_table, "_SMALL", 0)
    monkeypatch.setattr(text_table.TextTable, "_row_by_row", lambda *_, **__: pytest.fail("read row by row"))


@pytest.mark.parametrize("separator", [",", ";", "\t"])
@pytest.mark.usefixtures("at_once")
def test_the_usual_file_is_read_at_once_and_exactly(separator, file):
    ds = read_signal(file(f"time [s]{separator}gear_speed [rad/s]\n{rows(separator)}"))
    np.testing.assert_array_max_ulp(ds.time.values, TIME, 1)  # pandas may round the last bit
    np.testing.assert_array_max_ulp(ds.gear_speed.values, SPEED, 1)


@pytest.mark.parametrize("delimiter", [",", " ", "\t"])
@pytest.mark.parametrize("header", [HEADER, "time [ms] gear_speed [rad/s]", "a rig\n" + HEADER])
@pytest.mark.usefixtures("at_once")
def test_what_numpy_writes_is_read(delimiter, header, tmp_path):
    path = tmp_path / "rig.csv"
    np.savetxt(path, TABLE * [1e3, 1.0], delimiter=delimiter, header=header)
    ds = read_signal(path)
    np.testing.assert_allclose(ds.time, TIME, rtol=1e-15, atol=1e-20)
    np.testing.assert_allclose(ds.gear_speed, SPEED, rtol=1e-15)


@pytest.mark.usefixtures("at_once")
def test_other_columns_and_remarks_before_the_numbers_are_ignored(file):
    lines = "".join(f"x,{speed!r},{time!r}\n" for time, speed in TABLE.tolist())
    ds = read_signal(file(f"# a rig\n\nwho,gear_speed [rad/s],time [s]\n# of today\n{lines}"))
    np.testing.assert_array_max_ulp(ds.gear_speed.values, SPEED, 1)


@pytest.mark.parametrize(
    "text",
    [
        f"time [s],gear_speed [rad/s]\n{rows(last=30)}# a pause\n\n{rows(first=30)}",
        "time [s],gear_speed [rad/s]\n" + rows().replace("\n", ",\n", 1),
    ],
    ids=["remark within", "cell too many"],
)
def test_what_is_not_regular_is_read_line_by_line(text, file):
    ds = read_signal(file(text))
    # older versions of pandas round the last digit of a number otherwise
    np.testing.assert_allclose(ds.gear_speed, SPEED, rtol=np.finfo(float).eps, atol=0.0)


@pytest.mark.parametrize("rows_at_once", [0, 2**30])
@pytest.mark.parametrize(
    ("cell", "reason"),
    [
        ("1,fast", f"{SPEED_44} is 'fast', no number"),
        ("1", "line 44: row 41 has 1 cell, but there are 2 headings"),
        ("1,2,3", "line 44: row 41 has 3 cells, but there are 2 headings"),
        ("0,4,1,5", "line 44: row 41 has 4 cells, but there are 2 headings"),
        ("1,inf", f"{SPEED_44} is inf, not a finite number"),
        ("1,1e999", f"{SPEED_44} is 1e999, not a finite number"),
        ("1,1_0", f"{SPEED_44} is '1_0', no number"),
        ("NA,1.5", "time = nan: sample 40 has no time"),
        (f"{float(TIME[40])!r},", "sample 40 (0.0004 s) is missing, within the record (1 in all)"),
        (f"{float(TIME[40])!r},nan", "sample 40 (0.0004 s) is missing, within the record (1 in all)"),
    ],
)
def test_a_bad_row_is_named_wherever_it_stands(cell, reason, rows_at_once, file, monkeypatch):
    monkeypatch.setattr(text_table, "_SMALL", rows_at_once)
    text = f"# a rig\n\ntime [s],gear_speed [rad/s]\n{rows(last=40)}{cell}\n{rows(first=41)}"
    with pytest.raises(SceneError) as caught:
        read_signal(file(text))
    assert reason in str(caught.value)


def test_a_header_in_a_remark_must_name_the_units(file):
    with pytest.raises(SceneError, match="'time' states no unit"):
        read_signal(file(f"# time, gear_speed [rad/s]\n{rows()}"))


def test_numbers_without_any_header_are_refused(file):
    with pytest.raises(SceneError, match=r"has no column time among '0\.0', '1\.5', nor one"):
        read_signal(file(rows()))


def test_a_long_record_takes_little_memory(tmp_path):
    """Twice its numbers, and a few buffers: once twenty times."""
    count = 200_000
    time = np.arange(count) * 1e-5
    path = tmp_path / "long.csv"
    np.savetxt(
        path, np.column_stack([time, 1.5 + time]), delimiter=",", header="time [s], gear_speed [rad/s]"
    )
    tracemalloc.start()
    try:
        ds = read_signal(path)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert ds.sizes["time"] == count
    assert peak < 6 * 16 * count


def test_units_of_a_netcdf_record_are_converted(tmp_path):
    """Milliseconds and revolutions per minute, which an online assessment would take for SI."""
    path = tmp_path / "record.nc"
    rpm = 2 * np.pi / 60
    speeds = ("time", SPEED / rpm, {"units": "rpm", "long_name": "of the gear"})
    xr.Dataset({"gear_speed": speeds}, {"time": ("time", 1e3 * TIME, {"units": "ms"})}).to_netcdf(path)
    ds = read_signal(path)
    np.testing.assert_allclose(ds.time, TIME, rtol=1e-12)
    np.testing.assert_allclose(ds.gear_speed, SPEED, rtol=1e-12)
    assert ds.time.attrs["units"] == "s"
    assert ds.gear_speed.attrs == {"units": "rad s-1", "long_name": "of the gear"}


def laboratory(encoding="cp1252"):
    """What a logger wrote: semicolons, decimal commas, two lines above the headings, six samples missing."""
    missing = {7, 20, 21, 22, 40, 41}
    rows = [
        f"{1e3 * time:.5f};{'' if n in missing else f'{60 / (2 * np.pi) * speed:.6f}'};21,5".replace(".", ",")
        for n, (time, speed) in enumerate(zip(TIME, SPEED, strict=True))
    ]
    heads = ["Prüfstand 2; 25.11.2026", "Abtastrate;100 kHz", "Zeit [ms];Drehzahl [1/min];Temperatur [°C]"]
    return "\r\n".join([*heads, *rows, ""]).encode(encoding), sorted(missing)


@pytest.mark.parametrize("encoding", ["cp1252", "utf-8", "utf-8-sig", "utf-16"])
@pytest.mark.parametrize(
    "columns",
    [
        {},
        {"columns": ("Zeit [ms]", "Drehzahl [1/min]")},
        {"skip": 2, "delimiter": ";", "decimal": ",", "columns": ["Zeit [ms]", "Drehzahl [1/min]"]},
    ],
)
def test_a_laboratorys_file_needs_no_repair(encoding, columns, tmp_path):
    content, missing = laboratory(encoding)
    path = tmp_path / "rig.csv"
    path.write_bytes(content)
    ds = read_signal(path, bridge=3, **columns)
    np.testing.assert_allclose(ds.time, TIME, atol=1e-12)
    kept = np.delete(np.arange(64), missing)
    np.testing.assert_allclose(ds.gear_speed[kept], SPEED[kept], rtol=1e-6)
    straight = np.interp(TIME[missing], TIME[kept], SPEED[kept])
    np.testing.assert_allclose(ds.gear_speed[missing], straight, rtol=1e-6)
    said = "semicolons, decimal commas, 2 lines skipped"
    by_unit = (
        ", 'Zeit [ms]' taken for the time, 'Drehzahl [1/min]' taken for the gear_speed" if not columns else ""
    )
    assert ds.attrs["reading"] == f"{said}{by_unit}, 6 samples bridged"
    with pytest.raises(
        SceneError, match=r"sample 20 \(0.0002 s\) is missing, within the record \(3 in all\)"
    ):
        read_signal(path, bridge=2, **columns)


@pytest.mark.parametrize("unit", ["1/min", "min^-1", "U/min", "rpm", "rev/min", "r/min", "tr/min"])
def test_turns_per_minute_are_no_radians(unit, file):
    lines = "".join(f"{time!r},{speed!r}\n" for time, speed in TABLE.tolist())
    ds = read_signal(file(f"time [s],speed [{unit}]\n{lines}"))
    np.testing.assert_allclose(ds.gear_speed, SPEED * 2 * np.pi / 60, rtol=1e-12)


def test_frames_are_read_by_their_headings():
    speed = SPEED.copy()
    speed[9] = np.nan
    frame = pd.DataFrame({"Zeit [ms]": 1e3 * TIME, "note": "x", "Drehzahl [rpm]": speed * 60 / (2 * np.pi)})
    for table in (frame, frame.set_index("Zeit [ms]")):
        ds = read_signal(table, columns=["Zeit [ms]", "Drehzahl [rpm]"], bridge=1)
        np.testing.assert_allclose(ds.time, TIME, rtol=1e-12)
        np.testing.assert_allclose(np.delete(ds.gear_speed.values, 9), np.delete(SPEED, 9), rtol=1e-12)
        assert ds.attrs["reading"] == "1 sample bridged"
    with pytest.raises(SceneError, match=r"signal = DataFrame.*sample 9"):
        read_signal(frame)
    with pytest.raises(SceneError, match="skip = 2: is for text files; this is a DataFrame"):
        read_signal(frame, skip=2)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"columns": "gear_speed"}, "states no distance of its samples"),
        ({"columns": ("a", "b", "c")}, "must be two headings"),
        ({"columns": ("time [s]", "omega")}, "has no column 'omega'"),
        ({"skip": -1}, "skip = -1: must be a whole number, 0 or more"),
        ({"skip": 1}, "has no column time"),
        ({"delimiter": "ab"}, "delimiter = ab: must be one character"),
        ({"delimiter": ";"}, "line 2: row 1 has 1 cell, but there are 2 headings"),
        ({"decimal": ";"}, "decimal = ;: must be '.' or ','"),
        ({"bridge": -1}, "bridge = -1: must be a whole number, 0 or more"),
        ({"bridge": 1.5}, "bridge = 1.5"),
    ],
)
def test_bad_settings_are_named(settings, message, file):
    with pytest.raises(SceneError) as caught:
        read_signal(file(f"time [s],gear_speed [rad/s]\n{rows()}"), **settings)
    assert message in str(caught.value)


def test_columns_are_chosen_among_several(file):
    lines = "".join(f"{time!r},{speed!r},{2 * speed!r}\n" for time, speed in TABLE.tolist())
    path = file(f"t,pinion [rad/s],gear [rad/s]\n{lines}")
    with pytest.raises(SceneError, match="states no unit"):
        read_signal(path)
    np.testing.assert_allclose(
        read_signal(path, columns=("t [s]", "gear [rad/s]")).gear_speed, 2 * SPEED, rtol=1e-12
    )
    with pytest.raises(SceneError, match="'t' states no unit"):
        read_signal(path, columns=("t", "gear [rad/s]"))
    with pytest.raises(SceneError, match="nor one column alone in rad/s"):
        read_signal(file(f"t [s],pinion [rad/s],gear [rad/s]\n{lines}"))


def test_variables_of_a_netcdf_file_are_chosen(tmp_path):
    ds = xr.Dataset({"omega": ("t", SPEED, {"units": "rad/s"})}, {"t": ("t", TIME, {"units": "s"})})
    ds.to_netcdf(tmp_path / "record.nc")
    signal = read_signal(tmp_path / "record.nc", columns=("t", "omega"))
    np.testing.assert_array_equal(signal.gear_speed, SPEED)
    with pytest.raises(SceneError, match="lacks the variable time"):
        read_signal(tmp_path / "record.nc")
    with pytest.raises(SceneError, match="delimiter = ;: is for text files; this is a netCDF file"):
        read_signal(tmp_path / "record.nc", delimiter=";")


def test_headings_without_rows_are_a_record_that_is_too_short(file):
    with pytest.raises(SceneError, match=r"\(0 samples\): a record needs 16 samples or more"):
        read_signal(file("time [s],gear_speed [rad/s]\n"))
