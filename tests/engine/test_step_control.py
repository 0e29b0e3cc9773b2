"""Order and step of Adams' formulas: stable and damping where they have to be, as the error says elsewhere."""

import math

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from gearidae.engine import adams
from gearidae.engine.integrate import step_control as control
from gearidae.engine.model.state import SCENE, W, blank_model


def blank(weight=0.0):
    """A model of nothing that excites and no pair near, with one weight for the error of each of two states."""
    m = blank_model(np.zeros(1, SCENE)[0], np.zeros(0), 2)
    m.rows[:] = weight
    return m


def growth(order, turned):
    """Largest factor by which a formula on equal steps multiplies an undamped vibration, or an error, in one step."""
    times = 1.0 - np.arange(order + 1)  # the new time first, steps of 1
    weights = []
    for i, node in enumerate(times):
        others = np.delete(times, i)
        lagrange = Polynomial.fromroots(others) / np.prod(node - others)
        area = lagrange.integ()
        weights.append(area(1.0) - area(0.0))
    z = 1j * math.sqrt(turned)
    characteristic = -z * np.array(weights)
    characteristic[0] += 1.0
    characteristic[1] -= 1.0
    return np.abs(np.roots(characteristic)).max()


@pytest.mark.parametrize(
    ("order", "turned"),
    [*((k, control.STABLE) for k in (4, 5, 6)), (7, control.STABLE_7), (8, control.STABLE_8)],
)
def test_formulas_are_stable_up_to_their_longest_step(order, turned):
    """The characteristic equation's roots: even a fifth longer, no formula swings up by 1 % in ten steps."""
    assert growth(order, 1.44 * turned) < 1.001


def test_formulas_of_low_order_damp_and_those_in_the_middle_do_not():
    for turned in (0.04, 0.1, 0.25, 0.5):
        assert growth(4, turned) < 1.0
        assert growth(control.MAX_DAMPED_ORDER, turned) < 1.0
    assert growth(6, 0.16) > 1.0
    assert growth(7, 0.16) > 1.0


def after(h, order, rates, known=9, n=2):
    """A model whose formula has just found the last of these rates, at steps of length h."""
    m = blank()
    a = m.work.adams
    a.wanted = 1
    zero, correction = np.zeros(n), np.empty(n)
    adams.begin(a, 0.0, zero, np.full(n, rates[0]))
    for k in range(1, len(rates)):
        a.n_history = min(a.n_history, known)
        adams.rates_at_end(n, a, h, order, zero, correction)
        a.new_step = h
        a.new_differences[0, :n] = rates[k]
        if k < len(rates) - 1:
            adams.set_differences(a, h)
            adams.store_step(a, k * h, np.empty(n))
    return m


def eta(m, h, tolerance, correction=0.7):
    """What IDA makes of the weights at order one: its estimate, and by how much the next step is to be longer."""
    weights = np.full(2, 1.0 / tolerance)
    control.control_step(2, m, h, np.full(2, correction), weights)
    estimate = correction * weights[0] * h / (2.0 * h)
    return estimate, (2.0 * estimate + 1e-4) ** -0.5


def order_error(m, h, order):
    return math.sqrt(adams.order_error_sq(2, m.work.adams, h, order, np.ones(2)))


@pytest.mark.parametrize("correction", [1e-9, 0.7, 1e3])
@pytest.mark.parametrize("order", [2, 4, 6])
def test_steps_grow_as_the_formulas_error_allows(order, correction):
    """By (2 E)^(-1/(k+1)), whatever IDA's own prediction was worth."""
    h, rates = 0.1, np.exp(0.1 * np.arange(11.0))
    m = after(h, order, rates)
    adams.set_differences(m.work.adams, h)
    # the order above does better: its error is what counts
    error = control.SAFETY * order_error(m, h, order + 1)
    for longer in (0.97, 0.8, 1.6, 1.9):
        tolerance = error * 2.0 * longer ** (order + 1.0)
        if control.SAFETY * order_error(m, h, order) > tolerance:
            continue
        estimate, factor = eta(after(h, order, rates), h, tolerance, correction)
        assert estimate < 1.0
        assert factor == pytest.approx(longer, rel=1e-3)


def test_a_step_of_too_large_an_error_is_rejected_and_the_best_lower_order_taken():
    h, rates = 0.1, np.append(np.ones(9), 1.5)  # a kink in the last step
    m = after(h, 6, rates)
    adams.set_differences(m.work.adams, h)
    errors = [order_error(m, h, order) for order in range(1, 7)]
    m = after(h, 6, rates)
    estimate, _ = eta(m, h, control.SAFETY * errors[-1] / 3.0)
    assert estimate > 1.0
    assert m.work.adams.next_order == 1 + np.argmin(errors)


def test_the_order_goes_where_the_error_is_least():
    h = 0.1
    smooth = np.exp(h * np.arange(12.0))
    m = after(h, 4, smooth)
    eta(m, h, 1.0)
    assert m.work.adams.next_order == 5
    rough = smooth + 0.1 * np.array([0, 0, 0, 0, 0, 0, 0, 1, -1, 1, -1, 1])
    m = after(h, 4, rough)
    eta(m, h, 1.0)
    assert m.work.adams.next_order == 3
    m = after(h, 1, smooth[:2])  # nothing to compare with yet
    eta(m, h, 1.0)
    assert m.work.adams.next_order == 2


def test_steps_stop_growing_where_the_formulas_would_not_be_stable():
    h = 0.1
    for turned, longest in ((0.5, math.sqrt(control.STABLE / 0.5)), (1e-3, control.GROW_MOST)):
        m = after(h, 4, np.ones(12))
        m.work.adams.omega_sq = turned / h**2
        _, factor = eta(m, h, 1.0)
        assert factor == pytest.approx(longest, rel=1e-3)


def test_steps_held_back_too_much_are_counted():
    h = 0.1
    for turned, limited in ((1.2 * control.STABLE, 1), (0.4 * control.STABLE, 0)):
        m = after(h, 4, np.ones(12))
        m.work.adams.omega_sq = turned / h**2
        eta(m, h, 1.0)
        assert m.work.adams.limited_steps == limited


def test_no_step_is_longer_than_its_excitation_allows():
    """A sixth of a period, also where nothing of it is seen in the differences."""
    h = 0.1
    for omega, longest in ((6.0, 1 / 0.6), (12.0, 1 / 1.2)):
        m = after(h, 4, np.ones(12))
        m.scene.torque_omega = omega
        assert eta(m, h, 1.0)[1] == pytest.approx(longest, rel=1e-3)
    gears = after(h, 4, np.ones(12), n=4)
    gears.scene.mesh_omega, gears.scene.phase_rate = 2 * math.pi, 0.5
    gears.work.adams.new_state[W] = -2.0
    assert control._excitation(gears) == 0.0  # in flight
    gears.state.flank_in_reach[1] = 1
    assert control._excitation(gears) == pytest.approx(2 * math.pi)


def test_the_order_depends_on_the_step_and_the_amplitude():
    a = blank().work.adams
    a.next_order, a.omega_sq, a.amplitude_sq = 8, 1.0, math.inf
    assert [control.max_stable_order(a, h) for h in (0.3, 0.5, 0.7)] == [8, 7, 6]
    a.amplitude_sq = 0.9 * control.HIGH_AMPLITUDE**2
    assert control.max_stable_order(a, 0.3) == 5
    a.next_order = 3
    assert control.max_stable_order(a, 0.3) == 3


def changed(m, state, rates):
    change = control.change_wanted(m, state, rates)
    assert m.work.adams.wanted == ((m.work.adams.used != 0) != change)
    return change


def test_where_the_formulas_are_no_good_ida_has_its_own():
    m = blank(1e9)
    a = m.work.adams
    state, rates = np.array([16.0, 0.1]), np.zeros(2)
    assert not control.change_wanted(m, state, rates)  # IDA iterates by itself
    a.native_newton, a.used, a.omega_sq = 1, 1, 4.0
    assert not changed(m, state, rates)
    a.limited_steps = control.SWITCH_STEPS + 1
    assert changed(m, state, rates)
    a.limited_steps = 0
    m.rows[:] = 1e14  # a tolerance of three roundings
    assert changed(m, state, rates)
    m.rows[:] = 1e9
    slow = np.array([16.0, 0.9e-9 * control.LOW_AMPLITUDE])  # at rest, unless it is where the vibration turns
    assert changed(m, slow, rates)
    assert not changed(m, slow, np.array([0.0, 1e-7]))


def test_they_come_back_where_they_are_some_good_again():
    m = blank(1e9)
    a = m.work.adams
    state, rates = np.array([16.0, 0.1]), np.zeros(2)
    a.native_newton, a.omega_sq, a.last_step, a.attempts = 1, 4.0, 0.1, control.SWITCH_STEPS + 1
    assert changed(m, state, rates)
    for name, value in (("attempts", 3), ("last_step", 0.3)):
        kept = a[name]
        a[name] = value
        assert not changed(m, state, rates)
        a[name] = kept
    slow = np.array([16.0, 1.5e-9 * control.LOW_AMPLITUDE])  # hardly more than where they are given up
    assert not changed(m, slow, rates)
