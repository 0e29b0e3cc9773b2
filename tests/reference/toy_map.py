"""A coating map in closed form, on which assessments can be checked by hand."""

from __future__ import annotations

import numpy as np

from gearidae.monitor.fitting import RingSet
from gearidae.monitor.map_model import AFTER, BEFORE, MapModel

FRACTIONS = np.linspace(0.5, 1.0, 1001)
IMPACTS = 4
ELASTICITY = 0.4


def sequences(torque=1.0):
    """ln f = 7 + 4 (1 - fraction) at every impact, and a step of (1 - fraction) from one to the next."""
    worn = 1.0 - FRACTIONS
    place = np.arange(-BEFORE, IMPACTS + AFTER)
    return 7.0 + 4.0 * worn[:, None] + place * worn[:, None] + ELASTICITY * np.log(torque)


def model(torques=None):
    """A map of a gear whose speed is the square root of the torque."""
    lines = np.array([1.0]) if torques is None else np.array(torques)
    return MapModel(
        fractions=FRACTIONS,
        known=FRACTIONS,
        torques=None if torques is None else lines,
        sequences=np.stack([sequences(line) for line in lines]),
        spread=np.zeros((len(lines), len(FRACTIONS))),
        speeds=np.sqrt(lines)[:, None] * np.ones(len(FRACTIONS)),
        slowest=0.5,
        highest_first=np.exp(9.0),
        highest=np.exp(10.5),
        first_impact=0.03,
        width=0.2,
        gear_teeth=76,
    )


def ring_set(fraction, torque=1.0, first=0.0, numbers=range(IMPACTS)):
    """What an undisturbed record of it shows, from its start or from an impact later on."""
    numbers = np.array(list(numbers))
    x = 7.0 + (4.0 + first + numbers) * (1.0 - fraction) + ELASTICITY * np.log(torque)
    return RingSet(numbers, np.exp(x), 0.002 * np.exp(x), float(np.sqrt(torque)), 0.0)
