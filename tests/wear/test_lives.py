"""Lives of an ensemble: each as if it were alone, resumed, and the share of gears that still turn."""

import numpy as np
import pytest
import xarray as xr

import gearidae as gd

LOW = gd.preset("teodorescu2009_low_speed").replace({"coating.sam_fraction": 0.7})
LAW = gd.wear.loss_law("adhesion_work", energy=1e-6)
SHORT = {"cycles": 2, "settle": 1, "starts": 1, "places": 2, "fraction": 0.695, "tolerance": 1e-2}
VARY = {"drive.torque": "uniform(4e-18, 5e-18)"}


def test_a_member_is_the_life_of_its_scene(tmp_path):
    path = tmp_path / "lives.nc"
    ds = gd.studies.lives(LOW, LAW, VARY, 2, seed=1, archive=path, jobs=1, **SHORT)
    assert ds.torque.dims == ("member",)
    assert set(ds.ending.values) == {"coverage"}
    assert np.isnan(ds.passages_to_sticking).all()
    np.testing.assert_allclose(ds.final_coverage, SHORT["fraction"], rtol=1e-6)
    life = gd.studies.life(LOW.replace({"drive.torque": float(ds.torque[1])}), LAW, frequency=False, **SHORT)
    assert float(ds.passages_turning[1]) == float(life.passages[-1])
    with xr.open_dataset(path) as kept:
        xr.testing.assert_equal(kept.load().drop_vars("message"), ds.drop_vars("message"))


def test_parameters_of_the_law_are_drawn(tmp_path):
    """Of one scene lives last in proportion to the law's energy, and shorter by Arrhenius' factor."""
    hot = gd.wear.Arrhenius(LAW, activation_energy="0.1 eV", activation_volume=0.0, temperature="300 K")
    vary = {"law.energy": "uniform(1e-6, 3e-6)", "law.temperature": "uniform(280 K, 400 K)"}
    path = tmp_path / "lives.nc"
    ds = gd.studies.lives(LOW, hot, vary, 2, archive=path, jobs=1, **SHORT)
    assert ds.energy.attrs == {"units": "J/m^2", "long_name": "law.energy"}
    factor = np.exp(
        -gd.wear.Arrhenius(LAW, "0.1 eV", 0.0, 1.0).activation_energy / (1.380649e-23 * ds.temperature)
    )
    scaled = ds.passages_turning / ds.energy * factor
    np.testing.assert_allclose(scaled, scaled[0], rtol=1e-4)  # last digits of the states
    assert abs(float(ds.energy[1] / ds.energy[0]) - 1.0) > 0.1
    xr.testing.assert_equal(gd.studies.open_lives(path).drop_vars("message"), ds.drop_vars("message"))


@pytest.mark.parametrize("jobs", [1, 2])
def test_refused_lives_leave_nothing(jobs, tmp_path):
    with pytest.raises(gd.SceneError, match="fraction"):
        gd.studies.lives(
            LOW, LAW, VARY, 2, archive=tmp_path / "out.nc", jobs=jobs, **{**SHORT, "fraction": 2.0}
        )
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("vary", "key", "words"),
    [
        ({"law.energie": "normal(1, 0.1)"}, "law.energie", "did you mean law.energy"),
        ({"law.energy": "normal(1 m, 0.1)"}, "law.energy", "does not fit"),
        ({"law.energy": "uniform(-1, 1)"}, "law.energy", "drawn from uniform"),
        ({"law.name": "uniform(0, 1)"}, "law.name", "is no parameter"),
        ({"law.energy": 3.0}, "law.energy", "scipy.stats"),
    ],
)
def test_draws_of_the_law_are_checked(vary, key, words):
    with pytest.raises(gd.SceneError, match=words) as error:
        gd.studies.lives(LOW, LAW, vary, 4)
    assert error.value.key == key


def test_other_files_hold_no_lives(tmp_path, known):
    path = tmp_path / "other.nc"
    known.to_netcdf(path)
    with pytest.raises(gd.SceneError, match=r"other\.nc.*is no ensemble of lives"):
        gd.studies.open_lives(path)


def test_a_setting_that_there_is_not():
    with pytest.raises(gd.SceneError, match="tolerance") as error:
        gd.studies.lives(LOW, LAW, VARY, 2, tolerence=1e-3)
    assert error.value.key == "tolerence"


@pytest.fixture
def known():
    """Three gears that stick, one that was followed until 2.5, and one that failed."""
    return xr.Dataset(
        {
            "passages_to_sticking": ("member", [1.0, 2.0, 3.0, np.nan, np.nan]),
            "passages_turning": ("member", [0.9, 1.9, 2.9, 2.5, np.nan]),
            "sticks": ("member", [1.0, 1.0, 1.0, 0.0, np.nan]),
        }
    )


def test_the_share_that_still_turns(known):
    """Kaplan and Meier: 3/4 of four, 2/3 of these three, none of the one that is left."""
    surviving = gd.studies.surviving_share(known)
    np.testing.assert_array_equal(surviving.passages, [0.0, 1.0, 2.0, 3.0])
    np.testing.assert_allclose(surviving.share, [1.0, 0.75, 0.5, 0.0])
    np.testing.assert_array_equal(surviving.followed, [4, 4, 3, 1])
    # Greenwood: var(log S) = 1/(4*3) + 1/(3*2) = 1/4 at 2, divided by log(S)^2 for log(-log S)
    spread = 1.959964 * 0.5 / np.log(0.5)
    expected = sorted(0.5 ** np.exp([spread, -spread]))
    np.testing.assert_allclose([surviving.low[2], surviving.high[2]], expected, rtol=1e-6)
    none = gd.studies.surviving_share(known.isel(member=[3]))
    assert none.share.values.tolist() == [1.0]


def test_the_picture(known):
    ax = gd.plot.lives(known)
    np.testing.assert_allclose(ax.lines[0].get_ydata(), [1.0, 0.75, 0.5, 0.0, 0.0])
    assert ax.lines[1].get_xydata().tolist() == [[2.5, 0.5]]
    for wrong in (known.isel(member=[4]), known.drop_vars("passages_turning")):
        with pytest.raises(gd.SceneError):
            gd.plot.lives(wrong)
