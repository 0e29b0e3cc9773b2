"""One JKR asperity as Johnson, Kendall and Roberts wrote it, in metres and newtons of the contact radius."""

import math

import numpy as np


def modulus(surface):
    return surface.youngs_modulus / 2 / (1 - surface.poisson_ratio**2)


def jkr_displacement(contact_radius, surface):
    """``a^2/beta - sqrt(2 pi a dgamma / E*)`` [m]."""
    return contact_radius**2 / surface.asperity_radius - np.sqrt(
        2 * math.pi * contact_radius * 2 * surface.energy / modulus(surface)
    )


def jkr_displacement_rate(contact_radius, surface):
    return 2 * contact_radius / surface.asperity_radius - 0.5 * np.sqrt(
        2 * math.pi * 2 * surface.energy / modulus(surface) / contact_radius
    )


def jkr_force(contact_radius, surface):
    """``4 E* a^3 / (3 beta) - sqrt(8 pi dgamma E* a^3)`` [N]."""
    E = modulus(surface)
    return 4 * E * contact_radius**3 / (3 * surface.asperity_radius) - np.sqrt(
        8 * math.pi * 2 * surface.energy * E * contact_radius**3
    )


def jkr_fold(surface):
    """Contact radius at which the displacement is least [m]: the derivative above is zero."""
    return (math.pi * surface.asperity_radius**2 * surface.energy / modulus(surface) / 4) ** (1 / 3)
