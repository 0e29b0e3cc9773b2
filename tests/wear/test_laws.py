"""Loss laws: formulas, parameters with units, registration."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest

import gearidae as gd
from gearidae.wear import (
    Arrhenius,
    Exposure,
    LossLaw,
    loss_law,
    loss_law_names,
    register_loss,
    unregister_loss,
)
from gearidae.wear.base import parameter

SEEN = Exposure(*(np.array([1.0, 2.0]) * unit for unit in (1e12, 1e-3, 2e-3, 1e6, 5e-4)))
F = np.array([0.5, 0.25])


def test_each_law_is_its_formula():
    assert loss_law_names() == ("adhesion_work", "contacts", "friction_work", "sliding_work")
    np.testing.assert_allclose(loss_law("contacts", area=1e-20).rate(F, SEEN), [-5e-9, -5e-9])
    np.testing.assert_allclose(loss_law("adhesion_work", energy=10.0).rate(F, SEEN), [-5e-5, -5e-5])
    np.testing.assert_allclose(loss_law("sliding_work", coefficient=3.0).rate(F, SEEN), [-6e-3, -12e-3])

    np.testing.assert_allclose(loss_law("friction_work", coefficient=3.0).rate(F, SEEN), [-1.5e-3, -3e-3])


@pytest.mark.parametrize("name", ["sliding_work", "friction_work"])
def test_archard_ends_where_nothing_is_left(name):
    law = loss_law(name, coefficient=3.0)
    np.testing.assert_array_equal(law.rate(np.zeros(2), SEEN), 0.0)


@pytest.mark.parametrize("hot", [False, True])
def test_a_law_of_friction_needs_friction(hot):
    law, smooth = loss_law("friction_work", coefficient=3.0), gd.preset("teodorescu2009")
    if hot:
        law = Arrhenius(law, "1 eV", "50 nm^3", "300 K")
    with pytest.raises(gd.SceneError, match="above 0 for the loss law friction_work") as error:
        gd.studies.life(smooth, law)
    assert error.value.key == "contact.friction"
    with pytest.raises(gd.SceneError, match="above 0 for the loss law friction_work"):
        gd.studies.lives(smooth, law, {"drive.torque": "uniform(2.9e-11, 3e-11)"}, 2)
    law.check(smooth.replace({"contact.friction": 0.1}))
    law.check(smooth.replace({"contact.friction_law": "shear", "coating.shear_strength": "1 MPa"}))
    loss_law("sliding_work", coefficient=3.0).check(smooth)


def test_an_exposure_without_friction_has_no_work_of_it():
    seen = Exposure(SEEN.contacts, SEEN.adhesion_work, SEEN.sliding_work, SEEN.pressure)
    np.testing.assert_array_equal(loss_law("friction_work", coefficient=3.0).rate(F, seen), 0.0)


def test_arrhenius_multiplies_a_law():
    law = loss_law("contacts", area=1e-20)
    assert Arrhenius(law, "1 eV", "50 nm^3", "25 degC").temperature == 298.15
    slowed = Arrhenius(law, "1 eV", "50 nm^3", "300 K")
    k = 1.380649e-23 * 300.0
    barrier = 1.602176634e-19 - np.array([1e6, 2e6]) * 5e-26
    np.testing.assert_allclose(slowed.rate(F, SEEN), law.rate(F, SEEN) * np.exp(-barrier / k), rtol=1e-12)
    assert slowed.factor(np.array([1e12])) == 1.0  # nothing is left to overcome
    assert slowed.describe()["law"] == {"name": "contacts", "area": 1e-20}


@pytest.mark.parametrize(
    ("name", "parameters", "key"),
    [
        ("rust", {}, "law"),
        ("contacts", {}, "contacts.area"),
        ("contacts", {"area": -1.0}, "contacts.area"),
        ("contacts", {"area": "1 s"}, "contacts.area"),
        ("contacts", {"area": 1e-20, "depth": 1.0}, "contacts.depth"),
        ("adhesion_work", {"energy": 0.0}, "adhesion_work.energy"),
    ],
)
def test_wrong_laws_name_what_is_wrong(name, parameters, key):
    with pytest.raises(gd.SceneError) as error:
        loss_law(name, **parameters)
    assert error.value.key == key


def test_a_law_of_ones_own():
    @register_loss
    @dataclass(frozen=True)
    class Steady(LossLaw):
        name: ClassVar[str] = "steady"
        source: ClassVar[str] = "a test"
        loss: float = parameter("1", "share lost in a passage")

        def rate(self, fraction, exposure):
            return np.full_like(fraction, -self.loss)

    try:
        assert "steady" in loss_law_names()
        np.testing.assert_array_equal(loss_law("steady", loss=0.25).rate(F, SEEN), -0.25)
        with pytest.raises(gd.SceneError, match="another loss law"):
            register_loss(Steady)
    finally:
        unregister_loss("steady")
    assert "steady" not in loss_law_names()
