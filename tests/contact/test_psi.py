import mpmath
import numpy as np
import pytest
from scipy import integrate

from gearidae.contact.psi import gaussian_tail, psi, psi_derivatives

# Both sides of the joints at -11 and 1, the bends between, and both tails.
POINTS = [
    -200.0,
    -60.0,
    -11.001,
    -10.999,
    -6.0,
    -2.0,
    -0.765,
    0.0,
    0.999,
    1.001,
    1.7,
    2.0,
    4.0,
    12.0,
    37.0,
    40.0,
]


def exact(y, order):
    with mpmath.workdps(40):
        y = mpmath.mpf(y)
        scale = mpmath.exp(max(y, 0) ** 2 / 2)
        return [
            float(
                scale
                * (-1) ** k
                * mpmath.exp(-(y**2) / 4)
                * mpmath.pcfd(k - mpmath.mpf(1) / 2, y)
                / mpmath.sqrt(2)
            )
            for k in range(order + 1)
        ]


@pytest.mark.parametrize("y", POINTS)
def test_scaled_kernel_to_full_precision(y):
    want = exact(y, 6)
    got = psi_derivatives(y, 6, scaled=True)
    # The trapezoidal rule adds terms of order 1 up to derivatives of order |y|^-k: that much of 1e-16 goes.
    tolerance = [5e-14, 5e-14, 1e-13, 1e-12, 1e-11, 1e-10, 1e-9]
    for k in range(7):
        assert got[k] == pytest.approx(want[k], rel=tolerance[k], abs=0)


@pytest.mark.parametrize("y", [-9.0, -1.0, 0.0, 2.5, 6.0])
def test_kernel_is_the_density_of_a_parabolic_gap(y):
    direct, _ = integrate.quad(
        lambda s: np.exp(-0.5 * (y + s * s) ** 2) / np.sqrt(2 * np.pi),
        0,
        6,
        epsabs=0,
        epsrel=1e-12,
        points=[abs(y) ** 0.5],
    )
    assert psi(y) == pytest.approx(2 * direct, rel=1e-11, abs=0)


def test_unscaled_tail_keeps_its_digits():
    for y in (5.0, 20.3, 36.7):
        with mpmath.workdps(40):
            scale = mpmath.exp(-(mpmath.mpf(y) ** 2) / 2)
            assert psi(y) == pytest.approx(float(scale * mpmath.mpf(exact(y, 0)[0])), rel=1e-14, abs=0)
            assert gaussian_tail(y) == pytest.approx(float(scale), rel=1e-15, abs=0)
    assert psi(60.0) == 0.0


def test_shape_and_nan():
    y = np.array([[-20.0, np.nan, 0.5], [1.0, 3.0, -11.0]])
    rows = psi_derivatives(y, 2)
    assert rows.shape == (3, 2, 3)
    assert np.isnan(rows).sum() == 3
    assert psi(2.0).shape == ()


def test_derivatives_are_of_what_stands_above_them():
    y = np.linspace(-15.0, 6.0, 60)
    step = 1e-4
    rows = psi_derivatives(y, 3)
    difference = (psi_derivatives(y + step, 3) - psi_derivatives(y - step, 3)) / (2 * step)
    # Truncation step^2/6 of a derivative of order 1, rounding 1e-16 / step.
    assert difference[:-1] == pytest.approx(rows[1:], abs=1e-8)
