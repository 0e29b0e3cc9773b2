"""Order and step of Adams' formulas: stable and damping where they have to be, as the error says elsewhere."""

import math

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from gearidae.engine.integrate import adams
from gearidae.engine.integrate import step_control as pace
from gearidae.engine.model import layout as at

SCENE = np.zeros(at.CONSTANTS)  # nothing that excites, no pair near


def growth(back, turned):
    """Largest factor by which a formula on equal steps multiplies an undamped vibration, or an error, in one step."""
    times = 1.0 - np.arange(back + 1)  # the new time first, steps of 1
    weights = []
    for i, own in enumerate(times):
        others = np.delete(times, i)
        lagrange = Polynomial.fromroots(others) / np.prod(own - others)
        area = lagrange.integ()
        weights.append(area(1.0) - area(0.0))
    z = 1j * math.sqrt(turned)
    characteristic = -z * np.array(weights)
    characteristic[0] += 1.0
    characteristic[1] -= 1.0
    return np.abs(np.roots(characteristic)).max()


@pytest.mark.parametrize(
    ("back", "turned"),
    [*((k, pace.LONGEST) for k in (4, 5, 6)), (7, pace.LONGEST_7), (8, pace.LONGEST_8)],
)
def test_formulas_are_stable_up_to_their_longest_step(back, turned):
    """The characteristic equation's roots: even a fifth longer, no formula swings up by 1 % in ten steps."""
    assert growth(back, 1.44 * turned) < 1.001


def test_formulas_of_low_order_damp_and_those_in_the_middle_do_not():
    for turned in (0.04, 0.1, 0.25, 0.5):
        assert growth(4, turned) < 1.0
        assert growth(pace.CALM, turned) < 1.0
    assert growth(6, 0.16) > 1.0
    assert growth(7, 0.16) > 1.0


def desk_after(h, back, rates, known=9, n=2):
    """A desk whose formula has just found the last of these rates, at steps of length h."""
    desk = np.zeros(adams.DESK)
    desk[adams.WANTED] = 1.0
    zero, correction = np.zeros(n), np.empty(n)
    adams.begin(desk, 0.0, zero, np.full(n, rates[0]))
    for k in range(1, len(rates)):
        desk[adams.KNOWN] = min(desk[adams.KNOWN], known)
        adams.rates_at_end(n, desk, h, back, zero, correction)
        desk[adams.NEW_STEP] = h
        desk[adams.NEW_RATES : adams.NEW_RATES + n] = rates[k]
        if k < len(rates) - 1:
            adams.set_differences(desk, h)
            adams.keep(desk, k * h, np.empty(n))
    return desk


def eta(desk, h, tolerance, correction=0.7, scene=None):
    """What IDA makes of the weights at order one: its estimate, and by how much the next step is to be longer."""
    weights = np.full(2, 1.0 / tolerance)
    pace.set_pace(2, desk, SCENE if scene is None else scene, h, np.full(2, correction), weights)
    estimate = correction * weights[0] * h / (2.0 * h)
    return estimate, (2.0 * estimate + 1e-4) ** -0.5


def spread(desk, h, back):
    return math.sqrt(adams.spread(2, desk, h, back, np.ones(2)))


@pytest.mark.parametrize("correction", [1e-9, 0.7, 1e3])
@pytest.mark.parametrize("back", [2, 4, 6])
def test_steps_grow_as_the_formulas_error_allows(back, correction):
    """By (2 E)^(-1/(k+1)), whatever IDA's own prediction was worth."""
    h, rates = 0.1, np.exp(0.1 * np.arange(11.0))
    desk = desk_after(h, back, rates)
    adams.set_differences(desk, h)
    # the order above does better: its error is what counts
    error = pace.CAUTION * spread(desk, h, back + 1)
    for longer in (0.97, 0.8, 1.6, 1.9):
        tolerance = error * 2.0 * longer ** (back + 1.0)
        if pace.CAUTION * spread(desk, h, back) > tolerance:
            continue
        estimate, factor = eta(desk_after(h, back, rates), h, tolerance, correction)
        assert estimate < 1.0
        assert factor == pytest.approx(longer, rel=1e-3)


def test_a_step_of_too_large_an_error_is_rejected_and_the_best_lower_order_taken():
    h, rates = 0.1, np.append(np.ones(9), 1.5)  # a kink in the last step
    desk = desk_after(h, 6, rates)
    adams.set_differences(desk, h)
    errors = [spread(desk, h, back) for back in range(1, 7)]
    desk = desk_after(h, 6, rates)
    estimate, _ = eta(desk, h, pace.CAUTION * errors[-1] / 3.0)
    assert estimate > 1.0
    assert desk[adams.BACK] == 1 + np.argmin(errors)


def test_the_order_goes_where_the_error_is_least():
    h = 0.1
    smooth = np.exp(h * np.arange(12.0))
    desk = desk_after(h, 4, smooth)
    eta(desk, h, 1.0)
    assert desk[adams.BACK] == 5
    rough = smooth + 0.1 * np.array([0, 0, 0, 0, 0, 0, 0, 1, -1, 1, -1, 1])
    desk = desk_after(h, 4, rough)
    eta(desk, h, 1.0)
    assert desk[adams.BACK] == 3
    desk = desk_after(h, 1, smooth[:2])  # nothing to compare with yet
    eta(desk, h, 1.0)
    assert desk[adams.BACK] == 2


def test_steps_stop_growing_where_the_formulas_would_not_be_stable():
    h = 0.1
    for turned, longest in ((0.5, math.sqrt(pace.LONGEST / 0.5)), (1e-3, pace.GROW_MOST)):
        desk = desk_after(h, 4, np.ones(12))
        desk[adams.FASTEST] = turned / h**2
        _, factor = eta(desk, h, 1.0)
        assert factor == pytest.approx(longest, rel=1e-3)


def test_steps_held_back_too_much_are_counted():
    h = 0.1
    for turned, held in ((1.2 * pace.LONGEST, 1.0), (0.4 * pace.LONGEST, 0.0)):
        desk = desk_after(h, 4, np.ones(12))
        desk[adams.FASTEST] = turned / h**2
        eta(desk, h, 1.0)
        assert desk[adams.HELD] == held


def test_no_step_is_longer_than_its_excitation_allows():
    """A sixth of a period, also where nothing of it is seen in the differences."""
    h, scene = 0.1, SCENE.copy()
    scene[at.TORQUE_WAVE] = 6.0
    assert eta(desk_after(h, 4, np.ones(12)), h, 1.0, scene=scene)[1] == pytest.approx(1 / 0.6, rel=1e-3)
    scene[at.TORQUE_WAVE] = 12.0
    assert eta(desk_after(h, 4, np.ones(12)), h, 1.0, scene=scene)[1] == pytest.approx(1 / 1.2, rel=1e-3)
    scene[[at.TORQUE_WAVE, at.MESH_WAVE, at.PHASE_RATE]] = 0.0, 2 * math.pi, 0.5
    gears = desk_after(h, 4, np.ones(12), n=4)
    gears[adams.NEW_STATE + at.W] = -2.0
    assert pace._excitation(gears, scene) == 0.0  # in flight
    scene[at.NEAR + 1] = 1.0
    assert pace._excitation(gears, scene) == pytest.approx(2 * math.pi)


def test_how_far_back_depends_on_the_step_and_the_swing():
    desk = np.zeros(adams.DESK)
    desk[[adams.BACK, adams.FASTEST, adams.SWING]] = 8.0, 1.0, math.inf
    assert [pace.furthest_back(desk, h) for h in (0.3, 0.5, 0.7)] == [8, 7, 6]
    desk[adams.SWING] = 0.9 * pace.LOUD**2
    assert pace.furthest_back(desk, 0.3) == 5
    desk[adams.BACK] = 3.0
    assert pace.furthest_back(desk, 0.3) == 3


def changed(desk, data, state, rates):
    change = pace.change_wanted(desk, data, state, rates)
    assert desk[adams.WANTED] == (desk[adams.ADAMS] != change)
    return change


def test_where_the_formulas_are_no_good_ida_has_its_own():
    desk, data = np.zeros(adams.DESK), np.zeros(at.CONSTANTS + 2)
    data[at.WEIGHTS_AT] = at.CONSTANTS
    data[at.CONSTANTS :] = 1e9
    state, rates = np.array([16.0, 0.1]), np.zeros(2)
    assert not pace.change_wanted(desk, data, state, rates)  # IDA iterates by itself
    desk[[adams.OWN, adams.ADAMS, adams.FASTEST]] = 1.0, 1.0, 4.0
    assert not changed(desk, data, state, rates)
    desk[adams.HELD] = pace.PATIENCE + 1.0
    assert changed(desk, data, state, rates)
    desk[adams.HELD] = 0.0
    data[at.CONSTANTS :] = 1e14  # a tolerance of three roundings
    assert changed(desk, data, state, rates)
    data[at.CONSTANTS :] = 1e9
    slow = np.array([16.0, 0.9e-9 * pace.QUIET])  # at rest, unless it is where the vibration turns
    assert changed(desk, data, slow, rates)
    assert not changed(desk, data, slow, np.array([0.0, 1e-7]))


def test_they_come_back_where_they_are_some_good_again():
    desk, data = np.zeros(adams.DESK), np.zeros(at.CONSTANTS + 2)
    data[at.WEIGHTS_AT] = at.CONSTANTS
    data[at.CONSTANTS :] = 1e9
    state, rates = np.array([16.0, 0.1]), np.zeros(2)
    desk[[adams.OWN, adams.FASTEST, adams.LAST_STEP, adams.SINCE]] = 1.0, 4.0, 0.1, pace.PATIENCE + 1.0
    assert changed(desk, data, state, rates)
    for place, value in ((adams.SINCE, 3.0), (adams.LAST_STEP, 0.3)):
        other = desk.copy()
        other[place] = value
        assert not changed(other, data, state, rates)
    slow = np.array([16.0, 1.5e-9 * pace.QUIET])  # hardly more than where they are given up
    assert not changed(desk, data, slow, rates)
