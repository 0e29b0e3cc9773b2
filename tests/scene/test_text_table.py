"""Tables in text files as programs of all kinds write them, and files that are none."""

from __future__ import annotations

import os
import resource
import sys

import numpy as np
import pytest

import gearidae as gd
from gearidae.analysis import read_signal
from gearidae.calibration.observation_files import read_observations
from gearidae.scene import text_table
from gearidae.scene.table_head import open_table
from gearidae.surfaces import read_scan

NUMBERS = np.array([[0.0, 1.5], [0.25, -2e-3], [0.5, 3.0]])


def read(tmp_path, text, encoding="utf-8", **options):
    path = tmp_path / "table.csv"
    path.write_bytes(text.encode(encoding))
    return open_table(
        path, largest=10**9, names=lambda names: any(name.startswith("t") for name in names), **options
    )


@pytest.fixture(params=["row by row", "at once"])
def way(request, monkeypatch):
    monkeypatch.setattr(text_table, "_SMALL", 2**30 if request.param == "row by row" else 0)


def table_text(delimiter, decimal, heading="t [s]{}v [m/s]", end="\n"):
    rows = [delimiter.join(repr(float(cell)).replace(".", decimal) for cell in row) for row in NUMBERS]
    return end.join([heading.format(delimiter), *rows]) + end


@pytest.mark.usefixtures("way")
@pytest.mark.parametrize(
    ("delimiter", "decimal"),
    [(",", "."), (";", "."), (";", ","), ("\t", "."), ("\t", ","), ("  ", "."), (" ", ","), (", ", ".")],
)
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_separator_and_decimal_sign_are_recognised(delimiter, decimal, end, tmp_path):
    table = read(tmp_path, table_text(delimiter, decimal, end=end))
    assert table.headings == ("t [s]", "v [m/s]")
    assert (table.delimiter, table.decimal) == (delimiter.strip(" "), decimal)
    np.testing.assert_allclose(table.numbers(), NUMBERS, rtol=1e-15)


@pytest.mark.usefixtures("way")
@pytest.mark.parametrize("separator", [",", ";", "\t"])
@pytest.mark.parametrize("where", ["rows", "rows and heading", "heading", "first row"])
def test_a_separator_at_the_end_of_a_line_makes_no_column(separator, where, tmp_path):
    heading, *rows = table_text(separator, ".").splitlines()
    heading += separator if "heading" in where else ""
    rows = [
        row + separator if "rows" in where or (where == "first row" and not n) else row
        for n, row in enumerate(rows)
    ]
    table = read(tmp_path, "\n".join([heading, *rows]))
    assert table.headings == ("t [s]", "v [m/s]")
    np.testing.assert_allclose(table.numbers(), NUMBERS, rtol=1e-15)


@pytest.mark.usefixtures("way")
@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "cp1252"])
def test_encodings_of_windows_programs(encoding, tmp_path):
    table = read(tmp_path, table_text(";", ",", "t [µs]{}v [°/s]"), encoding)
    assert table.headings == ("t [µs]", "v [°/s]")
    np.testing.assert_allclose(table.numbers(), NUMBERS, rtol=1e-15)


@pytest.mark.usefixtures("way")
@pytest.mark.parametrize(
    ("row", "reason"),
    [
        ("0,4.5,1", "line 3: row 2 has 3 cells, but there are 2 headings: if a comma is the decimal sign"),
        ("1", "line 3: row 2 has 1 cell, but there are 2 headings"),
        ("1,", "line 3: column 'v', row 2 is empty"),
        ("1,x", "line 3: column 'v', row 2 is 'x', no number"),
        ("1,nan", "line 3: column 'v', row 2 is nan, not a finite number"),
        ('1,"2', "line 3 is no row of a table"),
    ],
)
def test_a_bad_row_is_named(row, reason, tmp_path):
    with pytest.raises(ValueError, match="line 3") as caught:
        read(tmp_path, f"t,v\n0,1\n{row}\n" + ("" if '"' in row else "3,4\n")).numbers()
    assert reason in str(caught.value)


@pytest.mark.usefixtures("way")
@pytest.mark.parametrize("cell", ["1.234", "1.234,5", "1 234,5"])
def test_a_thousands_separator_is_no_decimal_point(cell, tmp_path):
    with pytest.raises(ValueError, match=f"row 2 is '{cell}', no number"):
        read(tmp_path, f"t;v\n0,5;1,5\n1;{cell}\n").numbers()


def test_units_may_stand_below_the_headings(tmp_path):
    table = read(tmp_path, "rig 5\nt;v;note\ns;[m/s];\n0;1,5;a\n1;2;b\n", unit_row=True)
    assert table.headings == ("t [s]", "v [m/s]", "note")
    assert table.recognised == ("semicolons", "decimal commas", "1 line skipped")
    np.testing.assert_allclose(table.numbers([0, 1]), [[0, 1.5], [1, 2]])


def test_lines_above_the_headings_may_hold_anything(tmp_path):
    table = read(tmp_path, 'Operator: "N. N." and others\n1,2,3\n;;;\nt;v\n0;1,5\n')
    assert table.headings == ("t", "v")
    assert table.skipped == 3
    np.testing.assert_allclose(table.numbers(), [[0, 1.5]])


def test_a_long_line_of_headings_is_read(tmp_path):
    """Of 200 kB: 20,000 channels."""
    count = 20_000
    names = ",".join(f"t{n:08d}" for n in range(count))
    table = read(tmp_path, f"{names}\n{','.join(['1'] * count)}\n{','.join(['2'] * count)}\n")
    assert len(table.headings) == count
    np.testing.assert_array_equal(table.numbers([count - 1]), [[1], [2]])


def test_one_long_heading_is_refused_in_one_line(tmp_path):
    with pytest.raises(ValueError, match="field limit") as caught:
        read(tmp_path, f"t,{'x' * 200_000}\n1,2\n")
    assert len(str(caught.value)) < 300


def schedule(path):
    gd.preset("teodorescu2009_low_speed").replace({"drive.schedule": {"file": str(path)}})


def asperities(path):
    gd.preset("teodorescu2009_low_speed").replace({"contact.asperities": {"file": str(path)}})


def observations(path):
    read_observations(path)


READERS = [schedule, asperities, read_signal, read_scan, observations]
needs_posix = pytest.mark.skipif(sys.platform == "win32", reason="no FIFOs")


def link(tmp_path, target):
    path = tmp_path / "endless.csv"
    path.symlink_to(target)
    return path


def fifo(tmp_path):
    path = tmp_path / "pipe.csv"
    os.mkfifo(path)
    return path


def long(tmp_path):
    path = tmp_path / "long.csv"
    with path.open("wb") as file:
        file.write(b"time [s],gear_speed [rad/s]\n")
        file.truncate(2**40)
    return path


@needs_posix
@pytest.mark.parametrize("reader", READERS)
@pytest.mark.parametrize(
    ("make", "reason"),
    [
        (fifo, "is a pipe or a device"),
        (lambda folder: link(folder, "/dev/zero"), "is a pipe or a device"),
        (long, "is larger than"),
        (lambda folder: folder, "is a folder"),
        (lambda folder: folder / "none.csv", "there is no file none.csv"),
    ],
)
def test_a_file_without_end_is_refused_before_it_is_read(reader, make, reason, tmp_path):
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    path = make(tmp_path)
    if reader is observations and path == tmp_path:
        path = tmp_path / "folder.csv"
        path.mkdir()
    with pytest.raises(gd.SceneError, match=reason) as caught:
        reader(path)
    assert "\n" not in str(caught.value)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 100_000  # kB


@pytest.mark.parametrize("reader", READERS)
def test_bytes_that_are_no_text_are_refused_in_one_line(reader, tmp_path):
    path = tmp_path / "bytes.csv"
    for content in (bytes(1000), bytes(range(256)) * 10, b"\x89PNG\r\n\x1a\n" + bytes(50)):
        path.write_bytes(content)
        with pytest.raises(gd.SceneError, match="is no text") as caught:
            reader(path)
        assert "\n" not in str(caught.value)


@pytest.mark.usefixtures("way")
@pytest.mark.parametrize("cell", ["1.#QNAN", "-1.#IND", "-1.#IND00", "1.#SNAN"])
def test_a_number_sign_within_a_cell_is_no_remark(cell, tmp_path):
    """What Windows writes for an undefined number is missing in a record, and refused in a schedule and a map."""
    times = [n / 1000.0 for n in range(40)]
    rows = [f"{n},{t!r},2.5 # checked" for n, t in enumerate(times)]
    rows[7] = f"7,{times[7]!r},{cell}"
    path = tmp_path / "record.csv"
    path.write_text("\n".join(["#written by hand", "Sample #,time [s],gear_speed [rad/s]", *rows]))
    with pytest.raises(gd.SceneError, match=r"sample 7 .* is missing"):
        read_signal(path)
    assert read_signal(path, bridge=1).gear_speed.values.tolist() == [2.5] * 40
    table = {"file": path, "time": "time [s]", "value": "gear_speed [N m]"}
    path.write_text(path.read_text().replace("rad/s", "N m"))
    with pytest.raises(gd.SceneError, match=f"{cell}, not a finite|{cell}', no number"):
        gd.preset("teodorescu2009").replace({"drive.schedule": table})
    (tmp_path / "scan.csv").write_text("\n".join([" ".join(["1", cell, "2"])] * 70))
    with pytest.raises(gd.SceneError, match=f"{cell}, not a finite"):
        read_scan(tmp_path / "scan.csv")


def test_a_record_without_a_number_is_refused(tmp_path):
    path = tmp_path / "record.csv"
    path.write_text("time [s],gear_speed [rad/s]\n" + "".join(f"{n},nan\n" for n in range(40)))
    with pytest.raises(gd.SceneError, match="none of its 40 samples is a number"):
        read_signal(path)
