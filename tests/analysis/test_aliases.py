"""Ringing faster than the samples show: no alias is taken for it, and the samples that show it are known."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

import gearidae as gd
from gearidae.analysis import assess, characteristic_frequency, coating_map, impact_frequencies
from gearidae.runs.ringing_samples import ringing_frequency, ringing_samples

WORN = gd.preset("teodorescu2009_low_speed").replace({"coating.sam_fraction": 0.5})
RINGS = np.array([9249.0, 16887.0, 27220.0, 40004.0, 54242.0])
"""Of `WORN` at 1 MHz, ten times and more above what is left of an error of sampling."""


@pytest.fixture(scope="module")
def slow():
    return gd.simulate(WORN, samples=3001)


def test_what_may_be_an_alias_is_no_frequency(slow):
    """At 10 kHz they were seen at 753 and 3112 Hz, with small uncertainties."""
    found = impact_frequencies(slow)
    assert np.isnan(found.frequency).all()
    # turning points of the gap in the window: the contact rings fastest at its beginning
    np.testing.assert_allclose(found.contact_frequency, RINGS, rtol=0.15)
    assert "5 of 5 responses may be aliases" in found.attrs["note"]
    first = characteristic_frequency(slow)
    assert np.isnan(first)
    assert "sampled at 10 kHz" in first.attrs["note"]


def test_a_later_response_is_not_taken_for_the_first():
    """At 18 kHz the first is seen at 8.8 kHz, its alias, and the second at 1.1 kHz."""
    assert np.isnan(characteristic_frequency(gd.simulate(WORN, samples="18 kHz")))


def test_enough_samples_show_all():
    """`ringing` takes them by an estimate; what it finds is what 1 MHz does."""
    ds = gd.simulate(WORN, samples="ringing")
    assert ds.sizes["time"] == ringing_samples(WORN) == ds.gearidae.scene.run.samples
    assert ringing_frequency(WORN) == pytest.approx(RINGS[-1], rel=0.5)
    found = impact_frequencies(ds)
    np.testing.assert_allclose(found.frequency, RINGS, rtol=1e-3)
    assert "note" not in found.attrs


def test_a_sweep_takes_the_samples_of_the_run_that_rings_fastest():
    ds = gd.sweep(WORN.replace({"run.samples": "ringing"}), {"coating.sam_fraction": [1.0, 0.5]}, t_end=0.03)
    assert ds.sizes["time"] == ringing_samples(WORN.replace({"run.duration": 0.03}))


def test_no_ringing_to_be_sampled_is_said():
    with pytest.raises(gd.SceneError, match="give a number of samples or a rate"):
        gd.simulate(gd.preset("roller_slow"), samples="ringing")


def test_a_map_says_where_it_has_aliases():
    chart = coating_map(WORN.replace({"run.samples": 3001}), [0.8, 0.7, 0.5])
    assert np.isfinite(chart.characteristic_frequency).values.tolist() == [True, True, False]
    assert "may be aliases" in chart.attrs["note"]
    assert "may be aliases" in str(chart.gearidae)


@pytest.mark.filterwarnings("ignore:sampling at:UserWarning")
@pytest.mark.parametrize("picture", [gd.plot.spectrogram, gd.plot.power_spectrum])
def test_pictures_say_so(picture, slow):
    words = " ".join(text.get_text() for text in picture(slow).texts)
    assert "may be aliases" in words.replace("\n", " ")


def test_spectra_warn_with_both_numbers():
    """At 100 kHz the fifth response of 54 kHz is seen at 46 kHz; the estimate at rest is 3.7 kHz."""
    with pytest.warns(UserWarning, match="sampling at 1e\\+05 Hz is below twice .* 5.19e\\+04 Hz"):
        gd.analysis.power_spectrum(gd.simulate(WORN, samples=30_001))


# -- records that ring where the map does not -------------------------------------------------------------------------


@pytest.fixture(scope="module")
def chart():
    return coating_map(WORN, [1.0, 0.95, 0.9, 0.7, 0.65])


def record(frequencies):
    """Ringing at given frequencies after the mesh exits of the map's runs."""
    time = np.arange(10_000) / 33.3e3
    speed = np.full(time.size, 1.5)
    for number, frequency in enumerate(frequencies):
        late = time - 0.021 - number * 2.0 * np.pi / 76 / 1.5
        speed += np.where(
            late > 0.0, 0.02 * np.exp(-late / 5e-3) * np.sin(2.0 * np.pi * frequency * late), 0.0
        )
    return xr.DataArray(speed, dims="time", coords={"time": time}, name="gear_speed")


@pytest.mark.parametrize("part", [0.94, 0.7])
def test_ringing_below_the_map_is_said(part, chart):
    """At 0.94 of the lowest coverage 1 was clear, as five impacts allowed for thrice the error that they share."""
    lowest = float(chart.characteristic_frequency[0])
    verdict = assess(record([part * lowest] * 5), chart)
    assert verdict.verdict == "outside the map"
    assert "lower than anything in the map" in verdict.explanation


def test_ringing_above_the_map_is_said(chart):
    """By the pair with half of its coating."""
    speed = gd.simulate(WORN, samples=30_001).gear_speed
    assert not assess(speed, chart).conclusive


def test_ringing_in_a_gap_of_the_map_is_said(chart):
    """By a pair at 0.8: known between 0.7 and 0.9 by a curve through both, with too small an error."""
    speed = gd.simulate(WORN.replace({"coating.sam_fraction": 0.8})).gear_speed
    verdict = assess(speed, chart)
    assert verdict.verdict == "ambiguous"
    assert (verdict.low, verdict.high) == (0.7, 0.9)
    assert "between 0.7 and 0.9" in verdict.explanation
