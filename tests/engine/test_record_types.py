"""Records: fields as attributes, and calls with several records that an interrupt may end at any moment."""

from __future__ import annotations

import signal
from typing import NamedTuple

import numba
import numpy as np
import pytest

from gearidae.compiled import compiled, name_type
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
    first = record()
    first.count = 3
    first.inner.weight = 1.5
    first.inner.places[1] = 2.5
    first.several[1].weight = 4.5
    first.several["places"] = 0.5
    assert first.item()[0] == 3
    assert first.inner.weight == first["inner"]["weight"] == 1.5
    assert first.inner.places.tolist() == [0.0, 2.5, 0.0]
    assert first.several["weight"].tolist() == [0.0, 4.5]
    assert first.several[0].places.tolist() == [0.5] * 3


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


def test_the_type_of_a_model_has_a_short_name():
    """It is part of the symbol of each compiled function; numba's own name of it lists the fields of all records."""
    model = blank_model(np.zeros(1, SCENE)[0], np.zeros(1), 1)

    @numba.njit
    def kind_of(m):
        return m.scene.kind

    @numba.njit
    def kind(scene, state, work, tables, rows):
        return kind_of(Model(scene, state, work, tables, rows))

    assert kind(*model) == model.scene.kind
    in_compiled_code = kind_of.nopython_signatures[0].args[0]
    assert in_compiled_code is numba.typeof(model)
    assert in_compiled_code.name.startswith("Model_")
    assert len(in_compiled_code.name) < 20


def test_types_that_differ_are_not_called_the_same():
    class Pair(NamedTuple):
        first: float
        other: float

    kinds = [Pair(1.0, 2.0), Pair(1, 2)]
    for _ in range(2):
        for kind in kinds:
            name_type(kind, "Pair")
    names = {numba.typeof(kind).name for kind in kinds}
    assert len(names) == 2
    assert all(name.startswith("Pair_") for name in names)
