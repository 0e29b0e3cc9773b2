"""The two laws without stretch, and what all laws become without adhesion."""

import math

import numpy as np
import pytest

from gearidae.asperities import asperity_load, law_names
from gearidae.asperities.tip import Asperity, asperity_of


def test_without_energy_an_asperity_is_hertzian(silicon):
    bare = Asperity(80e9, 4e-7, 0.0, 0.0, 0.0)
    delta = np.array([-1e-9, 0.0, 1e-9, 5e-9])
    hertz = 4 / 3 * 80e9 * math.sqrt(4e-7) * np.maximum(delta, 0.0) ** 1.5
    for law in law_names():
        assert asperity_load(delta, bare, law) == pytest.approx(hertz, rel=1e-14, abs=0)


def test_dmt_adheres_without_stretching(silicon):
    tip = asperity_of(silicon)
    touch, away, deep = asperity_load([0.0, -1e-15, 1e-8], tip, "dmt")
    assert touch == pytest.approx(-2 * math.pi * 450e-9 * 3.0, rel=1e-14, abs=0)
    assert away == 0.0
    assert deep - touch == pytest.approx(float(asperity_load(1e-8, tip, "hertz")), rel=1e-13, abs=0)
