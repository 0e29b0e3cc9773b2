"""Quantities: what follows from their declarations."""

import json
import math
import pickle
from types import SimpleNamespace

import numpy as np
import pytest

from gearidae.archive.variables import ENERGY_TOTALS, EXTREMES, by_name
from gearidae.engine.model.checkpoint_record import STATE, STATE_FIELDS
from gearidae.records import EnergyBalance, Extremes
from gearidae.records.energy import ENERGY_NOW, ENERGY_SUMS, LOSSES, TERMS
from gearidae.records.extremes import GEAR_EXTREMES
from gearidae.records.quantity import (
    ENERGY,
    FORCE,
    GEAR_SPEED,
    INT,
    LENGTH,
    POWER,
    POWER_RATE,
    REAL,
    SPEED,
    TIME,
    Quantity,
    convert,
    count,
    in_si,
)

LENGTH_UNIT, RADIUS = 3.0, 11.0
OLD = SimpleNamespace(force_unit=2.0, length_unit=LENGTH_UNIT, time_unit=5.0, gear_radius=RADIUS)
NEW = SimpleNamespace(force_unit=0.7, length_unit=LENGTH_UNIT, time_unit=1.3, gear_radius=RADIUS)
RATIOS = (OLD.force_unit / NEW.force_unit, OLD.time_unit / NEW.time_unit)


def leaves(fields, record):
    """All fields of a record and of the records in it, each with its values."""
    for field in fields:
        if isinstance(field.kind, tuple):
            yield from leaves(field.kind, record[field.name])
        else:
            yield field, np.array(record[field.name])


@pytest.mark.parametrize(
    ("unit", "value"),
    [
        (LENGTH, 3.0),
        (TIME, 5.0),
        (FORCE, 2.0),
        (SPEED, 3.0 / 5.0),
        (GEAR_SPEED, 3.0 / 55.0),
        (ENERGY, 6.0),
        (POWER, 6.0 / 5.0),
        (POWER_RATE, 6.0 / 25.0),
    ],
)
def test_units_in_si(unit, value):
    assert unit.in_si(OLD) == pytest.approx(value, rel=1e-15)


def test_a_state_in_other_units_is_the_same_in_si():
    """Of all its fields at once, histories of the pairs included."""
    rng = np.random.default_rng(1)
    old = np.zeros(1, STATE)
    old.view(np.float64)[:] = rng.normal(size=old.nbytes // 8)
    new = old.copy()
    convert(STATE_FIELDS, new[0], *RATIOS)
    scaled = 0
    for (field, before), (_, after) in zip(
        leaves(STATE_FIELDS, old[0]), leaves(STATE_FIELDS, new[0]), strict=True
    ):
        if field.kind == INT or not (field.unit.force or field.unit.time):
            np.testing.assert_array_equal(before, after)
            continue
        scaled += 1
        np.testing.assert_allclose(after * field.unit.in_si(NEW), before * field.unit.in_si(OLD), rtol=1e-14)
    assert scaled > 30


def test_whole_numbers_have_no_units_and_bounds():
    for field, _ in leaves(STATE_FIELDS, np.zeros(1, STATE)[0]):
        if field.kind == INT:
            assert field.unit.scaled == "1"
            assert callable(field.high) or field.low < field.high
        assert field.meaning


def test_names_in_an_archive_are_of_one_quantity_each():
    names = [name for quantity in (*ENERGY_SUMS, *ENERGY_NOW, *GEAR_EXTREMES) for name in quantity.archive]
    assert len(names) == len(set(names))
    assert set(names) <= {*ENERGY_TOTALS, *EXTREMES} <= set(by_name())
    assert all(LOSSES[name].sign == -1 and name in TERMS for name in LOSSES)


def test_numbers_of_an_array_have_a_name_each():
    pair = Quantity(
        "pair", "of both", LENGTH, shape=(2,), archive={"left": "of one", "right": "of the other"}
    )
    whole = count("turns", "of it", archive="rounds")
    numbers = in_si((pair, whole), {"pair": np.array([1.0, 2.0]), "turns": 4}, OLD)
    assert numbers == {"left": 3.0, "right": 6.0, "rounds": 4}
    assert whole.archive == {"rounds": "of it"}
    assert (pair.kind, whole.kind) == (REAL, INT)


def test_the_residual_is_works_less_losses_and_changes():
    numbers = {name: 2.0**-k for k, name in enumerate(TERMS)}
    works = sum(numbers[name] for name in ("drive_work", "radius_work", "model_change"))
    assert EnergyBalance(numbers).residual == pytest.approx(2.0 * works - sum(numbers.values()), rel=1e-12)


def test_totals_are_numbers_by_name():
    extremes = Extremes(stick_time=3.0)
    assert extremes.stick_time == extremes["stick_time"] == 3.0
    assert (extremes.reversals, math.isnan(extremes.max_gear_speed), len(extremes.exposures)) == (0, True, 0)
    with pytest.raises(AttributeError, match="Extremes has no speed"):
        _ = extremes.speed
    again = pickle.loads(pickle.dumps(extremes))
    assert type(again) is Extremes
    assert json.dumps(dict(again, exposures=0, standstill_list=0)) == json.dumps(
        dict(extremes, exposures=0, standstill_list=0)
    )
