"""Impact responses: on made-up ringing of known frequency, and on runs against the force law's own resonance."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

import gearidae as gd
from gearidae.analysis import (
    characteristic_frequency,
    contact_resonance,
    impact_frequencies,
    impact_spectrum,
    impact_windows,
)

SCENE = gd.preset("teodorescu2009_low_speed")
TEETH = 76
PITCH = 2 * np.pi / TEETH / 1.5  # time of a pitch at 1.5 rad/s


def ringing(frequencies, rate=1e5, first=0.4, decay=8e-3, amplitude=2e-3):
    """Speed of a gear whose contact begins to ring at every mesh exit, one frequency after the other."""
    time = np.arange(0.0, (len(frequencies) + first) * PITCH, 1.0 / rate)
    speed = np.full(len(time), 1.5)
    for number, frequency in enumerate(frequencies):
        late = time - (first + number) * PITCH
        ring = amplitude * np.exp(-np.abs(late) / decay) * np.sin(2 * np.pi * frequency * late)
        speed += np.where(late > 0.0, ring, 0.0)
    return xr.DataArray(speed, dims="time", coords={"time": time})


@pytest.fixture(scope="module")
def runs():
    return gd.sweep(SCENE, {"coating.sam_fraction": [1.0, 0.8, 0.6, 0.5]})


@pytest.mark.parametrize("rate", [2e4, 1e5, 3.7e5])
def test_known_frequencies_are_found_without_events(rate):
    true = [1283.0, 2000.0, 3111.0, 5000.0]
    rings = impact_frequencies(ringing(true, rate), gear_teeth=TEETH)
    # the decay and the taper make lines 100 Hz wide; their middle is found far better
    assert np.allclose(rings.frequency[: len(true)], true, rtol=3e-3)
    expected = (0.4 + np.arange(4)) * PITCH
    assert np.abs(rings.impact_time[:4] - expected).max() < 0.02 * PITCH
    assert (np.abs(rings.frequency[:4] - true) < 3.0 * rings.uncertainty[:4] + 1.0).all()


def test_ringing_too_fast_for_the_sampling_is_left_out_with_all_that_follows():
    rings = impact_frequencies(ringing([1e3, 2e3, 4e3, 8e3, 16e3], rate=2e4), gear_teeth=TEETH)
    assert np.isfinite(rings.frequency[:4]).all()
    assert np.isnan(rings.frequency[4:]).all()  # 16 kHz would show as 4 kHz


def test_noise_and_steady_running_do_not_ring():
    still = ringing([1e3] * 4, amplitude=0.0)
    for level in (0.0, 1e-16, 1e-3):
        noisy = still + level * np.random.default_rng(1).standard_normal(still.shape)
        frequency = characteristic_frequency(noisy, gear_teeth=TEETH)
        assert np.isnan(frequency)
        assert frequency.impacts == 0


def test_a_missing_sample_within_a_record_is_named():
    speed = ringing([1283.0, 2000.0])
    speed[300] = np.nan
    for analyse in (characteristic_frequency, impact_windows, impact_spectrum):
        with pytest.raises(gd.SceneError, match=r"sample 300 \(0.003 s\) is missing.*1 in all"):
            analyse(speed, gear_teeth=TEETH)
    with pytest.raises(gd.SceneError, match="sample 300"):
        gd.analysis.power_spectrum(speed)


def test_missing_samples_at_the_ends_bound_a_record():
    """As those of a running mean, or of a run that ended early."""
    speed = ringing([1283.0, 2000.0])
    whole = characteristic_frequency(speed[4:-7], gear_teeth=TEETH)
    speed[:4] = speed[-7:] = np.nan
    frequency = characteristic_frequency(speed, gear_teeth=TEETH)
    assert frequency.item() == pytest.approx(whole.item(), rel=1e-9, abs=0)
    assert frequency.uncertainty.item() == pytest.approx(whole.uncertainty.item(), rel=1e-6, abs=0)


def test_a_running_mean_is_analysed(runs):
    """Over 50 us, which leaves what rings at 1 to 4 kHz."""
    means = runs.isel(sam_fraction=slice(3)).rolling(time=5).mean()
    frequencies, known = (
        characteristic_frequency(means),
        characteristic_frequency(runs.isel(sam_fraction=slice(3))),
    )
    assert np.allclose(frequencies, known, rtol=0.02)


def test_a_record_with_the_sign_reversed_is_read():
    speed = ringing([1283.0, 2000.0])
    known, reversed_sign = (impact_frequencies(sign * speed, gear_teeth=TEETH) for sign in (1, -1))
    assert reversed_sign.identical(known)
    spectra = [impact_spectrum(sign * speed, gear_teeth=TEETH) for sign in (1, -1)]
    assert np.allclose(*spectra, rtol=1e-9, equal_nan=True)
    assert impact_windows(-speed, gear_teeth=TEETH).identical(impact_windows(speed, gear_teeth=TEETH))


def test_characteristic_frequencies_of_the_low_speed_runs(runs):
    frequencies = characteristic_frequency(runs)
    assert frequencies.dims == ("sam_fraction",)
    assert frequencies.attrs["units"] == frequencies.uncertainty.attrs["units"] == "Hz"
    low, high = np.array([[1230.0, 1280.0], [1800.0, 2000.0], [3000.0, 6000.0], [6000.0, 17000.0]]).T
    assert (frequencies.values > low).all()
    assert (frequencies.values < high).all()
    assert (frequencies.uncertainty < 0.015 * frequencies).all()
    assert float(characteristic_frequency(runs.sel(sam_fraction=0.6))) == frequencies.sel(sam_fraction=0.6)


@pytest.mark.parametrize("width", [0.14, 0.28])
def test_result_does_not_hang_on_the_window_or_the_sampling(width, runs):
    usual = characteristic_frequency(runs)
    assert np.allclose(characteristic_frequency(runs, width=width), usual, rtol=0.015)
    sparse = runs.isel(time=slice(None, None, 3))
    assert np.allclose(characteristic_frequency(sparse), usual, rtol=1e-3)


@pytest.mark.parametrize("fraction", [1.0, 0.8, 0.6, 0.5])
def test_ringing_is_the_resonance_of_the_loaded_pair(fraction, runs):
    """Every impact rings at sqrt(k/m)/2 pi of the force law, for a pair pressed as deep as the run had it.

    The resonance is that of small oscillations at one place along the path; the ring's amplitude and the radius that
    changes by 10 % within the window are good for 2 %.
    """
    scene, run = SCENE.replace({"coating.sam_fraction": fraction}), runs.sel(sam_fraction=fraction)
    windows, rings = impact_windows(run), impact_frequencies(run)
    for number in np.flatnonzero(np.isfinite(rings.frequency.values)):
        deepest = run.drive_gap.sel(time=slice(0.0, float(windows.window_stop[number]))).min()
        assert float(rings.frequency[number]) == pytest.approx(
            contact_resonance(scene, float(deepest)), rel=0.03, abs=0
        )


def test_resonance_of_a_lightly_pressed_pair_depends_on_the_load_alone():
    """In the exponential tail dW/dg = -W H/sigma nearly, so the square of the frequency goes with the torque."""
    bare = SCENE.replace({"contact.asperity": "hertz"})
    light, heavy = (contact_resonance(bare.replace({"drive.torque": torque})) for torque in (4.5e-18, 9e-18))
    # H falls by ln 2 / H = 0.11 of 6.06 from one to the other, a further 0.9 % in the frequency
    assert heavy / light == pytest.approx(np.sqrt(2.0 * (6.06 - 0.11) / 6.06), rel=2e-3, abs=0)


def test_windows_from_events_and_from_the_speed_agree(runs):
    for fraction in (1.0, 0.8, 0.6):
        run = runs.sel(sam_fraction=fraction)
        known = impact_windows(run)
        windows = impact_windows(run.gear_speed.drop_attrs(), gear_teeth=TEETH)
        assert known.attrs["source"] != windows.attrs["source"]
        late = (windows.impact_time - known.impact_time)[:5]
        assert np.abs(late).max() < 0.03 * PITCH
        lengths = (known.window_stop - known.window_start).dropna("impact")
        assert np.allclose(lengths, 0.22 * PITCH, rtol=0.05)  # the gear is a little slower after an impact


def test_impact_spectrum_peaks_at_the_ring(runs):
    density = impact_spectrum(runs.sel(sam_fraction=[0.8, 0.6]))
    assert density.dims == ("sam_fraction", "impact", "frequency")
    for fraction in (0.8, 0.6):
        spectrum = density.sel(sam_fraction=fraction, impact=1).sel(frequency=slice(1e3, None))
        ring = impact_frequencies(runs.sel(sam_fraction=fraction)).frequency[1]
        assert float(spectrum.frequency[spectrum.values.argmax()]) == pytest.approx(
            float(ring), abs=float(spectrum.frequency.diff("frequency")[0])
        )


def test_a_gear_that_sticks_has_no_impacts_afterwards():
    run = gd.simulate(SCENE.replace({"coating.sam_fraction": 0.45}))
    stop = float(run.time[int((run.gear_speed.values <= 0.0).argmax())])
    times = impact_windows(run).impact_time
    assert times.notnull().any()
    assert times.max() < stop


def test_missing_information_is_named():
    with pytest.raises(gd.SceneError, match="gear_teeth = None"):
        impact_windows(ringing([1e3] * 3))
    with pytest.raises(gd.SceneError, match="width = 2"):
        characteristic_frequency(ringing([1e3] * 3), width=2.0, gear_teeth=TEETH)
    with pytest.raises(gd.SceneError, match="there is none of that name"):
        characteristic_frequency(gd.simulate(gd.preset("roller_slow").replace({"run.samples": 101})))
    with pytest.raises(gd.SceneError, match="must be a scene with gears"):
        contact_resonance(gd.preset("roller_slow"))
    with pytest.raises(gd.SceneError, match=r"drive\.torque"):
        contact_resonance(SCENE.replace({"drive.torque": 0.0}))
