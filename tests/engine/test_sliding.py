"""Sliding work of one pair over one interval, in closed form."""

import pytest

import gearidae as gd
from gearidae.engine.observers.exposures.bins import ROWS
from gearidae.engine.observers.exposures.sliding import add_sliding
from gearidae.engine.setup.build import make_problem

PLACES = 8
LENGTH = 0.5


@pytest.fixture
def model():
    changes = {"run.exposures": PLACES, "contact.bodies": "rigid"}
    m = make_problem(gd.preset("teodorescu2009_low_speed").replace(changes)).model
    m.work.exposing.pair[0].row = m.scene.exposures_at
    return m


def add(m, start, end, places=(2, 2), bend=0.0):
    """Add an interval between two forces, given with their rates and the sliding speed; return the work by place.

    `bend` is the rate of the sliding speed.
    """
    contact, pitches = m.work.exposing.pair[0], m.scene.bins_per_pitch
    inside = [(place + 0.5) / pitches for place in places]
    force, rate, speed = start
    contact.side = 1 if speed > 0.0 else -1
    contact.time, contact.position, contact.bin = 0.0, inside[0], places[0]
    contact.power, contact.power_rate = force * abs(speed), rate * abs(speed) + contact.side * force * bend
    away = inside[1] - m.scene.pitch_point
    sliding = (end[2] / away, bend / away, 0.0)  # the contact does not move along the path
    add_sliding(m, LENGTH, 0, sliding, inside[1], (0.0, 0.0), end[:2])
    first = m.scene.exposures_at + ROWS.sliding * PLACES
    return m.rows[first : first + PLACES]


def test_a_force_that_changes_evenly(model):
    work = add(model, (3.0, 2.0, 1.0), (4.0, 2.0, 1.0))
    assert work[2] == pytest.approx(3.5 * LENGTH, rel=1e-14, abs=0)
    assert work.sum() == work[2]


@pytest.mark.parametrize("backwards", [False, True])
@pytest.mark.parametrize("places", [(2, 2), (2, 3), (2, 5)])
def test_a_force_that_ceases_to_push(model, places, backwards):
    """A straight line from 3 to -1 is above zero in three quarters of the interval, with a triangle's area."""
    start, end = (3.0, -8.0, 1.0), (-1.0, -8.0, 1.0)
    if backwards:
        start, end = (-1.0, 8.0, 1.0), (3.0, 8.0, 1.0)
    work = add(model, start, end, places)
    assert work.sum() == pytest.approx(0.5 * 3.0 * 0.75 * LENGTH, rel=1e-14, abs=0)
    assert (work >= 0.0).all()
    # a contact that moves evenly leaves its place after a share of the interval
    leaves = 0.5 / (places[1] - places[0]) if places[1] > places[0] else 1.0
    line = (3.0 - 4.0 * leaves) if leaves < 0.75 else 0.0
    first = 0.5 * (3.0 + line) * min(leaves, 0.75) * LENGTH
    if backwards:
        first = 0.5 * max(4.0 * leaves - 1.0, 0.0) * max(leaves - 0.25, 0.0) * LENGTH
    assert work[2] == pytest.approx(first, rel=1e-14, abs=1e-16)


def test_a_cubic_that_ceases_to_push(model):
    """Its zero is found to the square of a Newton step's error: 1 - s - s^3 / 10 over the whole interval."""
    work = add(model, (1.0, -1.0 / LENGTH, 1.0), (-0.1, -1.3 / LENGTH, 1.0))
    zero = 0.9216989942  # of 1 - s - s^3 / 10
    exact = (zero - zero**2 / 2 - zero**4 / 40) * LENGTH
    assert work.sum() == pytest.approx(exact, rel=1e-5, abs=0)


@pytest.mark.parametrize(("force", "expected"), [(-1.0, 0.0), (2.0, 2.0 * 0.5 * (0.8**2 + 0.2**2) * LENGTH)])
def test_a_force_while_the_sliding_speed_turns(model, force, expected):
    """Where it pulls, its power comes up to zero and goes down again; it is not above."""
    work = add(model, (force, 0.0, 0.8), (force, 0.0, -0.2), bend=-1.0 / LENGTH)
    # sixteen parts, in one of which the speed turns
    assert work.sum() == pytest.approx(expected, rel=2.0 / 16**2, abs=0)
