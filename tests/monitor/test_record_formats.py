"""Records as laboratories keep them: other kinds of files, dates, remarks within cells, revolutions per minute."""

import gzip
import math

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from scipy.io import savemat

import gearidae as gd
from gearidae.analysis import read_signal
from gearidae.scene.units import from_text

TIME = np.arange(400) * 1e-4
SPEED = 2.0 + np.cos(2 * math.pi * 300.0 * TIME)
COLUMNS = ("t [s]", "w [rad/s]")


def same(ds):
    np.testing.assert_allclose(ds["time"].values, TIME, rtol=0, atol=1e-12)
    np.testing.assert_allclose(ds["gear_speed"].values, SPEED, rtol=1e-12, atol=0)


def test_matlab(tmp_path):
    savemat(tmp_path / "a.mat", {"t": TIME, "w": SPEED[:, None], "name": "bench", "gain": 3.0})
    same(read_signal(tmp_path / "a.mat", columns=COLUMNS))


def test_numpy(tmp_path):
    np.save(tmp_path / "a.npy", np.column_stack([TIME, SPEED]))
    same(read_signal(tmp_path / "a.npy", columns=("1 [s]", "2 [rad/s]")))
    np.save(tmp_path / "b.npy", SPEED)
    same(read_signal(tmp_path / "b.npy", columns=("1 [rad/s]",), interval="0.1 ms"))
    np.save(tmp_path / "c.npy", np.array([{"a": 1}], dtype=object))
    with pytest.raises(gd.SceneError, match=r"cannot be read as a \.npy file"):
        read_signal(tmp_path / "c.npy", columns=COLUMNS)


def test_compressed_text(tmp_path):
    with gzip.open(tmp_path / "a.csv.gz", "wt") as file:
        pd.DataFrame({"time [s]": TIME, "gear_speed [rad/s]": SPEED}).to_csv(file, index=False)
    same(read_signal(tmp_path / "a.csv.gz"))
    (tmp_path / "b.csv.gz").write_bytes(b"no gzip")
    with pytest.raises(gd.SceneError, match="cannot be unpacked"):
        read_signal(tmp_path / "b.csv.gz")


def test_a_damaged_workbook_is_refused_in_one_line(tmp_path):
    (tmp_path / "a.xlsx").write_bytes(b"PK\x03\x04" + bytes(100))
    with pytest.raises(gd.SceneError, match=r"\.xlsx file|openpyxl, which is not installed"):
        read_signal(tmp_path / "a.xlsx", columns=COLUMNS)


@pytest.mark.parametrize(("suffix", "library"), [(".xlsx", "openpyxl"), (".tdms", "npTDMS")])
def test_a_library_that_is_missing_is_named(tmp_path, suffix, library):
    try:
        __import__("nptdms" if suffix == ".tdms" else library)
    except ImportError:
        (tmp_path / f"a{suffix}").write_bytes(b"PK")
        with pytest.raises(gd.SceneError, match=f"pip install {library}"):
            read_signal(tmp_path / f"a{suffix}", columns=COLUMNS)
    else:
        pytest.skip(f"{library} is installed")


def test_times_as_dates(tmp_path):
    dates = np.datetime64("2026-11-28T12:00") + (TIME * 1e9).astype("timedelta64[ns]")
    ds = xr.Dataset({"gear_speed": ("time", SPEED, {"units": "rad/s"})}, coords={"time": dates})
    ds.to_netcdf(tmp_path / "a.nc")
    same(read_signal(tmp_path / "a.nc"))
    same(read_signal(pd.DataFrame({"time": dates, "gear_speed [rad/s]": SPEED})))
    spectrum = gd.analysis.power_spectrum(ds["gear_speed"])
    assert float(spectrum["frequency"][int(spectrum.values.argmax())]) == pytest.approx(300.0, rel=0.05)


def test_remarks_and_cells_that_look_like_them(tmp_path):
    rows = [f"{t:.17g},{w:.17g}" for t, w in zip(TIME, SPEED, strict=True)]
    rows[3] += " # checked"
    text = "Sample #1,time [s],gear_speed [rad/s]\n" + "\n".join(f"{k},{row}" for k, row in enumerate(rows))
    (tmp_path / "a.csv").write_text("# by hand\n" + text.replace("Sample #1", "Sample #"))
    same(read_signal(tmp_path / "a.csv"))
    for word in ("1.#QNAN", "-1.#IND", "1.#INF00"):
        cells = list(rows)
        cells[200] = f"{TIME[200]:.17g},{word}"
        (tmp_path / "b.csv").write_text("time [s],gear_speed [rad/s]\n" + "\n".join(cells))
        with pytest.raises(gd.SceneError, match=r"sample 200 .* is missing"):
            read_signal(tmp_path / "b.csv")
        bridged = read_signal(tmp_path / "b.csv", bridge=1)
        assert float(bridged["gear_speed"][200]) == pytest.approx(0.5 * (SPEED[199] + SPEED[201]))
        (tmp_path / "drive.csv").write_text(f"t [s],M [N m]\n0,0\n1,{word}\n")
        with pytest.raises(gd.SceneError, match="not a finite number"):
            gd.preset("start_up").replace({"drive.schedule": {"file": str(tmp_path / "drive.csv")}})


def test_one_column_with_an_interval(tmp_path):
    (tmp_path / "a.csv").write_text("gear_speed [rad/s]\n" + "\n".join(f"{w:.17g}" for w in SPEED))
    same(read_signal(tmp_path / "a.csv", interval="0.1 ms"))


def test_a_remark_of_labview_in_one_row(tmp_path):
    rows = [f"{t:.17g}\t{w:.17g}" for t, w in zip(TIME, SPEED, strict=True)]
    rows[7] += "\tstarted by hand"
    (tmp_path / "a.lvm").write_text("time [s]\tgear_speed [rad/s]\tComment\n" + "\n".join(rows))
    same(read_signal(tmp_path / "a.lvm"))


@pytest.mark.parametrize("unit", ["RPM", "Rpm", "rpm", "rev/min", "r/min", "U/min", "1/min"])
def test_revolutions_per_minute(tmp_path, unit):
    assert from_text(f"60 {unit}", "rad/s") == pytest.approx(2 * math.pi)
    frame = pd.DataFrame({"time [s]": TIME, f"Speed ({unit})": SPEED * 30 / math.pi})
    frame.to_csv(tmp_path / "a.csv", index=False)
    same(read_signal(tmp_path / "a.csv"))


def test_a_record_without_a_number_is_refused(tmp_path):
    pd.DataFrame({"time [s]": TIME, "gear_speed [rad/s]": np.nan}).to_csv(
        tmp_path / "a.csv", index=False, na_rep="nan"
    )
    with pytest.raises(gd.SceneError, match="none of its 400 samples is a number"):
        read_signal(tmp_path / "a.csv")
