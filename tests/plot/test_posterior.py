"""The picture of a posterior: areas are probabilities, of grids and of draws."""

from __future__ import annotations

import json

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure
from scipy import stats

import gearidae as gd
from gearidae.calibration.posterior import LEVELS
from gearidae.studies import Observation

LOW = gd.preset("teodorescu2009_low_speed")


def torque(scene):
    return 1e18 * scene.drive.torque


SEEN = [Observation(of=torque, value=4.4, uncertainty=0.3)]


def area(ax):
    """Area below the curve of a panel."""
    (stairs,) = [
        patch for patch in ax.patches if hasattr(patch, "get_data") and hasattr(patch.get_data(), "edges")
    ]
    data = stairs.get_data()
    return float(np.sum(data.values * np.diff(data.edges))), data


def test_one_key_of_a_grid_is_its_density_in_the_unit_of_the_axis():
    posterior = gd.studies.calibrate(LOW, {"drive.torque": stats.norm(5e-18, 5e-19)}, SEEN, points=31)
    figure = gd.plot.posterior(posterior)
    (ax,) = figure.axes
    share, data = area(ax)
    assert share == pytest.approx(1.0, rel=1e-9)
    assert ax.get_xlabel() == "torque (aN m)"
    middle = 0.5 * (data.edges[1:] + data.edges[:-1])
    np.testing.assert_allclose(middle, 1e18 * posterior.torque, rtol=1e-9)
    (line,) = ax.lines
    assert line.get_xdata()[0] == pytest.approx(1e18 * float(posterior["mean"][0]), rel=1e-9)


def test_two_keys_of_a_grid_have_their_margins_and_both():
    priors = {"drive.torque": stats.norm(5e-18, 5e-19), "initial.gear_speed": stats.uniform(1.0, 1.0)}
    posterior = gd.studies.calibrate(LOW, priors, SEEN, points=11)
    figure = gd.plot.posterior(posterior)
    assert isinstance(figure, Figure)
    first, both, second = figure.axes
    assert area(first)[0] == pytest.approx(1.0, rel=1e-9)
    assert area(second)[0] == pytest.approx(1.0, rel=1e-9)
    (mesh,) = both.collections
    assert mesh.get_array().sum() == pytest.approx(1.0, rel=1e-9)
    np.testing.assert_allclose(mesh.get_array(), posterior.weight.T, rtol=1e-12)
    assert (both.get_xlabel(), both.get_ylabel()) == ("torque (aN m)", "initial gear speed (rad/s)")


def test_draws_are_counted():
    """As emcee leaves them, of a normal distribution: the same picture without the sampler."""
    draws = np.random.default_rng(0).normal([4e-18, 1.5, 8e-18], [1e-19, 0.1, 1e-18], (4000, 3))
    names = ("torque", "initial_gear_speed", "drag")
    keys = ["drive.torque", "initial.gear_speed", "load.drag"]
    ds = xr.Dataset({name: ("draw", draws[:, k]) for k, name in enumerate(names)})
    ds = ds.assign_coords(parameter=keys, level=list(LEVELS)).assign(
        mean=("parameter", draws.mean(axis=0)),
        quantiles=(("parameter", "level"), np.quantile(draws, LEVELS, axis=0).T),
    )
    figure = gd.plot.posterior(ds.assign_attrs(calibration=json.dumps({"priors": dict.fromkeys(keys, "")})))
    assert len(figure.axes) == 6
    panels = [ax for ax in figure.axes if not ax.collections]
    assert [area(ax)[0] for ax in panels] == pytest.approx([1.0, 1.0, 1.0])
    assert [ax.collections[0].get_array().sum() for ax in figure.axes if ax.collections] == pytest.approx(
        [1.0, 1.0, 1.0]
    )


def test_what_is_no_posterior_is_refused():
    with pytest.raises(gd.SceneError, match="posterior"):
        gd.plot.posterior(xr.Dataset())
