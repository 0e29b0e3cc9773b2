"""Rough planes and rough lines by brute force: the asperities' contact radius walked through in small panels."""

import math

import numpy as np

from reference.asperity import jkr_displacement, jkr_displacement_rate, jkr_fold, jkr_force

X, W = np.polynomial.legendre.leggauss(16)


def panels(edges):
    """Nodes and weights of 16-point Gauss rules between neighbouring edges."""
    half = 0.5 * np.diff(edges)[:, None]
    return (edges[:-1, None] + half * (1 + X)).ravel(), (half * W).ravel()


def bisect(function, low, high):
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if function(middle) > 0 else (middle, high)
    return high


def pressure(gap, stretch, surface, count=600):
    """Pressure of JKR asperities [Pa] and the same of the loads' absolute values, at one gap and one stretch."""
    sigma = surface.roughness
    first = (gap - stretch) / sigma
    last = math.sqrt(max(first, 0.0) ** 2 + 100.0)
    fold = jkr_fold(surface)
    start = bisect(lambda a: jkr_displacement(a, surface) + stretch, fold, 1e3 * fold)
    end = bisect(lambda a: jkr_displacement(a, surface) - (last * sigma - gap), fold, 1e6 * fold)
    root, weight = panels(np.linspace(math.sqrt(start), math.sqrt(end), count))
    radius = root**2
    z = (gap + jkr_displacement(radius, surface)) / sigma
    density = np.exp(-0.5 * z**2) / math.sqrt(2 * math.pi) / sigma
    rate = jkr_displacement_rate(radius, surface) * 2 * root
    terms = surface.asperity_density * jkr_force(radius, surface) * density * rate * weight
    return terms.sum(), np.abs(terms).sum()


def line(gap, stretch, radius, width, surface):
    """Force of a rough line contact [N] and its absolute twin: the pressure added up along x."""
    reach = math.sqrt(2 * radius * (max(-gap, 0.0) + 14 * surface.roughness))
    x, weight = panels(np.linspace(0.0, reach, 16))
    values = np.array([pressure(gap + x_i**2 / (2 * radius), stretch, surface, 120) for x_i in x])
    return 2 * width * weight @ values
