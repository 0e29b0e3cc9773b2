"""Summits of a scan as a list of asperities: where they are, and what a scene reads back."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

import gearidae as gd
from gearidae.cli import main
from gearidae.populations.flanks import flanks_of

GEARS = gd.preset("teodorescu2009").replace({"contact.roughness": "discrete"})
ROLLER = gd.preset("roller_fast").replace({"contact.roughness": "discrete"})


@pytest.fixture(scope="module")
def heights():
    return gd.surfaces.gaussian_map(256, 4e-6, 6e-9, shortest=100e-9, longest=500e-9, seed=2)


def test_places_heights_and_radii_of_an_egg_box():
    """Maxima of cos(pi (2 n + 1) x / L) products lie at whole waves, half a point of the grid from its middle."""
    y, x = np.meshgrid(*2 * [(np.arange(200) + 0.5) / 200], indexing="ij")
    egg_box = 3e-9 * np.cos(14 * np.pi * y) * np.cos(12 * np.pi * x)
    asperities = gd.surface_from(egg_box, "1 um", cutoff="90 nm").asperities
    assert_allclose(asperities.height, 0.0, atol=1e-11)
    # curvature is taken out of the map: a paraboloid of a hundredth of its height bends the tips by less than 2 %
    assert_allclose(asperities.radius, 1.0 / (1.5e-9 * np.pi**2 * (14**2 + 12**2) / 1e-12), rtol=0.02)
    for name, waves in (("along", 12), ("across", 14)):
        places = np.unique(np.round(asperities[name].values * 1e12)) * 1e-12
        steps = np.diff(places)
        assert_allclose(steps[steps > 1e-8], 1e-6 / waves, rtol=0.02)
    assert (np.diff(asperities.along.values) >= 0.0).all()


def test_a_list_has_the_statistics_of_its_scan(heights):
    surface = gd.surface_from(heights, "4 um", cutoff="120 nm")
    at, ds = surface.statistics.sel(cutoff=surface.cutoff, by="summits"), surface.asperities
    assert ds.sizes["asperity"] == int(at.summit_count) > 300
    assert float(ds.height.std(ddof=1)) == pytest.approx(float(at.roughness), rel=1e-12, abs=0)
    assert float(1.0 / (1.0 / ds.radius).mean()) == pytest.approx(float(at.asperity_radius), rel=1e-12, abs=0)
    area = ds.attrs["length"] * ds.attrs["width"]
    assert ds.sizes["asperity"] / area == pytest.approx(float(at.asperity_density), rel=1e-12)
    for name, side in (("along", "length"), ("across", "width")):
        assert 0.0 <= float(ds[name].min()) < float(ds[name].max()) <= ds.attrs[side]


@pytest.mark.parametrize(("scene", "name"), [(GEARS, "arc"), (ROLLER, "x")])
def test_a_scene_reads_what_the_command_writes(scene, name, heights, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    np.save("scan.npy", heights)
    (tmp_path / "own.toml").write_text(gd.dump_case(scene), encoding="utf-8")
    options = ["--size", "4 um", "--cutoff", "120 nm", "--asperities", "list.csv"]
    if name == "x":
        options += ["--case", "own.toml", "-o", "rough.toml"]
    assert main(["surface", "scan.npy", *options]) == 0
    assert "beyond touch nothing" in capsys.readouterr().out
    asperities = gd.surface_from(heights, "4 um", cutoff="120 nm").asperities
    made = scene.replace({"contact.asperities": {"file": "list.csv"}})
    flank = flanks_of(made)[0]
    middle = 0.5 * asperities.attrs["length"] if name == "x" else 0.0
    assert_allclose(flank.arc, asperities.along - middle, rtol=1e-8, atol=1e-15)
    assert_allclose(flank.height, asperities.height, rtol=1e-8, atol=1e-18)
    assert_allclose(flank.radius, asperities.radius, rtol=1e-8)


def test_a_list_needs_a_cutoff_and_one_flank(heights, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    np.save("scan.npy", heights)
    usual = ["surface", "scan.npy", "--size", "4 um", "--asperities", "list.csv"]
    assert main(usual) == 2
    assert main([*usual, "--cutoff", "120 nm", "--both-flanks"]) == 2
    assert not (tmp_path / "list.csv").exists()
    with pytest.raises(gd.SceneError, match="cutoff"):
        gd.surface_from(heights, "4 um").asperity_list()
