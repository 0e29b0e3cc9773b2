"""A half-space under a uniform pressure on a rectangle, at a point (Love 1929, doi:10.1098/rsta.1929.0009)."""

import numpy as np


def deflection(x, y, half_length, half_width, modulus):
    """Surface deflection per pressure [m/Pa] at (x, y) of a rectangle centred at the origin, modulus E*."""

    def corner(a, b):
        return a * np.arcsinh(b / np.abs(a)) + b * np.arcsinh(a / np.abs(b))

    left, right = x - half_length, x + half_length
    below, above = y - half_width, y + half_width
    total = corner(right, above) - corner(left, above) - corner(right, below) + corner(left, below)
    return total / (np.pi * modulus)
