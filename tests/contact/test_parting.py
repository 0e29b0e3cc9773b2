"""Work to part rough planes: quadrature of the pressure, limits in closed form, and numbers found before."""

import itertools
import math

import pytest
from scipy.integrate import quad

import gearidae as gd
from gearidae.contact import adhesion_energy, attraction_pressure, rough_pressure
from gearidae.contact.attraction import FLOOR
from gearidae.contact.parting import attraction_work, zero_load_gap

SCENE = gd.preset("teodorescu2009")
BARE, COATED = SCENE.surface, SCENE.coated_surface


@pytest.mark.parametrize("asperity", ["jkr", "dmt"])
@pytest.mark.parametrize("hamaker", [0.0, 5e-20])
def test_energy_is_the_tension_added_up_from_zero_load(asperity, hamaker):
    """In steps of two roughnesses; beyond 40 the asperities are silent and the attraction is a closed form."""
    sigma, gap = BARE.roughness, zero_load_gap(BARE, hamaker, asperity)

    def tension(h):
        return -float(rough_pressure(h, math.inf, BARE, asperity)) - float(attraction_pressure(h, hamaker))

    ends = [gap + 2.0 * k * sigma for k in range(21)]
    work = sum(quad(tension, a, b, epsabs=0, epsrel=1e-12)[0] for a, b in itertools.pairwise(ends))
    work += attraction_work(ends[-1], hamaker)
    assert abs(tension(gap)) < 1e-6
    assert adhesion_energy(BARE, hamaker, asperity) == pytest.approx(work, rel=1e-10, abs=0)


@pytest.mark.parametrize(
    ("changes", "asperity", "energy"),
    [
        ({}, "jkr", 7.8e-3),
        ({}, "dmt", 2.0e-3),
        ({"energy": 1.16}, "jkr", 0.73e-3),
        ({"energy": 1.52}, "jkr", 8.7e-3),
        ({"roughness": 8e-9}, "jkr", 0.205e-3),
        ({"roughness": 9.3e-9}, "jkr", 12.5e-6),
        ({"energy": 0.1, "roughness": 1e-9}, "jkr", 75e-6),
    ],
)
def test_energies_that_another_program_has_found(changes, asperity, energy):
    """By the trapezoidal rule from the pressures, to the two or three digits it was noted with."""
    assert adhesion_energy(BARE.model_copy(update=changes), 0.0, asperity) == pytest.approx(
        energy, rel=0.01, abs=0
    )


def test_coated_planes_of_the_preset_part_without_work_but_for_the_attraction():
    """Peaks hold the planes apart, and help to part them by a tenth of the work of the attraction, A/(12 pi h^2)."""
    assert adhesion_energy(COATED) < 1e-60
    gap = zero_load_gap(COATED, 5e-20)
    carried = float(rough_pressure(gap, math.inf, COATED))
    assert carried == pytest.approx(-float(attraction_pressure(gap, 5e-20)), rel=1e-9, abs=0)
    alone = attraction_work(gap, 5e-20)
    assert 0.9 * alone < adhesion_energy(COATED, 5e-20) < alone


def test_attraction_work_is_a_closed_form_with_a_floor():
    assert attraction_work(36e-9, 5e-20) == pytest.approx(
        5e-20 / (12.0 * math.pi * 36e-9**2), rel=1e-14, abs=0
    )
    below = attraction_work(FLOOR, 5e-20) + float(attraction_pressure(FLOOR, 5e-20)) * (-1e-9 - FLOOR)
    assert attraction_work(-1e-9, 5e-20) == pytest.approx(below, rel=1e-12, abs=0)


def test_planes_that_nothing_holds_apart_are_refused():
    flat = BARE.model_copy(update={"asperity_density": 1e6})
    with pytest.raises(gd.SceneError, match="attraction closes the gap"):
        adhesion_energy(flat, 1e-17)
    with pytest.raises(gd.SceneError, match="hamaker"):
        adhesion_energy(BARE, -1e-20)
    assert adhesion_energy(BARE, 0.0, "hertz") == 0.0


@pytest.mark.parametrize(("roughness", "hamaker"), [(0.5e-9, 1e-19), (1e-9, 1e-19), (1e-9, 4e-19)])
def test_rough_planes_take_no_more_than_smooth_ones(roughness, hamaker):
    """What smooth planes take at the closest spacing of atoms; once 1.7 to 20 J/m^2."""
    surface = BARE.model_copy(update={"roughness": roughness})
    with pytest.warns(UserWarning, match=r"asperities.* dominate.*smooth planes"):
        energy = adhesion_energy(surface, hamaker)
    assert energy == pytest.approx(2 * surface.energy + hamaker / (12 * math.pi * FLOOR**2), rel=1e-12, abs=0)


def test_the_bound_of_smooth_planes_is_the_usual_one_below_it():
    surface = BARE.model_copy(update={"roughness": 3e-9})
    assert adhesion_energy(surface, 4e-19) < 2 * surface.energy
