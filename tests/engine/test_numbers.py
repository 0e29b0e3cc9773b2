"""What the paper's figures show (Teodorescu et al. 2009, Figs. 4-8), and that the numbers stand still."""

import numpy as np
import pytest

import gearidae as gd
from gearidae.engine import solve


@pytest.fixture(scope="module")
def low_speed():
    scene = gd.preset("teodorescu2009_low_speed")
    return {
        f: solve(scene.replace({"coating.sam_fraction": f})).samples for f in (1.0, 0.8, 0.6, 0.5, 0.47, 0.45)
    }


def test_intact_monolayer_runs_smoothly(low_speed):
    speed = low_speed[1.0]["gear_speed"]
    assert speed.min() > 1.45
    assert speed.max() < 1.55
    assert low_speed[1.0]["gear_contact_torque"].min() >= 0.0


def test_half_worn_monolayer_runs_irregularly_but_turns(low_speed):
    speed = low_speed[0.5]["gear_speed"]
    assert speed.min() == pytest.approx(0.73, rel=0.02, abs=0)
    assert speed[-1] > 1.0


@pytest.mark.parametrize("fraction", [0.47, 0.45])
def test_a_little_less_and_the_gear_sticks_and_swings_back(low_speed, fraction):
    assert low_speed[fraction]["gear_speed"].min() < -0.5


@pytest.mark.parametrize("fraction", [0.6, 0.5, 0.47, 0.45])
def test_torque_bursts_stay_within_the_figures_range(low_speed, fraction):
    assert np.abs(low_speed[fraction]["gear_contact_torque"]).max() < 2.5e-16
    assert low_speed[fraction]["gear_contact_torque"].min() < 0


@pytest.mark.parametrize("fraction", [1.0, 0.5, 0.47])
def test_figures_do_not_hang_on_tolerance_or_sampling(low_speed, fraction):
    """Half the tolerance and another sample grid change nothing in the third digit of the speeds."""
    scene = gd.preset("teodorescu2009_low_speed").replace({"coating.sam_fraction": fraction})
    speed = low_speed[fraction]["gear_speed"]
    for changes in ({"rtol": 0.5 * scene.run.rtol}, {"samples": 20001}):
        other = solve(scene, **changes).samples["gear_speed"]
        assert other.min() == pytest.approx(speed.min(), rel=5e-4, abs=0)
        assert other.max() == pytest.approx(speed.max(), rel=5e-4, abs=0)


@pytest.fixture(scope="module")
def high_speed():
    scene = gd.preset("teodorescu2009")
    return {f: solve(scene.replace({"coating.sam_fraction": f})).samples for f in (1.0, 0.0)}


def test_high_speed_hardly_sees_the_monolayer(high_speed):
    half = len(high_speed[1.0]["gear_speed"]) // 2  # the second half millisecond: the start has died away
    coated, bare = (high_speed[f]["gear_speed"][half:] for f in (1.0, 0.0))
    assert coated.mean() == pytest.approx(2893, abs=1.5)
    assert bare.mean() == pytest.approx(2892, abs=1.5)
    assert coated.mean() > bare.mean()
    for speed in (coated, bare):
        assert speed.min() == pytest.approx(2640, abs=15)
        assert speed.max() == pytest.approx(3140, abs=15)
