"""Height maps from files, and the command that reads them."""

from __future__ import annotations

import sys
import tomllib
from types import SimpleNamespace

import numpy as np
import pytest

import gearidae as gd
from gearidae.cli import main
from gearidae.surfaces import gaussian_map, read_scan


@pytest.fixture(scope="module")
def heights():
    made = gaussian_map(128, 1e-6, 5e-9, shortest=40e-9, longest=300e-9, seed=2)
    made[10:13, 20:24] = np.nan
    return made


def test_complex_heights_are_refused(heights, tmp_path):
    """Their imaginary parts would be lost."""
    np.save(tmp_path / "scan.npy", heights + 1j * heights)
    with pytest.raises(gd.SceneError, match="complex numbers"):
        read_scan(tmp_path / "scan.npy")


@pytest.mark.parametrize("separator", [",", ";", "\t", "  "])
def test_tables_in_text(heights, tmp_path, separator):
    path = tmp_path / "scan.csv"
    np.savetxt(path, 1e9 * heights, delimiter=separator, header="heights [nm]\nrows along y")
    scan = read_scan(path, "nm")
    np.testing.assert_allclose(scan.heights, heights, rtol=1e-12, atol=0.0)
    assert scan.size is None


def test_empty_cells_and_separators_at_the_end(tmp_path):
    path = tmp_path / "scan.txt"
    path.write_text("1,2,,\n\n4,nan,6,\n")
    np.testing.assert_array_equal(read_scan(path).heights, [[1, 2, np.nan], [4, np.nan, 6]])


def gwyddion(heights, unit="µm", **sizes):
    """Text as Gwyddion exports it, with the header that is optional there."""
    said = "".join(f"# {name}: {length}\n" for name, length in sizes.items())
    rows = "\n".join("\t".join(f"{height:.9g}" for height in row) for row in heights)
    return f"# Channel: Topography\n{said}# Value units: {unit}\n{rows}\n"


@pytest.mark.parametrize("name", ["scan.txt", "scan.csv", "scan.dat", "scan.asc"])
def test_width_and_unit_in_the_header_are_read(heights, name, tmp_path):
    """A header in micrometres that is not read makes a roughness of millimetres."""
    if name.endswith(".asc"):
        pytest.importorskip("SurfaceTopography")
    path = tmp_path / name
    path.write_text(gwyddion(1e6 * np.nan_to_num(heights), Width="2.0 µm", Height="1.0 µm"), encoding="utf-8")
    scan = read_scan(path)
    transposed = name.endswith(".asc")  # SurfaceTopography's first index is that along a row
    np.testing.assert_allclose(
        scan.heights.T if transposed else scan.heights, np.nan_to_num(heights), rtol=1e-8
    )
    assert scan.size == pytest.approx((2e-6, 1e-6) if transposed else (1e-6, 2e-6), rel=1e-12, abs=0.0)


def test_units_in_a_header_and_beside_it(heights, tmp_path):
    path = tmp_path / "scan.txt"
    path.write_text(gwyddion(1e6 * heights), encoding="utf-8")
    for unit in (None, "um", "µm"):
        scan = read_scan(path, unit)
        assert np.nanstd(scan.heights) == pytest.approx(np.nanstd(heights), rel=1e-8, abs=0.0)
        assert scan.size is None
    with pytest.raises(gd.SceneError, match=r"unit = nm: the heights are in µm, as scan\.txt says"):
        read_scan(path, "nm")
    path.write_text(gwyddion(heights, unit="V"))
    with pytest.raises(gd.SceneError, match="unit = V"):
        read_scan(path)
    path.write_text(gwyddion(heights, Width="much", Height="1 um"))
    with pytest.raises(gd.SceneError, match="has the length much"):
        read_scan(path)
    np.savetxt(path, 1e9 * heights, header="heights [nm]")
    assert np.nanstd(read_scan(path).heights) == pytest.approx(np.nanstd(heights), rel=1e-8, abs=0.0)


def test_decimal_commas_and_carriage_returns(heights, tmp_path):
    path = tmp_path / "scan.txt"
    path.write_bytes(gwyddion(1e6 * heights).replace(".", ",").replace("\n", "\t\r").encode())
    np.testing.assert_allclose(read_scan(path).heights, heights, rtol=1e-8)


def test_a_row_with_another_number_of_cells_is_named(tmp_path):
    path = tmp_path / "scan.txt"
    path.write_text("# a map\n1,2,3\n1,2\n")
    with pytest.raises(gd.SceneError, match="line 3: row 2 has 2 cells, but the first has 3"):
        read_scan(path)


def test_an_array_that_declares_more_than_it_holds_takes_no_memory(tmp_path):
    path = tmp_path / "scan.npy"
    np.save(path, np.zeros((2, 2)))
    for shape, reason in (
        ("(1000000, 1000000)", "no table of heights"),
        ("(20000, 20000)", "has 400000000 points"),
    ):
        header = b"{'descr': '<f8', 'fortran_order': False, 'shape': " + shape.encode() + b", }"
        header = header.ljust(117) + b"\n"
        with path.open("wb") as file:
            file.write(b"\x93NUMPY\x01\x00" + len(header).to_bytes(2, "little") + header)
            file.truncate(4_000_000_000 if "20000," in shape else 1000)
        with pytest.raises(gd.SceneError, match=reason):
            read_scan(path)


@pytest.mark.parametrize("factor", [1e3, 1e6, 1e9])
def test_heights_in_another_unit_than_metres_are_refused(heights, factor):
    """Their slopes are above 10; in nanometres, micrometres and millimetres."""
    with pytest.raises(gd.SceneError, match="slopes above 10 come from a wrong unit"):
        gd.surface_from(factor * heights, "1 um")


def test_numpy_files(heights, tmp_path):
    np.save(tmp_path / "scan.npy", heights)
    np.testing.assert_array_equal(read_scan(tmp_path / "scan.npy").heights, heights)


class Other:
    """What SurfaceTopography's topographies answer, as its documentation has it."""

    def __init__(self, heights, sizes, unit):
        self._heights, self.physical_sizes, self.unit = heights, sizes, unit

    def to_unit(self, unit):
        factor = {"um": 1e-6, "m": 1.0}[self.unit] / {"m": 1.0}[unit]
        return Other(self._heights * factor, tuple(factor * size for size in self.physical_sizes), unit)

    def heights(self):
        return self._heights


def test_formats_of_microscopes(monkeypatch, tmp_path):
    path = tmp_path / "scan.ibw"
    path.write_bytes(b"not for us")
    masked = np.ma.masked_greater(np.arange(12.0).reshape(3, 4), 10.0)
    module = SimpleNamespace(read_topography=lambda name: Other(masked, (3.0, 8.0), "um"))
    monkeypatch.setitem(sys.modules, "SurfaceTopography", module)
    scan = read_scan(path)
    assert scan.size == pytest.approx((3e-6, 8e-6))
    assert scan.heights[1, 1] == pytest.approx(5e-6)
    assert np.isnan(scan.heights[2, 3])
    with pytest.raises(gd.SceneError, match="carries its own"):
        read_scan(path, "nm")
    monkeypatch.setitem(sys.modules, "SurfaceTopography", None)
    with pytest.raises(gd.SceneError, match=r"pip install 'gearidae\[surfaces\]'"):
        read_scan(path)


def test_a_scan_without_units(monkeypatch, tmp_path, heights):
    """Such as those of profilers: extent and unit are the user's."""

    def read_topography(name, physical_sizes=None):
        if physical_sizes is None:
            raise ValueError("`physical_sizes` could not be extracted from file, you must provide it.")
        return Other(1e9 * np.nan_to_num(heights), physical_sizes, None)

    monkeypatch.setitem(sys.modules, "SurfaceTopography", SimpleNamespace(read_topography=read_topography))
    (tmp_path / "scan.asc").write_text("not for us")
    scan = read_scan(tmp_path / "scan.asc", "nm")
    np.testing.assert_allclose(scan.heights, np.nan_to_num(heights), rtol=1e-12)
    assert scan.size is None
    with pytest.raises(gd.SceneError, match="does not say in which unit"):
        read_scan(tmp_path / "scan.asc")
    assert (
        main(["surface", str(tmp_path / "scan.asc"), "--unit", "nm", "--size", "1 um", "--cutoff", "60 nm"])
        == 0
    )


def test_surface_topography_itself(heights, tmp_path):
    """With the library installed: a file of its own, heights in nanometres over micrometres."""
    library = pytest.importorskip("SurfaceTopography")
    path = tmp_path / "scan.nc"
    whole = np.nan_to_num(heights)
    library.Topography(1e6 * whole, (2.0, 1.0), unit="um").to_netcdf(str(path))
    scan = read_scan(path)
    assert scan.size == pytest.approx((2e-6, 1e-6))
    np.testing.assert_allclose(scan.heights, whole, rtol=1e-9, atol=1e-24)
    np.savetxt(tmp_path / "bare.asc", 1e9 * whole)
    scan = read_scan(tmp_path / "bare.asc", "nm")
    assert scan.size is None
    np.testing.assert_allclose(scan.heights.T, whole, rtol=1e-9, atol=1e-24)


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [("a.csv", "1,2\n3,four\n", "no table"), ("a.npy", "x", "no table"), ("a.txt", "", "no table")],
)
def test_files_that_are_no_maps(tmp_path, name, text, message):
    path = tmp_path / name
    path.write_text(text)
    with pytest.raises(gd.SceneError, match=message):
        read_scan(path)


def test_command(heights, tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    np.save("scan.npy", 1e9 * heights)
    asked = ["surface", "scan.npy", "--unit", "nm", "--size", "1 um"]
    assert main([*asked, "--picture", "scan.png"]) == 0
    out = capfd.readouterr().out
    assert "choose one with --cutoff" in out
    assert "Note: 1 hole" in out
    assert main([*asked, "-o", "part.toml"]) == 2
    assert "--cutoff" in capfd.readouterr().err
    assert main([*asked, "--cutoff", "60 nm", "-o", "part.toml"]) == 0
    measured = gd.surface_from(heights, "1 um", "60 nm", source="scan.npy")
    written = tomllib.loads((tmp_path / "part.toml").read_text())["surface"]
    assert set(written) == {key.removeprefix("surface.") for key in measured.settings}
    assert f"> {60:g} nm" in capfd.readouterr().out
    assert main([*asked, "--cutoff", "60 nm", "-o", "part.toml"]) == 2
    assert main([*asked, "--cutoff", "60 nm", "-o", "mine.toml", "--case", "roller_slow"]) == 0
    surface = gd.load_case("mine.toml").surface
    assert surface.roughness == pytest.approx(measured.settings["surface.roughness"], rel=1e-3)
    assert surface.provenance == written["provenance"]
    assert main(["surface", "scan.npy"]) == 2
    assert "--size" in capfd.readouterr().err


def test_lines_of_a_scan_are_aligned(heights, tmp_path, monkeypatch, capfd):
    """Also those of SurfaceTopography, whose first index runs along a line."""
    monkeypatch.chdir(tmp_path)
    lines = np.nan_to_num(heights) + 2e-9 * np.random.default_rng(1).standard_normal(128)[:, None]
    np.save("scan.npy", lines)
    fake = SimpleNamespace(read_topography=lambda name: Other(1e6 * lines.T, (1.0, 1.0), "um"))
    monkeypatch.setitem(sys.modules, "SurfaceTopography", fake)
    (tmp_path / "scan.ibw").write_bytes(b"not for us")
    for name, size in (("scan.npy", ["--size", "1 um"]), ("scan.ibw", [])):
        assert main(["surface", name, *size, "--cutoff", "60 nm"]) == 0
        assert "Note: Line noise: rows are offset against each other by" in capfd.readouterr().out
        assert main(["surface", name, *size, "--cutoff", "60 nm", "--align-rows", "-o", f"{name}.toml"]) == 0
        printed = capfd.readouterr().out
        assert "Line noise" not in printed
        assert "count from the summits' mean plane" in printed
        assert "; rows aligned" in (tmp_path / f"{name}.toml").read_text()
    assert main(["surface", "scan.ibw", "--size", "1.1 um"]) == 0
    assert "the file states an extent of 1 um, 1 um; --size replaces it" in capfd.readouterr().out


def test_picture_shows_both_ways(heights):
    measured = gd.surface_from(heights, "1 um", "60 nm")
    figure = gd.plot.surface(measured.statistics, measured.cutoff)
    for ax, name in zip(figure.axes, ("roughness", "asperity_density", "asperity_radius"), strict=True):
        summits, moments, mark = ax.get_lines()
        factor = 1e-12 if name == "asperity_density" else 1.0
        np.testing.assert_allclose(summits.get_ydata(), factor * measured.statistics[name].sel(by="summits"))
        np.testing.assert_allclose(moments.get_ydata(), factor * measured.statistics[name].sel(by="moments"))
        assert summits.get_linestyle() != moments.get_linestyle()
        assert mark.get_xdata()[0] == measured.cutoff
    with pytest.raises(gd.SceneError, match="is missing"):
        gd.plot.surface(measured.statistics.drop_vars("roughness"))
