"""Scans with the labels of a table, scans that stopped, scars, and files of other programs."""

from __future__ import annotations

import struct
import sys

import numpy as np
import pandas as pd
import pytest

import gearidae as gd
from gearidae.cli import main
from gearidae.surfaces import gaussian_map, read_scan
from gearidae.surfaces.lines import repeated_lines, streaks


@pytest.fixture(scope="module")
def heights():
    return gaussian_map(128, 1e-6, 6e-9, shortest=40e-9, longest=300e-9, seed=1)


def analysed(heights):
    return gd.surface_from(heights, "1 um", "50 nm")


@pytest.mark.parametrize("scale", [1.0, 1e9])
@pytest.mark.parametrize("whole", [False, True])
@pytest.mark.parametrize("options", [{}, {"index": False}, {"header": False}])
def test_labels_of_a_table_are_no_heights(heights, options, scale, whole, tmp_path):
    written = np.round(1e10 * heights).astype(int) if whole else scale * heights
    pd.DataFrame(written).to_csv(tmp_path / "scan.csv", **options)
    with pytest.warns(UserWarning, match=r"scan\.csv: the first (row|column).* left out"):
        scan = read_scan(tmp_path / "scan.csv")
    np.testing.assert_allclose(scan.heights, written, rtol=1e-12)


def test_coordinates_as_labels(heights, tmp_path):
    at = np.arange(128) * 7.8125
    pd.DataFrame(heights, index=at, columns=at + 3.0).to_csv(tmp_path / "scan.csv", sep=";", decimal=",")
    with pytest.warns(UserWarning, match="the first row and the first column are left out"):
        scan = read_scan(tmp_path / "scan.csv")
    np.testing.assert_allclose(scan.heights, heights, rtol=1e-12)


@pytest.mark.parametrize("first", ["sorted", "even", "counted"])
def test_a_map_whose_first_row_rises_stays_whole(heights, first, tmp_path):
    rising = 1e9 * heights
    rising[0] = {"sorted": np.sort(rising[0]), "even": np.linspace(-9, 9, 128), "counted": np.arange(128)}[
        first
    ]
    for name, table in (("row", rising), ("column", rising.T)):
        np.savetxt(tmp_path / f"{name}.csv", table, fmt="%.4f", delimiter=",")
        assert read_scan(tmp_path / f"{name}.csv", "nm").heights.shape == (128, 128)


@pytest.mark.parametrize("kind", ["last", "block", "constant"])
@pytest.mark.parametrize("lines", ["rows", "columns"])
def test_a_scan_that_stopped_is_named_with_its_lines(heights, kind, lines):
    stopped = heights.copy()
    stopped[96:] = {"last": stopped[95], "block": stopped[64:96], "constant": 1e-9}[kind]
    stopped = stopped if lines == "rows" else stopped.T
    assert any(f"32 of 128 {lines} equal another one" in remark for remark in analysed(stopped).remarks)
    assert not any("equal another" in remark for remark in analysed(heights).remarks)


def test_scars_are_named_with_their_number(heights):
    scarred = heights.copy()
    scarred[10:120:11, 20:90] += 20e-9
    remarks = analysed(scarred).remarks
    assert any(remark.startswith("10 of 128 rows have a streak") for remark in remarks)
    assert (
        analysed(scarred).settings["surface.asperity_radius"]
        < analysed(heights).settings["surface.asperity_radius"]
    )


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("waves", [(16e-9, 100e-9), (40e-9, 300e-9), (100e-9, 500e-9)])
def test_random_surfaces_have_neither(seed, waves):
    made = gaussian_map(256, 1e-6, 6e-9, shortest=waves[0], longest=waves[1], seed=seed)
    for heights in (made, made.T, np.round(1e10 * made)):
        assert (streaks(heights), repeated_lines(heights)) == (0, 0)


def gwyddion(heights, *names):
    said = "".join(f"# {name}\n" for name in names)
    return said + "\n".join("\t".join(f"{1e9 * height:.9g}" for height in row) for row in heights)


@pytest.mark.parametrize(
    "names",
    [
        ("Kanal: Höhe", "Breite: 2,00 µm", "Höhe: 1,00 µm", "Einheiten: nm"),
        ("Canal : H", "Largeur: 2 µm", "Hauteur: 1 µm", "Unités: nm"),
    ],
)
def test_headings_of_gwyddion_in_other_languages(heights, names, tmp_path):
    (tmp_path / "scan.txt").write_text(gwyddion(heights, *names), encoding="utf-8")
    scan = read_scan(tmp_path / "scan.txt")
    assert scan.size == pytest.approx((1e-6, 2e-6), rel=1e-12, abs=0)
    np.testing.assert_allclose(scan.heights, heights, rtol=1e-8)


def metropro(heights, step):
    """A file of format 1 as its maker describes it: 834 bytes of header, then heights as whole numbers."""
    header = bytearray(834)
    rows, columns = heights.shape
    struct.pack_into(">IHI", header, 0, 0x881B036F, 1, 834)
    struct.pack_into(">HHHHI", header, 64, 0, 0, columns, rows, 4 * rows * columns)
    scale, wavelength, oblique, resolution = 0.5, 6.328e-7, 1.0, 4096
    struct.pack_into(">f", header, 164, scale)
    struct.pack_into(">f", header, 168, wavelength)
    struct.pack_into(">f", header, 176, oblique)
    struct.pack_into(">f", header, 184, step)
    struct.pack_into(">H", header, 218, 0)
    unit = scale * wavelength * oblique / resolution
    counts = np.round(heights / unit).astype(">i4")
    return bytes(header) + counts.tobytes(), counts * unit


def test_binary_files_of_other_programs(tmp_path):
    pytest.importorskip("SurfaceTopography")
    heights = gaussian_map(64, 64e-6, 75e-9, shortest=4e-6, longest=20e-6, seed=3)
    content, kept = metropro(heights, 1e-6)
    (tmp_path / "scan.dat").write_bytes(content)
    scan = read_scan(tmp_path / "scan.dat")
    assert scan.size == pytest.approx((64e-6, 64e-6), rel=1e-6, abs=0)
    assert np.std(scan.heights) == pytest.approx(np.std(kept), rel=1e-6, abs=0)


def test_text_files_of_other_programs(heights, tmp_path, capsys):
    pytest.importorskip("SurfaceTopography")
    path = tmp_path / "scan.txt"
    path.write_text("of a program\nh=128 w=128\n" + gwyddion(heights))
    np.testing.assert_allclose(read_scan(path, "nm").heights.T, heights, rtol=1e-8)
    with pytest.raises(gd.SceneError, match="does not say in which unit"):
        read_scan(path)
    assert main(["surface", str(path), "--unit", "nm", "--size", "1 um", "--cutoff", "50 nm"]) == 0
    assert f"{1e9 * analysed(heights).settings['surface.roughness']:.3g} nm" in capsys.readouterr().out


@pytest.mark.parametrize("fault", ["1.2.3", "x", ""])
def test_a_fault_within_the_numbers_is_never_read_over(heights, fault, tmp_path):
    """The other library leaves lines out that are no numbers."""
    lines = ("h=128 w=128\n" + gwyddion(heights)).splitlines()
    lines[40] = "\t".join([*lines[40].split("\t")[:-1], fault]).rstrip()
    (tmp_path / "scan.txt").write_text("\n".join(lines))
    with pytest.raises(gd.SceneError, match="no table of heights"):
        read_scan(tmp_path / "scan.txt", "nm")


def test_without_the_library_the_file_of_another_program_is_named_as_such(monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "SurfaceTopography", None)
    (tmp_path / "scan.dat").write_bytes(bytes(range(256)) * 4)
    with pytest.raises(gd.SceneError, match=r"a file of another program.*pip install 'gearidae\[surfaces\]'"):
        read_scan(tmp_path / "scan.dat")


@pytest.mark.parametrize(
    "products", [("-o", "--picture"), ("-o", "--asperities"), ("--picture", "--asperities")]
)
def test_two_products_of_one_name_are_refused(heights, products, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    np.save("scan.npy", heights)
    for other in ("out.png", "./out.png"):
        asked = [
            "surface",
            "scan.npy",
            "--size",
            "1 um",
            "--cutoff",
            "50 nm",
            products[0],
            "out.png",
            products[1],
            other,
        ]
        assert main([*asked, "--overwrite"]) == 2
        assert "named for two products" in capsys.readouterr().err
    assert [entry.name for entry in tmp_path.iterdir()] == ["scan.npy"]


def test_missing_rows_of_a_scan_show_in_the_distance_of_the_points(heights):
    def remarks(rows, size):
        return [
            remark for remark in gd.surface_from(heights[:rows], size, "50 nm").remarks if "apart" in remark
        ]

    assert remarks(128, "1 um") == remarks(80, "1 um") == remarks(80, ("0.625 um", "1 um")) == []
    (remark,) = remarks(80, ("1 um", "1 um"))
    assert remark.startswith("Rows are 12.5 nm apart, points along them 7.81 nm: if rows are missing")
