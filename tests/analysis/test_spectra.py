"""Spectra: densities that add up, of signals whose spectrum is known; units and windows are stated."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

import gearidae as gd
from gearidae.analysis import power_spectrum, spectrogram

RATE = 1e5


def signal(values, rate=RATE, **attrs):
    time = np.arange(len(values)) / rate
    return xr.DataArray(values, dims="time", coords={"time": time}, name="gear_speed", attrs=attrs)


def test_density_integrates_to_the_variance_for_any_window():
    noise = np.random.default_rng(0).standard_normal(200_000)
    for window in ("hann", "boxcar", "blackmanharris"):
        density = power_spectrum(signal(noise), segment=0.01, window=window)
        # 400 segments: the mean square is known to about 1 %
        assert float(density.integrate("frequency")) == pytest.approx(noise.var(), rel=0.02, abs=0)


def test_sine_has_its_line_at_its_frequency_with_half_its_amplitude_squared():
    time = np.arange(50_000) / RATE
    density = power_spectrum(signal(3.0 + 0.2 * np.sin(2 * np.pi * 1250.0 * time)), segment=0.1)
    assert (
        float(density.frequency[density.values.argmax()]) == 1250.0
    )  # a whole number of cycles in a segment
    assert float(density.integrate("frequency")) == pytest.approx(0.02, rel=1e-6, abs=0)


def test_attributes_say_how_it_was_made():
    density = power_spectrum(signal(np.random.default_rng(1).standard_normal(10_000)), segment=0.02)
    assert density.attrs["units"] == "(rad s-1)2 Hz-1"
    assert density.attrs["window"] == "hann"
    assert density.attrs["sampling_rate"] == pytest.approx(RATE)
    assert density.attrs["segment_length"] == pytest.approx(0.02)
    assert density.frequency.attrs["units"] == "Hz"
    assert float(density.frequency[1]) == pytest.approx(density.attrs["resolution"])


def test_units_of_the_signal_are_taken_into_account():
    noise = np.random.default_rng(2).standard_normal(10_000)
    slow = power_spectrum(signal(noise * 30.0 / np.pi, units="rpm"))
    assert np.allclose(slow, power_spectrum(signal(noise, units="rad s-1")), rtol=1e-9)
    milli = signal(noise).assign_coords(time=("time", 1e3 * np.arange(10_000) / RATE, {"units": "ms"}))
    assert np.allclose(power_spectrum(milli).frequency, power_spectrum(signal(noise)).frequency)


def test_spectrogram_follows_a_rising_tone_and_adds_up_over_time():
    time = np.arange(100_000) / RATE
    tone = np.sin(2 * np.pi * (2e3 + 4e3 * time) * time)  # instantaneous frequency 2 kHz + 8 kHz/s t
    density = spectrogram(signal(tone), segment=0.01)
    peak = density.frequency[density.argmax("frequency")]
    expected = 2e3 + 8e3 * density.time
    assert np.abs(peak - expected).max() <= 1.0 / 0.01  # one bin
    assert np.allclose(density.integrate("frequency"), 0.5, rtol=0.01)


def test_runs_of_a_sweep_keep_their_labels_and_short_ones_are_nan():
    values = np.random.default_rng(3).standard_normal((2, 4, 5_000))
    values[1, 2, 100:] = np.nan
    time = np.arange(5_000) / RATE
    both = xr.DataArray(
        values,
        dims=("sam_fraction", "torque", "time"),
        coords={"sam_fraction": [1.0, 0.5], "torque": [1.0, 2.0, 3.0, 4.0], "time": time},
    )
    for density in (power_spectrum(both), spectrogram(both, segment=0.005)):
        assert density.dims[:2] == ("sam_fraction", "torque")
        assert list(density.sam_fraction.values) == [1.0, 0.5]
        assert np.isnan(density.sel(sam_fraction=0.5, torque=3.0)).all()
        assert np.isfinite(density.sel(sam_fraction=1.0)).all()
    spectrum = power_spectrum(both.sel(sam_fraction=1.0, torque=2.0))
    assert np.array_equal(spectrum, power_spectrum(both).sel(sam_fraction=1.0, torque=2.0))


def gap_in_time():
    broken = signal(np.ones(100))
    return broken.assign_coords(time=broken.time.values + (np.arange(100) > 50) * 1e-4)


@pytest.mark.parametrize(
    ("data", "options", "message"),
    [
        (signal(np.ones(100)), {"segment": 1.0}, "segment = 1 s: must lie in"),
        (signal(np.ones(100)), {"window": "round"}, "window = round"),
        (signal(np.ones(8)), {}, "16 samples or more"),
        (signal(np.ones(100)).drop_vars("time"), {}, "lacks the dimension time"),
        (signal(np.ones(100)).to_dataset(), {"variable": "pinion_speed"}, "there is gear_speed"),
        (signal(np.ones(100), units="Hz"), {}, "does not fit"),
        (signal(np.full(100, "a")), {}, "no number"),
        (gap_in_time(), {}, "off the uniform grid"),
        (np.ones(100), {}, "must be an xarray Dataset or DataArray"),
    ],
)
def test_what_cannot_be_analysed_is_named(data, options, message):
    with pytest.raises(gd.SceneError, match=message):
        power_spectrum(data, **options)


def test_overlap_is_checked():
    with pytest.raises(gd.SceneError, match="overlap = 1"):
        spectrogram(signal(np.ones(100)), overlap=1.0)


@pytest.mark.parametrize("spectrum", [power_spectrum, spectrogram])
def test_a_record_that_is_sampled_too_slowly_for_its_contact_warns_with_both_frequencies(spectrum):
    scene = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 0.02, "run.samples": "2 kHz"})
    slow = gd.simulate(scene)
    resonance = gd.analysis.contact_resonance(scene)
    with pytest.warns(
        UserWarning, match=f"sampling at 2000 Hz .* contact, {resonance / 1e3:.0f}.* Hz"
    ) as caught:
        spectrum(slow, segment=0.01)
    assert caught[0].filename == __file__
    spectrum(gd.simulate(scene, samples="4 kHz"), segment=0.01)
    spectrum(slow.gear_speed, segment=0.01)  # whose scene is not known
