"""More events than a block of output holds: blocks are yielded in time, and no event is lost."""

import numpy as np
import pytest

import gearidae as gd
from gearidae.engine.backend import run_blocks
from gearidae.engine.events.record import EVENT_NUMBERS, EVENTS_AT_ONCE, record
from gearidae.engine.integrate import driver
from gearidae.engine.integrate.driver import BLOCK_EVENTS, BLOCK_IMPACTS, BLOCK_PASSAGES, Ending, Output
from gearidae.engine.model.state import MATERIALS, SLOTS_HIGH
from gearidae.engine.observers.impacts import IMPACTS_AT_ONCE
from gearidae.engine.observers.passages import PASSAGES_AT_ONCE
from gearidae.engine.setup.build import make_problem
from gearidae.engine.step import has_room
from gearidae.records import EventKind, Statistics

FLIGHT = gd.preset("teodorescu2009").replace(
    {
        "mesh.backlash": 4e-6,
        "initial.gap": 2e-6,
        "drive.torque": 0.0,
        "drive.harmonic": [],
        "load.torque": 0.0,
        "load.drag": 0.0,
        "initial.gear_speed": 0.0,
        "run.duration": 1e-6,
        "run.samples": 3,
    }
)


def test_a_block_has_room_for_all_that_can_happen_at_once():
    """A pair's onset or separation, change of flank, full stretches and turning point; marks, stick or slip, a knot."""
    of_a_pair = 1 + 1 + MATERIALS + 1
    assert of_a_pair * 2 * SLOTS_HIGH + 4 + 1 + 1 <= EVENTS_AT_ONCE
    assert EVENTS_AT_ONCE < BLOCK_EVENTS


def test_room_is_for_so_many_and_what_is_full_is_not_written_beyond():
    m, out = make_problem(FLIGHT).model, Output.empty(9)
    most_events, most_passages = BLOCK_EVENTS - EVENTS_AT_ONCE, BLOCK_PASSAGES - PASSAGES_AT_ONCE
    most_impacts = BLOCK_IMPACTS - IMPACTS_AT_ONCE
    for events, passages, impacts, room in (
        (0, 0, 0, True),
        (most_events, most_passages, most_impacts, True),
        (most_events + 1, 0, 0, False),
        (0, most_passages + 1, 0, False),
        (0, 0, most_impacts + 1, False),
    ):
        assert has_room(events, passages, impacts, out) == room
    table = np.full((4, EVENT_NUMBERS), -7.0)
    assert record(m, table[:3], 2, 0.0, 1.0, 0, 0.0, 0.0) == 3
    assert record(m, table[:3], 3, 0.0, 1.0, 0, 0.0, 0.0) == 3
    np.testing.assert_array_equal(table[3], -7.0)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("backend", "room"),
    [
        ("native", BLOCK_EVENTS),
        ("sksundae", EVENTS_AT_ONCE + 100),  # a smaller block: each knot takes this driver a millisecond
    ],
)
def test_more_knots_than_a_block_has_room_for(backend, room, monkeypatch):
    """Each is an event at its own time, and a block of output never has more than it holds."""
    monkeypatch.setattr(driver, "BLOCK_EVENTS", room)
    knots = room + (4000 if backend == "native" else 400)
    times = FLIGHT.run.duration * np.arange(1, knots + 1) / (knots + 1)
    schedule = [[float(t), 1e-16 * (k % 2)] for k, t in enumerate(times)]
    scene = FLIGHT.replace({"drive.schedule": schedule})
    statistics = Statistics()
    blocks = list(run_blocks(make_problem(scene), 1e-4, 3, backend, statistics))
    assert statistics.ending is Ending.FINISHED
    assert room >= max(len(block.events) for block in blocks)
    events = np.concatenate([block.events for block in blocks])
    assert len(events) == knots
    assert np.all(events[:, 1] == EventKind.SCHEDULE_KNOT)
    # times pass through the scale of time and back
    np.testing.assert_allclose(events[:, 0], times, rtol=1e-14)
    assert sum(len(block.rows) for block in blocks) == 3
