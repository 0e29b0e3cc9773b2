"""What may be wrong with a record: stopped gears, rounding, images of faster ringing."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearidae.analysis.ringing import Ring, rings_of
from gearidae.analysis.signal import Signal
from gearidae.monitor import record_checks
from gearidae.monitor.fitting import RingSet, first_explanation
from reference.toy_map import model, ring_set

RATE = 50e3
TIME = np.arange(0.0, 0.3, 1.0 / RATE)


def signal(values):
    return Signal(0.0, 1.0 / RATE, np.asarray(values, dtype=np.float64), None, 76)


@given(st.floats(1e-6, 1.0), st.integers(0, 2**31), st.floats(-10.0, 10.0))
def test_quantum_of_rounded_values_is_found(step, seed, middle):
    rng = np.random.default_rng(seed)
    whole = np.round(middle / step) + np.round(5.0 * rng.standard_normal(500))
    # the smallest difference of 500 normal integers of width 5 is one
    assert record_checks.quantum(step * whole) == pytest.approx(step, rel=1e-6, abs=0)


def test_values_that_are_not_rounded_have_no_quantum():
    assert record_checks.quantum(1.5 + 0.1 * np.random.default_rng(0).standard_normal(5000)) == 0.0
    assert record_checks.quantum(np.full(100, 1.5)) == 0.0


def test_rounding_in_another_unit_is_found():
    """Whole tenths of a revolution per minute, converted to rad/s and kept in single precision."""
    turns = np.round(14.3 + 0.5 * np.random.default_rng(1).standard_normal(2000), 1)
    assert record_checks.quantum((turns * math.pi / 30.0).astype(np.float32).astype(float)) == pytest.approx(
        0.1 * math.pi / 30.0, rel=1e-3, abs=0
    )


def test_small_rings_are_lost_in_the_rounding_unless_noise_carries_them():
    ring = Ring(0.02, 1300.0, 10.0, amplitude=1e-3, noise=1e-5)
    assert record_checks.too_coarse(ring, 5e-3)
    assert not record_checks.too_coarse(ring, 5e-4)
    assert not record_checks.too_coarse(Ring(0.02, 1300.0, 10.0, amplitude=1e-3, noise=3e-3), 5e-3)
    assert record_checks.widened(ring, 0.0) == 10.0
    assert record_checks.widened(ring, 5e-4) == pytest.approx(math.hypot(10.0, 0.5 * 13.0), rel=1e-12, abs=0)


@pytest.mark.parametrize(
    ("speed", "words"),
    [
        (1.5 - 3.0 * (TIME > 0.2), "turns back, to -1.5"),
        (np.where(TIME < 0.2, 1.5, 0.0), "the gear stops"),
        (np.where(TIME < 0.1, 1.5, -0.1), "for half of the record"),
        (1.5 + 0.05 * np.sin(2.0 * np.pi * 1300.0 * TIME), ""),
        (np.minimum(1.5, TIME / 0.02), ""),  # it starts from rest
        (1.5 + 1.0 * np.random.default_rng(3).standard_normal(len(TIME)), ""),  # samples below zero, by noise
    ],
)
def test_a_gear_that_stops_is_seen(speed, words):
    said = record_checks.stop(signal(speed), model())
    assert (words in said) if words else said == ""


def test_a_gear_slower_than_any_of_the_map_is_seen():
    """The map's smallest speed is 0.5 rad/s at a usual speed of 1."""
    dips = 1.0 - 0.6 * (np.abs(TIME - 0.15) < 0.01)
    assert "to 0.4 rad/s, below the map's smallest speed, 0.5" in record_checks.slower_than_map(
        signal(dips), model()
    )
    assert record_checks.slower_than_map(signal(1.0 - 0.4 * (1.0 - dips) / 0.6), model()) == ""
    # at half the speed, which is another torque, half the smallest speed is usual too
    assert record_checks.slower_than_map(signal(0.3 + 0.2 * (dips > 0.9)), model()) == ""


def test_drift_is_measured_between_the_halves():
    # the first two and the last two of 5.44 pitches are compared, whose middles are 3.44 of 5.44 apart
    drifting = 1.5 + 0.06 * (TIME / 0.3 - 0.5)
    assert record_checks.unsteadiness(signal(drifting)) == pytest.approx(0.04 * 3.44 / 5.44, rel=0.02, abs=0)
    pitch = 2.0 * math.pi / 76.0
    ripple = 1.5 + 0.05 * np.sin(2.0 * math.pi * 1.5 * TIME / pitch)
    assert record_checks.unsteadiness(signal(ripple)) < 0.002


def image(frequency, rate):
    return abs(frequency - rate * round(frequency / rate))


def record_with(fraction, rate, numbers=range(4)):
    """A record of a fraction as its samples show it, with the fraction that explains it without images."""
    true = ring_set(fraction, numbers=numbers)
    shown = np.array([image(f, rate) for f in true.frequency])
    return RingSet(true.numbers, shown, 0.002 * shown, true.speed, 0.0)


def test_an_image_that_another_fraction_explains_is_named():
    """At 9 kHz the first two impacts of 0.55, 6.6 and 10.4 kHz, show as 2.4 and 1.4 kHz."""
    record = record_with(0.55, 9e3, range(1))
    fit = first_explanation(model(), record, "start")
    assert fit.explains
    assert fit.fractions[fit.best] > 0.75  # what it would be mistaken for
    assert "images of ringing above" in record_checks.alias(model(), record, fit, 9e3, math.inf)
    assert (
        record_checks.alias(model(), record, fit, 9e3, 3e3) == ""
    )  # nothing so fast came through the filter
    # one impact in the range of two fractions: the direct one, and the image of the other
    seen = record_checks._image_of(model(), record, fit, 9e3, math.inf)
    assert seen == pytest.approx(0.55, abs=0.03)


def test_a_sequence_that_no_image_explains_is_believed():
    record = record_with(0.97, 100e3)
    fit = first_explanation(model(), record, "start")
    assert record_checks.alias(model(), record, fit, 100e3, math.inf) == ""


def test_images_are_sought_at_other_torques_too():
    """At 0.6 of the map's torque 0.55 rings at 5.4 and 8.5 kHz; at 7 kHz that shows as 1.6 and 1.5 kHz.

    At the map's torque nothing shows so: 6.6 and 10.4 kHz would be 0.4 and 3.4 kHz.
    """
    slow = ring_set(0.55, torque=0.6, numbers=range(4))
    shown = np.array([image(f, 7e3) for f in slow.frequency])
    record = RingSet(slow.numbers, shown, 0.002 * shown, slow.speed, 0.0)
    # an answer that explains four impacts by 2.5 standard deviations each, and another fraction
    fit = first_explanation(model(), ring_set(0.9), "start")
    fit = replace(fit, chi2=fit.chi2 + 4 * 2.5**2)
    assert record_checks._image_of(model(), record, fit, 7e3, math.inf) == pytest.approx(0.55, abs=0.03)
    as_map = RingSet(slow.numbers, shown, 0.002 * shown, 1.0, 0.0)
    assert math.isnan(record_checks._image_of(model(), as_map, fit, 7e3, math.inf))


def bursts(frequency, decay, tone=0.0):
    """A gear whose speed rings after each pitch, in noise; and a tone throughout."""
    pitch = 2.0 * math.pi / 76.0
    since = np.mod(TIME - 0.02, pitch / 1.5)
    late = TIME >= 0.02
    ring = 0.01 * np.exp(-since / decay) * np.sin(2.0 * math.pi * frequency * since) * late
    noise = 1e-4 * np.random.default_rng(5).standard_normal(len(TIME))
    return 1.5 + ring + tone * np.sin(2.0 * math.pi * 3e3 * TIME) + noise


@pytest.mark.parametrize(
    ("values", "goes_on"),
    [
        (bursts(1300.0, 0.005), False),
        (bursts(1300.0, 0.03), False),  # it takes a pitch of 55 ms to fall to a sixth
        (bursts(1300.0, 0.005, tone=0.01), True),
        (bursts(1300.0, 0.005, tone=2e-4), False),  # a tone that the ringing covers
    ],
)
def test_a_tone_is_there_before_the_impacts_too(values, goes_on):
    record = signal(values)
    rings = rings_of(record, 0.2)
    shown = [n for n, ring in enumerate(rings) if math.isfinite(ring.frequency)]
    assert len(shown) >= 4
    assert record_checks.persistent(record, rings, shown, 0.2) == goes_on


def test_the_first_impact_does_not_tell_a_tone():
    record = signal(bursts(1300.0, 0.005, tone=0.01))
    rings = rings_of(record, 0.2)
    assert not record_checks.persistent(record, rings, [0], 0.2)
    assert not record_checks.persistent(record, rings, [], 0.2)


def test_another_torque_makes_slow_sampling_doubtful():
    """The map's first impacts ring at up to 8.1 kHz: sampled at 19 kHz, some do not show."""
    fit = first_explanation(model(), ring_set(0.97), "start")
    for speed, rate, doubtful in (
        (1.0, 19e3, False),
        (1.02, 19e3, False),
        (1.05, 19e3, True),
        (1.05, 20e3, False),
    ):
        record = replace(ring_set(0.97), speed=speed)
        said = record_checks.alias(model(), record, fit, rate, math.inf)
        assert ("a map over drive.torque can" in said) == doubtful
    over = model([0.8, 1.2])
    record = replace(ring_set(0.97), speed=1.05)
    assert "drive.torque" not in record_checks.alias(
        over, record, first_explanation(over, record, "start"), 19e3, math.inf
    )
