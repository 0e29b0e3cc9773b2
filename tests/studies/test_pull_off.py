"""Pull-off of drawn pairs: closed forms, a slow follower of every asperity, seeds and quantiles, the command."""

import math

import numpy as np
import pytest

import gearidae as gd
from gearidae.asperities import law_of_tip
from gearidae.asperities.tip import asperity_of
from gearidae.cli import main
from gearidae.contact import attraction_force
from gearidae.mesh.involute import curvature_radii, flank_arc
from gearidae.studies.products import answer, open_product

GEARS = gd.preset("teodorescu2009").replace({"contact.roughness": "discrete"})


def listed(heights, **changes):
    """Roller with asperities in the middle, coated where the heights are given."""
    rows = {"x": [0.0] * len(heights), "height": [1e-9 * height for height in heights]}
    keys = {"contact.roughness": "discrete", "contact.asperities": rows} | changes
    return gd.preset("roller_slow").replace(keys)


def pull_off(scene, load):
    (force,) = gd.studies.pull_off(scene, [0], load=load).pull_off.values
    return force


@pytest.mark.parametrize(("law", "factor"), [("jkr", 1.5), ("dmt", 2.0)])
def test_one_asperity_has_the_pull_off_of_its_law(law, factor):
    """1.5 pi beta W and 2 pi beta W, W twice the energy; the maximum is found to 1e-9 of a roughness."""
    scene = listed([12.0], **{"contact.asperity": law})
    expected = factor * math.pi * 450e-9 * 2.0 * 1.5
    assert pull_off(scene, 1e-9) == pytest.approx(expected, rel=1e-9, abs=0)


def test_asperities_hold_together_if_the_load_has_joined_them():
    """The lower one, 2 nm below, joins when the higher is pressed by as much; they are not stretched alike then."""
    alone, pair = listed([12.0]), listed([12.0, 10.0])
    single = pull_off(alone, 1e-9)
    assert pull_off(pair, 1e-9) == pytest.approx(single, rel=1e-9, abs=0)
    ds = gd.studies.pull_off(pair, [0], load=1e-4)
    assert ds.asperities_joined.item() == 2
    assert single < ds.pull_off.item() < 2.0 * single
    assert pull_off(listed([12.0, 12.0]), 1e-9) == pytest.approx(2.0 * single, rel=1e-9, abs=0)


def test_without_adhesion_only_the_attraction_is_left():
    """Hertz' asperity lets go at zero load where it just touches, and the attraction is largest there."""
    scene = listed([12.0], **{"contact.asperity": "hertz"})
    assert pull_off(scene, 1e-9) == 0.0
    ds = gd.studies.pull_off(scene.replace({"surface.hamaker": 5e-20}), [0], load=1e-9)
    roller = scene.roller
    expected = -float(attraction_force(12e-9, roller.radius, roller.width, 5e-20))
    assert ds.pull_off.item() == pytest.approx(expected, rel=1e-6, abs=0)


def follow(scene, seed, load):
    """Slow twin: every asperity of the flank followed over small steps of the gap, from the lists that users see."""
    scene = scene.replace({"contact.seed": seed})
    lists = gd.population(scene)
    here = (lists.tooth.values == 0) & (lists.flank.values == 0)
    geometry = scene.geometry
    radius = float(curvature_radii(geometry, geometry.approach)[2])
    x = lists.arc.values[here] - float(flank_arc(geometry, geometry.approach))
    top = lists.height.values[here] - x**2 / (2.0 * radius)
    laws = []
    for coated in (False, True):
        tip = asperity_of(scene.coated_surface if coated else scene.surface)
        law = law_of_tip(scene.contact.asperity, tip, tip.stretch_limit)
        laws.append((law, tip.stretch_limit, tip.hertz_factor * tip.stretch_limit**1.5))
    kinds = lists.coated.values[here].astype(int)
    near = np.argsort(-top)[:400]
    top, kinds = top[near], kinds[near]
    unit = np.array([laws[k][1] for k in kinds])

    def force(gap, joined):
        total = 0.0
        for k, (law, length, scale) in enumerate(laws):
            total += scale * float(law.load((top[joined & (kinds == k)] - gap) / length).sum())
        return total

    gap, step, joined = top[0] + 1e-12, 2e-12, np.zeros(top.size, bool)
    while force(gap, joined) < load or not joined.any():
        gap -= step
        joined |= top - gap >= 0.0
    count, largest = int(joined.sum()), 0.0
    while joined.any():
        gap += step
        joined &= top - gap >= -unit
        largest = max(largest, -force(gap, joined))
    return largest, count


@pytest.mark.parametrize(("fraction", "seed"), [(1.0, 3), (0.5, 1), (0.0, 7)])
def test_a_slow_follower_finds_the_same(fraction, seed):
    """It steps 2 pm at a time, over which the tension near its maximum changes by less than 1e-4."""
    scene = GEARS.replace({"coating.sam_fraction": fraction})
    ds = gd.studies.pull_off(scene, [seed])
    largest, count = follow(scene, seed, ds.attrs["load"])
    assert ds.pull_off.item() == pytest.approx(largest, rel=2e-4, abs=0)
    assert abs(ds.asperities_joined.item() - count) <= 1


def test_seeds_are_numbers_from_the_scenes_own_on_or_as_they_are_given():
    scene = GEARS.replace({"contact.seed": 5})
    ds, same = gd.studies.pull_off(scene, 3), gd.studies.pull_off(GEARS, [5, 6, 7])
    assert ds.seed.values.tolist() == [5, 6, 7]
    np.testing.assert_array_equal(ds.pull_off.values, same.pull_off.values)
    for seeds in (0, -1, [], [0.5], [-1], "many", True, 10**7):
        with pytest.raises(gd.SceneError, match="seeds"):
            gd.studies.pull_off(GEARS, seeds)
    for load in (0.0, -1.0, math.nan, math.inf):
        with pytest.raises(gd.SceneError, match="load"):
            gd.studies.pull_off(GEARS, 1, load=load)
    with pytest.raises(gd.SceneError, match="no mean torque"):
        gd.studies.pull_off(gd.preset("roller_slow"), 1)


def test_the_command_keeps_what_it_says(tmp_path, capsys):
    path = tmp_path / "pull.nc"
    assert main(["pull-off", "teodorescu2009", "--seeds", "20", "--load", "1 uN", "-o", str(path)]) == 0
    ds, kind = open_product(path)
    assert (kind, ds.sizes["seed"], ds.attrs["load"]) == ("pull_off", 20, 1e-6)
    reply = answer(ds, kind)
    low, middle, high = np.quantile(ds.pull_off.values, (0.1, 0.5, 0.9))
    assert f"median of 20; 80 % between {low * 1e9:.3g} nN and {high * 1e9:.3g} nN" in reply.sentence
    assert f"parts at {middle * 1e9:.3g} nN" in capsys.readouterr().out
    ax = gd.plot.pull_off(ds)
    assert ax.get_ylim() == (0.0, 1.0)
    assert main(["pull-off", "teodorescu2009", "--seeds", "20", "-o", str(path)]) == 2
