"""Measured surfaces: asperities of a Gaussian surface of known spectrum; tilt, holes, heights that are not Gaussian."""

from __future__ import annotations

import math
import tomllib

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import integrate

import gearidae as gd
from gearidae.surfaces import from_moments, gaussian_map, surface_from
from gearidae.surfaces.filtering import band_limited, cosine_sum
from gearidae.surfaces.height_map import height_map
from gearidae.surfaces.statistics import statistics
from gearidae.surfaces.summits import find_summits

SIZE, POINTS = 4e-6, 384
SHORTEST, LONGEST, HURST, RMS = 40e-9, 300e-9, 0.8, 6e-9
SCENE = gd.preset("teodorescu2009_low_speed")


@pytest.fixture(scope="module")
def heights():
    return gaussian_map(POINTS, SIZE, RMS, shortest=SHORTEST, longest=LONGEST, hurst=HURST, seed=3)


def bent(heights):
    """The same heights on a tilted, bent sample, far above its roughness."""
    y, x = np.mgrid[0 : len(heights), 0 : len(heights)] / len(heights)
    return heights + 3e-7 * x - 1e-7 * y + 4e-7 * x * y - 2e-7 * x * x


def analysed(heights, size=(SIZE, SIZE), cutoff=60e-9):
    """One cut-off alone, which is quicker."""
    return statistics(height_map(heights, size), np.array([cutoff])).isel(cutoff=0)


def exact_moments(cutoff):
    """Moments of a profile: of an isotropic surface, m2 is half and m4 three eighths of those in the plane."""
    low, high = 2 * math.pi / LONGEST, 2 * math.pi / SHORTEST
    stop = min(high, 2 * math.pi / cutoff)

    def moment(power, end):
        return integrate.quad(lambda log: math.exp((power - 2 * HURST) * log), math.log(low), math.log(end))[
            0
        ]

    scale = RMS**2 / moment(0, high)
    return tuple(factor * scale * moment(power, stop) for power, factor in ((0, 1.0), (2, 0.5), (4, 0.375)))


@pytest.mark.parametrize("cutoff", [25e-9, 60e-9, 100e-9])
def test_gaussian_surface_has_its_analytic_moments_and_asperities(heights, cutoff):
    surface = surface_from(bent(heights), SIZE, cutoff)
    at = surface.statistics.sel(cutoff=cutoff)
    exact = exact_moments(cutoff)
    # 24 maps of this kind scatter by 4 to 5 % in m0, which some (4000/300)^2 = 180 longest waves make up, by 1.4 to
    # 3.4 % in m2, 0.8 to 3 % in m4, 3 to 4 % in the roughness, about the exact values within 1 %: three times that.
    for name, value, allowed in zip(("m0", "m2", "m4"), exact, (0.15, 0.1, 0.09), strict=True):
        assert_allclose(float(at[name]), value, rtol=allowed, atol=0.0, err_msg=name)
    wanted = from_moments(*exact)
    # n summits are counted to about 1/sqrt(n), their curvatures averaged likewise; the grid adds 1 %.
    counted = 3.0 / math.sqrt(float(at["summit_count"])) + 0.01
    for way in ("summits", "moments"):
        chosen = at.sel(by=way)
        assert_allclose(float(chosen["roughness"]), wanted.roughness, rtol=0.12, atol=0.0)
        assert_allclose(float(chosen["asperity_density"]), wanted.density, rtol=counted, atol=0.0)
        assert_allclose(float(chosen["asperity_radius"]), wanted.radius, rtol=counted, atol=0.0)
    assert not any("Gaussian" in remark or "direction" in remark for remark in surface.remarks)


def test_two_ways_agree_closer_than_either_with_the_ensemble(heights):
    """Both see the same map, so that its longest waves cancel: what is left is counting and the grid."""
    at = analysed(heights)
    assert at["summit_count"] > 1000
    for name in ("roughness", "asperity_density", "asperity_radius"):
        assert_allclose(float(at[name][0]), float(at[name][1]), rtol=0.05, atol=0.0, err_msg=name)


def test_tilt_and_curvature_change_nothing(heights):
    plain, sloping = analysed(heights), analysed(bent(heights))
    for name in ("m0", "m2", "m4", "roughness", "asperity_radius"):
        assert_allclose(sloping[name], plain[name], rtol=1e-9, atol=0.0)
    # in lengths: along x the slope is 3e-7 + 4e-7 y - 4e-7 x over 4 um, in the middle 0.075; along y 0.025
    surface = height_map(bent(np.zeros_like(heights)) + heights, (SIZE, SIZE))
    assert surface.tilt == pytest.approx(math.hypot(0.075, 0.025), rel=0.02)
    matrix = np.array([[0.0, 4e-7], [4e-7, -4e-7]]) / SIZE**2
    assert surface.curvature == pytest.approx(np.abs(np.linalg.eigvalsh(matrix)).max(), rel=0.05)


def test_holes_are_named_and_hardly_matter(heights):
    holed = heights.copy()
    holed[50:70, 100:150] = np.nan
    holed[250, :7] = np.nan
    holed[300, 350] = np.nan
    surface = surface_from(holed, SIZE, 60e-9)
    assert surface.statistics.attrs["holes"] == 3
    assert surface.remarks[0].startswith("3 holes (0.68 % of the points)")
    whole = analysed(heights)
    for name in ("m0", "m2", "m4", "roughness", "asperity_density", "asperity_radius"):
        # 2 % of the area is not counted, and differs from the rest as much as such a part does
        ours = surface.statistics[name].sel(cutoff=60e-9)
        assert_allclose(ours, whole[name], rtol=0.02, atol=0.0, err_msg=name)
    masked = analysed(np.ma.masked_invalid(holed))
    assert masked["m4"] == surface.statistics["m4"].sel(cutoff=60e-9)


def test_what_was_filled_is_not_counted(heights):
    """A membrane over a sixth of the map is smooth: counted, it would lower curvature and density by so much."""
    holed = heights.copy()
    holed[110:265, 110:265] = np.nan
    ours, whole = analysed(holed), analysed(heights)
    for name in ("m4", "asperity_density"):
        # less area, of which 1,500 summits are left: 3 % each
        assert_allclose(ours[name], whole[name], rtol=0.06, atol=0.0, err_msg=name)


def test_filled_heights_solve_laplaces_equation():
    """Of a harmonic function nothing is lost: it is its own membrane, on the grid as well for these."""
    y, x = np.mgrid[0:80, 0:64] - 30.0
    harmonic = 1e-9 * (x**3 - 3 * x * y**2)
    holed = harmonic.copy()
    holed[20:40, 10:30] = np.nan
    surface = height_map(holed, (80e-9, 64e-9))
    fitted = height_map(np.where(np.isnan(holed), harmonic, holed), (80e-9, 64e-9))
    inside = surface.heights - fitted.heights  # both lack a paraboloid, not quite the same one
    middle = inside[21:39, 11:29]
    neighbours = inside[20:38, 11:29] + inside[22:40, 11:29] + inside[21:39, 10:28] + inside[21:39, 12:30]
    assert np.abs(4 * middle - neighbours).max() < 1e-3 * np.abs(surface.heights).max()


def test_cosines_and_their_derivatives():
    """Sums of cosines are evaluated exactly, their derivatives too; waves beyond the cut-off are gone."""
    size = (2e-6, 3e-6)
    rows, columns = ((np.arange(count) + 0.5) / count for count in (90, 120))
    long = np.cos(3 * np.pi * rows)[:, None] * np.cos(4 * np.pi * columns)
    short = np.cos(40 * np.pi * rows)[:, None] * np.ones(120)  # wavelength 0.1 um
    field = band_limited(cosine_sum(5e-9 * long + 2e-9 * short), size, 0.15e-6)
    y, x = ((np.arange(count) + 0.5) / count for count in field.heights.shape)
    cosines = np.cos(3 * np.pi * y)[:, None], np.cos(4 * np.pi * x)[None, :]
    sines = np.sin(3 * np.pi * y)[:, None], np.sin(4 * np.pi * x)[None, :]
    kept = 5e-9 * cosines[0] * cosines[1]
    assert_allclose(field.heights, kept, rtol=0.0, atol=1e-20)
    q = 3 * np.pi / size[0], 4 * np.pi / size[1]
    assert_allclose(field.slopes[0], -5e-9 * q[0] * sines[0] * cosines[1], rtol=0.0, atol=1e-13)
    assert_allclose(field.slopes[1], -5e-9 * q[1] * cosines[0] * sines[1], rtol=0.0, atol=1e-13)
    assert_allclose(field.curvature, -(q[0] ** 2 + q[1] ** 2) * kept, rtol=0.0, atol=1e-5)


def test_summits_of_an_egg_box():
    """Between the points of the grid, where the maxima of a product of cosines are."""
    size, cutoff = (1e-6, 1e-6), 0.1e-6
    y, x = np.meshgrid(*2 * [(np.arange(200) + 0.5) / 200], indexing="ij")
    field = band_limited(cosine_sum(3e-9 * np.cos(14 * np.pi * y) * np.cos(12 * np.pi * x)), size, cutoff)
    wanted = np.zeros(field.heights.shape, dtype=bool)
    wanted[4:-4, 4:-4] = True
    summits = find_summits(field, wanted)
    # cos cos is largest where both are 1 or both -1
    assert len(summits.heights) == sum((i + j) % 2 == 0 for i in range(1, 14) for j in range(1, 12))
    # one Newton step and a cubic spline over seven points a wave: errors of the fourth order in half a point
    assert_allclose(summits.heights, 3e-9, rtol=2e-3, atol=0.0)
    assert_allclose(summits.curvatures, 1.5e-9 * np.pi**2 * (14**2 + 12**2) / 1e-12, rtol=1e-2, atol=0.0)


def test_formulas_at_the_limit_of_narrow_bands():
    """One wavelength alone: alpha = 1.5, and Nayak's summits are as high as the formula says."""
    q, m0 = 2 * math.pi / 1e-7, 1e-17
    asperities = from_moments(m0, m0 * q**2 / 2, 3 * m0 * q**4 / 8)
    assert asperities.roughness == pytest.approx(math.sqrt((1 - 0.8968 / 1.5) * m0), rel=1e-12, abs=0)
    assert asperities.density == pytest.approx(q**2 / (8 * math.pi * math.sqrt(3)), rel=1e-12)
    assert asperities.radius == pytest.approx(math.sqrt(3 * math.pi / (8 * m0)) / q**2, rel=1e-12, abs=0)
    assert all(math.isnan(number) for number in from_moments(m0, 0.0, 1.0))


def test_settings_go_into_a_scene_and_a_case_file(heights, tmp_path):
    surface = surface_from(heights, SIZE, "60 nm", source="wafer 7.npy")
    scene = SCENE.replace(surface.settings)
    at = surface.statistics.sel(cutoff=60e-9, by="summits")
    assert scene.surface.roughness == pytest.approx(float(at["roughness"]), rel=5e-4)
    assert scene.surface.asperity_density == pytest.approx(float(at["asperity_density"]), rel=5e-4)
    assert scene.surface.provenance.startswith(
        "wafer 7.npy: 384 x 384 points, 4 um x 4 um; cut-off wavelength 60 nm"
    )
    fragment = tomllib.loads(surface.fragment())
    assert SCENE.replace({f"surface.{key}": value for key, value in fragment["surface"].items()}) == scene
    path = tmp_path / "case.toml"
    path.write_text(gd.dump_case(scene), encoding="utf-8")
    assert gd.load_case(path) == scene
    assert "by moments" in surface_from(heights, SIZE, "60 nm", by="moments").provenance


def test_two_rough_flanks_are_one_rougher_one(heights):
    """Twice the moments: McCool's numbers of the sum of two independent surfaces."""
    both = surface_from(heights, SIZE, 60e-9, by="moments", both_flanks=True)
    at = both.statistics.sel(cutoff=60e-9)
    wanted = from_moments(*(2 * float(at[name]) for name in ("m0", "m2", "m4")))
    assert both.settings["surface.roughness"] == pytest.approx(wanted.roughness, rel=1e-3)
    assert both.settings["surface.asperity_density"] == pytest.approx(wanted.density, rel=1e-3)
    assert both.settings["surface.asperity_radius"] == pytest.approx(wanted.radius, rel=1e-3)
    assert "both flanks" in both.provenance


def test_heights_that_are_not_gaussian_are_named(heights):
    worn = np.minimum(heights, 0.3 * RMS)  # plateaus, as after running in
    surface = surface_from(worn, SIZE, 60e-9)
    (remark,) = (text for text in surface.remarks if "not Gaussian" in text)
    assert f"skewness {float(surface.statistics.summit_skewness.sel(cutoff=60e-9)):.2f}" in remark
    ground = gaussian_map(256, 2e-6, RMS, shortest=SHORTEST, longest=LONGEST, seed=1)
    grooved = surface_from(ground[:, ::2].repeat(2, axis=1)[:, :128].repeat(2, axis=1), 2e-6, 60e-9)
    assert any("has a direction" in text for text in grooved.remarks)


def test_few_summits_are_named(heights):
    small = surface_from(heights[:64, :64], SIZE / 6, 60e-9)
    assert any(text.startswith("Only") for text in small.remarks)


def test_maps_that_are_not_square(heights):
    """A single size is that of a row; the points are as far apart along the other index."""
    part = heights[:192]
    first, second = surface_from(part, SIZE), analysed(part, (SIZE / 2, SIZE), 0.1e-6)
    assert first.statistics.attrs["size"] == second.attrs["size"]
    turned = analysed(part.T, (SIZE, SIZE / 2), 0.1e-6)
    for name in ("m0", "m2", "m4", "roughness", "asperity_density", "asperity_radius", "anisotropy"):
        assert_allclose(turned[name], second[name], rtol=1e-9, atol=0.0)
    with pytest.raises(gd.SceneError, match="choose a cut-off"):
        _ = first.settings


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"size": "4 kg"}, "does not fit"),
        ({"size": -1.0}, "must lie in 1e-12..1 m"),
        ({"size": (1e-6, 1e-6, 1e-6)}, "one length or two"),
        ({"cutoff": "1 nm"}, "two points of the map"),
        ({"cutoff": "1 um"}, "an eighth"),
        ({"by": "magic"}, "summits or moments"),
        ({"heights": np.zeros((20, 20))}, "at least 64"),
        ({"heights": np.ones((64, 64))}, "no roughness"),
        ({"heights": np.full((64, 64), np.inf)}, "finite"),
        ({"heights": np.full((64, 64), np.nan)}, "missing"),
        ({"heights": "wafer"}, "array of numbers"),
        ({"heights": np.random.default_rng(1).normal(size=(64, 64))}, "metres"),
    ],
)
def test_what_cannot_be_analysed_is_named(heights, change, message):
    arguments = {"heights": heights, "size": SIZE, "cutoff": None} | change
    with pytest.raises(gd.SceneError, match=message):
        surface_from(arguments.pop("heights"), arguments.pop("size"), **arguments)


def test_the_summits_lie_above_the_surface(heights):
    """Nayak: 4 sqrt(m0/(pi alpha)) above its mean plane. By counting, 3,000 summits of 6 nm: to some per cent."""
    for cutoff in (40e-9, 60e-9, 100e-9):
        at = surface_from(bent(heights), SIZE, cutoff).statistics.sel(cutoff=cutoff)
        exact = 4.0 * np.sqrt(at.m0 / (np.pi * at.bandwidth))
        assert float(at.summit_plane.sel(by="moments")) == pytest.approx(float(exact), rel=1e-12, abs=0)
        assert float(at.summit_plane.sel(by="summits")) == pytest.approx(float(exact), rel=0.05, abs=0)
    assert from_moments(*exact_moments(cutoff)).plane == pytest.approx(float(exact), rel=0.05, abs=0)
    surface = surface_from(heights, SIZE, 60e-9)
    assert "initial.gap and mesh.backlash count from the summits' mean plane" in surface.planes
    assert surface.planes in surface.fragment()


@pytest.fixture(scope="module")
def clean(heights):
    return surface_from(heights, SIZE, 60e-9).statistics.sel(cutoff=60e-9, by="summits")


@pytest.mark.parametrize(
    ("noise", "holed"),
    [
        (0.3e-9, True),
        *(
            pytest.param(*pair, marks=pytest.mark.by_hand)
            for pair in [(0.3e-9, False), (1e-9, False), (1e-9, True), (5e-9, False), (5e-9, True)]
        ),
    ],
)
def test_lines_with_offsets_are_named_and_aligned(heights, clean, noise, holed):
    offsets = noise * np.random.default_rng(5).standard_normal(POINTS)[:, None]
    scan = bent(heights) + offsets
    if holed:
        scan[100] = scan[200:204, 50:90] = np.nan
    surface = surface_from(scan, SIZE, 60e-9)
    (remark,) = (text for text in surface.remarks if text.startswith("Line noise: rows"))
    assert surface.statistics.attrs["line_noise"][0] == pytest.approx(noise, rel=0.25, abs=0)
    assert "--align-rows" in remark
    aligned = surface_from(scan, SIZE, 60e-9, align_rows=True)
    assert not any(text.startswith("Line noise") for text in aligned.remarks)
    assert aligned.provenance.endswith("; rows aligned")
    for name in ("roughness", "asperity_density", "asperity_radius"):
        # the medians of 384 differences, of which some 60 are independent, leave a tenth of their spread
        assert float(aligned.statistics[name].sel(cutoff=60e-9, by="summits")) == pytest.approx(
            float(clean[name]), rel=0.05, abs=0
        )
    other = surface_from(scan.T, SIZE, 60e-9)
    assert any(text.startswith("Line noise: columns") for text in other.remarks)


def test_surfaces_without_line_noise_are_not_said_to_have_it(heights):
    rng = np.random.default_rng(6)
    wide = gaussian_map(POINTS, SIZE, RMS, shortest=SHORTEST, longest=3.9e-6, seed=7)
    groove = 6e-9 * np.sin(np.arange(POINTS) / 6)[:, None]
    for scan in (heights, wide, heights + groove, heights + 1e-9 * rng.standard_normal(heights.shape)):
        assert height_map(bent(scan), (SIZE, SIZE)).line_noise == (0.0, 0.0)
