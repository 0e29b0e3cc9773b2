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


def test_surface_topography_itself(heights, tmp_path):
    """With the library installed: a file of its own, heights in nanometres over micrometres."""
    library = pytest.importorskip("SurfaceTopography")
    path = tmp_path / "scan.nc"
    whole = np.nan_to_num(heights)
    library.Topography(1e6 * whole, (2.0, 1.0), unit="um").to_netcdf(str(path))
    scan = read_scan(path)
    assert scan.size == pytest.approx((2e-6, 1e-6))
    np.testing.assert_allclose(scan.heights, whole, rtol=1e-9, atol=1e-24)


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
    found = gd.surface_from(heights, "1 um", "60 nm", source="scan.npy")
    written = tomllib.loads((tmp_path / "part.toml").read_text())["surface"]
    assert set(written) == {key.removeprefix("surface.") for key in found.settings}
    assert f"> {60:g} nm" in capfd.readouterr().out
    assert main([*asked, "--cutoff", "60 nm", "-o", "part.toml"]) == 2
    assert main([*asked, "--cutoff", "60 nm", "-o", "mine.toml", "--case", "roller_slow"]) == 0
    surface = gd.load_case("mine.toml").surface
    assert surface.roughness == pytest.approx(found.settings["surface.roughness"], rel=1e-3)
    assert surface.provenance == written["provenance"]
    assert main(["surface", "scan.npy"]) == 2
    assert "--size" in capfd.readouterr().err


def test_picture_shows_both_ways(heights):
    found = gd.surface_from(heights, "1 um", "60 nm")
    figure = gd.plot.surface(found.statistics, found.cutoff)
    for ax, name in zip(figure.axes, ("roughness", "asperity_density", "asperity_radius"), strict=True):
        summits, moments, mark = ax.get_lines()
        factor = 1e-12 if name == "asperity_density" else 1.0
        np.testing.assert_allclose(summits.get_ydata(), factor * found.statistics[name].sel(by="summits"))
        np.testing.assert_allclose(moments.get_ydata(), factor * found.statistics[name].sel(by="moments"))
        assert summits.get_linestyle() != moments.get_linestyle()
        assert mark.get_xdata()[0] == found.cutoff
    with pytest.raises(gd.SceneError, match="is missing"):
        gd.plot.surface(found.statistics.drop_vars("roughness"))
