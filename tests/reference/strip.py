"""Deflection of a half-space under a strip: the kernel averaged across the width, and its integral in closed form."""

import math

import numpy as np


def averaged_kernel(distance, width):
    """Deflection beside a line load across the width, averaged across the width, times pi E*: `distance` in m."""
    return 2.0 * (np.arcsinh(width / distance) - width / (np.hypot(distance, width) + distance))


def strip_deflection(x, left, right, width, modulus):
    """Approach of both bodies at `x` [m] per pressure that is uniform between `left` and `right` [m/Pa]."""
    return (_integral(right - x, width) - _integral(left - x, width)) / (math.pi * modulus)


def _integral(distance, width):
    """Integral of the averaged kernel from 0 to a signed distance."""
    xi = np.maximum(np.abs(distance), 1e-30)
    far = width * np.arcsinh(xi / width) - xi * width / (np.hypot(xi, width) + xi)
    return np.copysign(2.0 * xi * np.arcsinh(width / xi) + far, distance)
