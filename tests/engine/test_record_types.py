"""Records: fields as attributes, and calls with several records that an interrupt may end at any moment."""

from __future__ import annotations

import signal

import numpy as np
import pytest

from gearidae.compiled import compiled
from gearidae.engine.model.record_types import INT, REAL, record_type
from gearidae.engine.model.scene_record import SCENE
from gearidae.engine.model.state import Model, blank_model

INNER = record_type(("weight", REAL), ("places", REAL, (3,)))
OUTER = record_type(("count", INT), ("inner", INNER), ("several", INNER, (2,)))


@compiled
def product(m: Model) -> float:
    """Something that needs all records of a model."""
    return float(m.scene.length_unit * m.state.time * m.work.driver.time)


def record():
    return np.zeros(1, OUTER)[0]


def test_fields_are_attributes_that_can_be_set_at_any_depth():
    one = record()
    one.count = 3
    one.inner.weight = 1.5
    one.inner.places[1] = 2.5
    one.several[1].weight = 4.5
    one.several["places"] = 0.5
    assert one.item()[0] == 3
    assert one.inner.weight == one["inner"]["weight"] == 1.5
    assert one.inner.places.tolist() == [0.0, 2.5, 0.0]
    assert one.several["weight"].tolist() == [0.0, 4.5]
    assert one.several[0].places.tolist() == [0.5] * 3


def test_what_is_no_field_is_refused():
    with pytest.raises(AttributeError, match="no field speed"):
        assert record().speed
    with pytest.raises(ValueError, match="no field of name speed"):
        record().speed = 1.0


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="needs a timer's signals")
def test_an_interrupt_stays_one_while_numba_takes_records_apart():
    """With numpy's own records, two of three interrupts came out as an AttributeError."""
    m = blank_model(np.zeros(1, SCENE)[0], np.zeros(1), 1)
    product(m)
    caught = []

    def interrupt(*_):
        raise KeyboardInterrupt

    usual = signal.signal(signal.SIGALRM, interrupt)
    try:
        for _ in range(100):
            try:
                signal.setitimer(signal.ITIMER_REAL, 1e-3)
                while True:
                    product(m)
            except (KeyboardInterrupt, AttributeError) as error:
                caught.append(type(error))
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, usual)
    assert caught == [KeyboardInterrupt] * 100
