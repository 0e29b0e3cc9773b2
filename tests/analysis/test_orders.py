"""Orders: lines of a run-up stand still over turns; steps of angle are means; what cannot be counted is refused."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

import gearidae as gd

TEETH = 76
ACCELERATION = 8.0


def run_up(sign=1.0, size=40_001):
    """Speed that rises from 2 rad/s, with a mesh line of 0.1 rad/s; the angle is that of the rising speed."""
    time = np.linspace(0.0, 3.0, size)
    angle = 2.0 * time + 0.5 * ACCELERATION * time**2
    speed = 2.0 + ACCELERATION * time + 0.1 * np.sin(TEETH * angle)
    units = {"units": "rad s-1"}
    return xr.Dataset(
        {"gear_speed": ("time", sign * speed, units), "gear_angle": ("time", sign * angle)}, {"time": time}
    )


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_run_up_has_its_mesh_line_at_the_number_of_teeth(sign):
    density = gd.analysis.order_spectrum(run_up(sign))
    above = density.sel(order=slice(20.0, None))
    resolution = density.attrs["resolution"]
    assert abs(float(above.order[above.values.argmax()]) - TEETH) <= resolution
    line = above.sel(order=slice(TEETH - 4 * resolution, TEETH + 4 * resolution))
    # half the amplitude squared; means over steps of 1/79 of the line's cycle take off (pi / 79)^2 / 3 of it
    assert float(line.integrate("order")) == pytest.approx(0.1**2 / 2, rel=0.01, abs=0)


def test_steps_are_means_of_straight_lines_between_samples():
    ds = xr.Dataset(
        {
            "gear_angle": ("time", np.linspace(0.0, 10.0, 1001)),
            "gear_speed": ("time", np.linspace(0, 5, 1001)),
        },
        {"time": np.linspace(0.0, 2.0, 1001)},
    )
    turned = gd.analysis.resample(ds, step=0.037)
    assert turned.gear_speed.values == pytest.approx(0.5 * turned.gear_angle.values, rel=1e-9, abs=1e-12)
    assert turned.time.values == pytest.approx(0.2 * turned.gear_angle.values, rel=1e-9, abs=1e-12)
    assert np.diff(turned.gear_angle) == pytest.approx(0.037)


def test_samples_of_a_shaft_that_turns_back_are_left_out_and_said():
    ds = run_up()
    back = ds.gear_angle.values.copy()
    back[20_000:22_000] = back[20_000] - 0.1
    turned = gd.analysis.resample(ds.assign(gear_angle=("time", back)))
    assert turned.attrs["left_out"] == pytest.approx(2000 / 40_001, rel=0.01, abs=0)
    assert np.isfinite(turned.gear_speed).all()


@pytest.mark.parametrize(
    ("call", "key"),
    [
        (lambda ds: gd.analysis.resample(ds, over="angle"), "over"),
        (lambda ds: gd.analysis.resample(ds, over="pinion_angle"), "over"),
        (lambda ds: gd.analysis.resample(ds, step=-1.0), "step"),
        (lambda ds: gd.analysis.resample(ds.assign(gear_angle=0.0 * ds.gear_angle)), "over"),
        (lambda ds: gd.analysis.order_spectrum(ds, "mesh_force"), "variable"),
        (lambda ds: gd.analysis.order_spectrum(ds, segment=1e6), "segment"),
    ],
)
def test_what_cannot_be_counted_is_refused_by_its_key(call, key):
    with pytest.raises(gd.SceneError) as error:
        call(run_up())
    assert error.value.key == key
