"""Records from CSV files: as rigs and numpy write them, fast, and with the bad row named."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest

from gearidae.analysis import measured, read_signal
from gearidae.errors import SceneError

TIME = np.arange(64) * 1e-5
SPEED = 1.5 + 0.01 * np.sin(7e3 * TIME)
TABLE = np.column_stack([TIME, SPEED])
HEADER = "time [ms], gear_speed [rad/s]"


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
def steps_per_interval(monkeypatch):
    """The file is read at once; looking at each line is for files in which something is wrong."""
    monkeypatch.setattr(measured, "_numbers_by_line", lambda *_: pytest.fail("read line by line"))


@pytest.mark.parametrize("separator", [",", ";", "\t"])
@pytest.mark.usefixtures("steps_per_interval")
def test_the_usual_file_is_read_at_once_and_exactly(separator, file):
    ds = read_signal(file(f"time [s]{separator}gear_speed [rad/s]\n{rows(separator)}"))
    np.testing.assert_array_max_ulp(ds.time.values, TIME, 1)  # pandas may round the last bit
    np.testing.assert_array_max_ulp(ds.gear_speed.values, SPEED, 1)


@pytest.mark.parametrize("delimiter", [",", " ", "\t"])
@pytest.mark.parametrize("header", [HEADER, "time [ms] gear_speed [rad/s]", "a rig\n" + HEADER])
@pytest.mark.usefixtures("steps_per_interval")
def test_what_numpy_writes_is_read(delimiter, header, tmp_path):
    path = tmp_path / "rig.csv"
    np.savetxt(path, TABLE * [1e3, 1.0], delimiter=delimiter, header=header)
    ds = read_signal(path)
    np.testing.assert_allclose(ds.time, TIME, rtol=1e-15, atol=1e-20)
    np.testing.assert_allclose(ds.gear_speed, SPEED, rtol=1e-15)


@pytest.mark.usefixtures("steps_per_interval")
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


@pytest.mark.parametrize(
    ("cell", "reason"),
    [
        ("1,fast", "line 44: gear_speed is 'fast', not a number"),
        ("1", "line 44: gear_speed is 'nothing', not a number"),
        ("1,", "line 44: gear_speed is '', not a number"),
        ("NA,1.5", "line 44: time is 'NA', not a number"),
        ("1,nan", "line 44: every number must be finite"),
        ("inf,1", "line 44: every number must be finite"),
        ("1,1e999", "line 44: every number must be finite"),
        ("1,1.5 # a remark", "line 44: gear_speed is '1.5 # a remark', not a number"),
    ],
)
def test_a_bad_row_is_named_wherever_it_stands(cell, reason, file):
    text = f"# a rig\n\ntime [s],gear_speed [rad/s]\n{rows(last=40)}{cell}\n{rows(first=41)}"
    with pytest.raises(SceneError) as caught:
        read_signal(file(text))
    assert reason in str(caught.value)


def test_a_header_in_a_remark_must_name_the_units(file):
    with pytest.raises(SceneError, match="'time' states no unit"):
        read_signal(file(f"# time, gear_speed [rad/s]\n{rows()}"))


def test_numbers_without_any_header_are_refused(file):
    with pytest.raises(SceneError, match="has no column time nor gear_speed"):
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
