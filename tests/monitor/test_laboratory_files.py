"""Records as laboratories' programs and oscilloscopes write them: LabVIEW, Rigol, Tektronix, numbers alone."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

import gearidae as gd
from gearidae.analysis import read_signal
from gearidae.analysis.signal import signals
from gearidae.monitor.sensor import check_sensor

COUNT = 200
TIME = np.arange(COUNT) * 1e-5
SPEED = np.round(1.5 + 0.01 * np.sin(7e3 * TIME), 6)
ENDS = ("", ",")


def comma(number):
    return f"{number:.6f}".replace(".", ",")


def labview(columns="No"):
    """A file of version 2 with decimal commas; below its last heading no row has a cell."""
    rows = "".join(
        f"{'' if columns == 'No' else comma(t)}\t{comma(w)}\n" for t, w in zip(TIME, SPEED, strict=True)
    )
    return (
        "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\nDecimal_Separator\t,\n"
        f"Multi_Headings\tNo\nX_Columns\t{columns}\nTime_Pref\tRelative\nDate\t2026/11/26\nTime\t17:18:18,938945\n"
        "***End_of_Header***\t\n\t\nChannels\t1\t\nSamples\t200\t\nDate\t2026/11/26\t\nY_Unit_Label\tVolts\t\n"
        "X_Dimension\tTime\t\nX0\t0,0000000000000000E+0\t\nDelta_X\t0,000010\t\n***End_of_Header***\t\t\n"
        f"X_Value\tUntitled\tComment\n{rows}"
    )


def rigol(end):
    rows = "".join(f"{k},{w:.6f}{end}\n" for k, w in enumerate(SPEED))
    return f"X,CH1,Start,Increment{end}\nSequence,Volt,-1.000000e-05,1.000000e-05{end}\n{rows}"


def tektronix():
    """What stands above the numbers in other files stands beside them here."""
    head = ["Record Length,200", "Sample Interval,1e-5", "Trigger Point,0", ",", "Source,CH1"]
    head += [","] * (COUNT - len(head))
    return "".join(f"{a},,{t:.6f},{w:.6f},\n" for a, t, w in zip(head, TIME, SPEED, strict=True))


BY_STEP = {"interval": "10 us"}
STATED = -1e-5
"""First time that the file of Rigol states."""
FILES = [
    (labview(), {"columns": "Untitled [rad/s]", **BY_STEP}),
    (labview(), {"columns": ("2 [rad/s]",), **BY_STEP}),
    (labview(), {"columns": ("1 [s]", "2 [rad/s]"), **BY_STEP}),
    (labview("One"), {"columns": ("X_Value [s]", "Untitled [rad/s]")}),
    (labview("One"), {"columns": ("1 [s]", "2 [rad/s]")}),
    *((rigol(end), {"columns": name, **BY_STEP}) for end in ENDS for name in ("CH1 [rad/s]", "2 [rad/s]")),
    (labview(), {"columns": "Untitled [rad/s]"}),
    (labview(), {"columns": "2 [rad/s]"}),
    (labview().replace("Untitled\t", "n [rad/s]\t"), {}),
    (labview().replace("0,000010", "0,000010\t0,000010"), {"columns": "2 [rad/s]"}),
    (tektronix(), {"columns": ("4 [s]", "5 [rad/s]")}),
    ("".join(f"{w:.6f}\n" for w in SPEED), {"columns": "1 [rad/s]", **BY_STEP}),
    ("".join(f"{t:.6f} {w:.6f}\n" for t, w in zip(TIME, SPEED, strict=True)), {"columns": ("1 [s]", "2 [rad/s]")}),
]  # fmt: skip


@pytest.fixture
def file(tmp_path):
    def write(text):
        path = tmp_path / "record.lvm"
        path.write_text(text)
        return path

    return write


@pytest.mark.parametrize(("text", "options"), FILES)
def test_they_are_read(text, options, file):
    signal = read_signal(file(text), **options)
    np.testing.assert_allclose(signal.time, TIME, rtol=1e-12, atol=1e-18)
    np.testing.assert_allclose(signal.gear_speed, SPEED, rtol=1e-12)


@pytest.mark.parametrize(("text", "options"), FILES)
def test_a_row_short_in_the_middle_stays_refused(text, options, file):
    lines = text.splitlines()
    lines[-50] = "0" if "\t" in lines[-50] or "," in lines[-50] or " " in lines[-50] else "x"
    with pytest.raises(gd.SceneError, match=f"line {len(lines) - 49}"):
        read_signal(file("\n".join(lines)), **options)


@pytest.mark.parametrize("columns", [("1 [s]", "2 [rad/s]"), ("X_Value [s]", "Untitled [rad/s]")])
def test_one_row_of_labview_has_a_comment(columns, file):
    lines = labview("One").splitlines()
    lines[-50] += "\tbang"
    signal = read_signal(file("\n".join(lines)), columns=columns)
    np.testing.assert_allclose(signal.gear_speed, SPEED, rtol=1e-12)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"columns": ("1 [s]", "7 [rad/s]")}, "has no rows with numbers in column 1 and 7"),
        ({"columns": ("1", "2 [rad/s]")}, "states no unit"),
        ({"columns": ()}, "must be two headings"),
        ({"columns": ("a", "b", "c"), "interval": 1e-5}, "that of the speed alone"),
        ({}, "interval=..., --interval"),
        ({"interval": "0 s"}, "interval = 0 s: must be above 0 s"),
        ({"interval": "1 m"}, "interval = 1 m"),
        ({"interval": True}, "interval = True"),
    ],
)
def test_what_is_missing_is_named(options, message, file):
    with pytest.raises(gd.SceneError, match=message):
        read_signal(file(labview("One")), **options)


@pytest.mark.parametrize("end", ENDS)
@pytest.mark.parametrize("name", ["CH1 [rad/s]", "2 [rad/s]"])
def test_start_and_increment_of_rigol_are_times(end, name, file):
    signal = read_signal(file(rigol(end)), columns=name)
    np.testing.assert_allclose(signal.time, STATED + TIME, rtol=1e-12, atol=1e-18)
    np.testing.assert_allclose(signal.gear_speed, SPEED, rtol=1e-12)
    assert "samples 10 us apart" in signal.attrs["reading"]


def test_rigol_with_decimal_commas(file):
    text = rigol("").replace(",", ";").replace(".", ",")
    np.testing.assert_allclose(
        read_signal(file(text), columns="CH1 [rad/s]").time, STATED + TIME, rtol=1e-12, atol=1e-18
    )


@pytest.mark.parametrize(
    "text",
    [
        labview().replace("Delta_X", "Delta"),
        labview().replace("0,000010", "0,000010\t0,000020"),
        labview().replace("0,000010", "0"),
        labview().replace("X_Dimension\tTime", "X_Dimension\tLength"),
        rigol("").replace("1.000000e-05\n", "x\n"),
    ],
)
def test_a_distance_that_is_not_stated_is_not_made_up(text, file):
    with pytest.raises(gd.SceneError, match=r"states no distance of its samples.*--interval"):
        read_signal(file(text), columns="2 [rad/s]")


def test_one_column_is_enough_for_files_that_state_times_only(tmp_path):
    path = tmp_path / "record.nc"
    xr.Dataset({"gear_speed": ("time", SPEED, {"units": "rad/s"})}, {"time": ("time", TIME)}).to_netcdf(path)
    with pytest.raises(gd.SceneError, match="columns = gear_speed: must be two headings"):
        read_signal(path, columns="gear_speed")


def test_a_heading_in_another_unit_of_the_kind_is_not_overruled(file):
    rows = "".join(f"{1e3 * t:.6f},{w:.6f}\n" for t, w in zip(TIME, SPEED, strict=True))
    with pytest.raises(gd.SceneError, match="is not in s: leave the unit out"):
        read_signal(file(f"zeit [ms],n [rad/s]\n{rows}"), columns=("zeit [s]", "n [rad/s]"))


def six_digits(rate, count):
    return np.array([float(f"{time:.6g}") for time in 0.5 + np.arange(count) / rate])


@pytest.mark.parametrize(("rate", "count"), [(40e3, 100_000), (44.1e3, 200_000)])
def test_times_rounded_to_six_digits_are_even(rate, count):
    times = six_digits(rate, count)
    array = xr.DataArray(np.ones(count), dims="time", coords={"time": times})
    assert signals(array).signals[0].rate == pytest.approx(rate, rel=1e-5, abs=0)
    missed = array.isel(time=np.delete(np.arange(count), count - 1000))
    with pytest.raises(gd.SceneError, match=r"off the uniform grid.*--interval"):
        signals(missed)


def test_exact_times_with_a_sample_missing_are_no_rounded_ones():
    array = xr.DataArray(np.ones(COUNT), dims="time", coords={"time": TIME})
    with pytest.raises(gd.SceneError, match="off the uniform grid"):
        signals(array.isel(time=np.delete(np.arange(COUNT), 77)))


def test_a_filter_may_be_given_with_its_unit():
    assert check_sensor(anti_alias_filter="4 kHz").cutoff == 4e3
    assert check_sensor(anti_alias_filter=4e3).cutoff == 4e3
    for wrong in ("4 rad/s", -1.0, "4"):
        with pytest.raises(gd.SceneError, match="anti_alias_filter"):
            check_sensor(anti_alias_filter=wrong)
