"""Pictures of spectra, impact responses and what depends on the coating."""

from __future__ import annotations

import json

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.text import Annotation

import gearidae as gd
from gearidae.analysis.spectra import banded, crowded_from

LOW = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 0.1, "run.samples": 10_001})
HIGH = gd.preset("teodorescu2009").replace({"run.duration": 3e-4, "run.samples": 6001})
PICTURES = ("cycle", "power_spectrum", "impact_spectrum", "orders")


@pytest.fixture(scope="module")
def low():
    return gd.sweep(LOW, {"coating.sam_fraction": [1.0, 0.7]})


@pytest.fixture(scope="module")
def chart():
    return gd.analysis.coating_map(LOW, [1.0, 0.8, 0.6])


@pytest.fixture(scope="module")
def torques():
    return gd.analysis.starting_torque(LOW, [1.0, 0.5, 0.45], simulated=False)


def drawn(figure):
    """Draw it: labels and colours that do not go together show only then."""
    figure.canvas.draw()
    return figure


@pytest.mark.parametrize("name", PICTURES)
def test_pictures_of_runs_draw_single_ones_and_sweeps(name, low):
    draw = getattr(gd.plot, name)
    ax = Figure().add_subplot()
    assert draw(low, ax) is ax
    assert len(ax.get_legend().get_texts()) == 2
    drawn(draw(low.sel(sam_fraction=0.7)).figure)


def test_one_cycle_of_the_drive_is_shown_or_one_pitch():
    ax = gd.plot.cycle(gd.simulate(HIGH))
    assert ax.get_xlabel() == "time within the last cycle of the drive (µs)"
    assert ax.get_lines()[0].get_xdata()[-1] == pytest.approx(100.0, abs=0.1)  # 10 kHz
    ax = gd.plot.cycle(gd.simulate(LOW))
    assert ax.get_xlabel() == "time within the last pitch of the gear (ms)"
    assert ax.get_lines()[0].get_xdata()[-1] == pytest.approx(1e3 * 2 * np.pi / 76 / 1.5, rel=0.01, abs=0)


def test_drive_and_mesh_are_marked_in_the_spectrum():
    ax = gd.plot.power_spectrum(gd.simulate(HIGH))
    marked = {text.get_text(): text.xy[0] for text in ax.texts if isinstance(text, Annotation)}
    assert marked["drive"] == 10e3
    assert marked["mesh"] == pytest.approx(35.0e3, rel=0.02, abs=0)  # 2893 rad/s, 76 teeth
    assert marked["2 mesh"] == 2 * marked["mesh"]


def test_the_ring_of_a_slow_gear_is_seen():
    """At 9.2 kHz, 500 times the mesh frequency: a peak ten times its surroundings, where the impacts say it is."""
    run = gd.simulate(LOW.replace({"coating.sam_fraction": 0.5}))
    ax = gd.plot.power_spectrum(run)
    assert ax.get_xscale() == "log"
    ring = float(gd.analysis.characteristic_frequency(run))
    marked = {text.get_text(): text.xy[0] for text in ax.texts if isinstance(text, Annotation)}
    assert marked["rings"] == pytest.approx(ring, rel=0.05)
    assert any("Tukey window over 95 ms" in text.get_text() for text in ax.texts)
    (line,) = (line for line in ax.get_lines() if len(line.get_xdata()) > 10)
    frequency, power = line.get_xdata(), line.get_ydata()
    # two bands of 1/24 octave to each side
    near = power[np.abs(np.log2(frequency / ring)) < 2 / 24].max()
    beside = power[(np.abs(np.log2(frequency / ring)) > 0.15) & (np.abs(np.log2(frequency / ring)) < 0.4)]
    assert near > 10.0 * np.median(beside)
    assert len(frequency) > 200


def test_bands_keep_the_power():
    """Of a white spectrum the mean; of any spectrum, the power of each band, which is the sum of its lines."""
    frequency = 0.25 * np.arange(20_000)
    density = np.random.default_rng(4).gamma(2.0, 1e-6, frequency.size)
    at, means = banded(frequency, density, 1.0)
    plain = at < crowded_from(1.0)
    np.testing.assert_array_equal(means[plain], density[: plain.sum()])
    assert np.all(np.diff(at) > 0.0)
    edges = np.searchsorted(frequency, crowded_from(1.0) * 2.0 ** (np.arange(40) / 24))
    for low, high, mean in zip(edges[:-1], edges[1:], means[plain.sum() :], strict=False):
        assert mean == pytest.approx(density[low:high].mean(), rel=1e-12, abs=0)


def test_padding_adds_points_and_nothing_else(low):
    """Every fourth value of a spectrum padded to four times the length is that of the plain one."""
    run = low.sel(sam_fraction=0.7)
    plain, padded = (gd.analysis.power_spectrum(run, segment=0.05, padding=padding) for padding in (1, 4))
    np.testing.assert_allclose(padded[::4], plain, rtol=1e-9, atol=1e-12 * float(plain.max()))
    assert padded.attrs["resolution"] == plain.attrs["resolution"]
    with pytest.raises(gd.SceneError, match="padding"):
        gd.analysis.power_spectrum(run, padding=0)


def test_impact_response_is_named_with_its_frequency(low):
    expected = [f"{value:.0f} Hz" for value in gd.analysis.characteristic_frequency(low).values]
    ax = gd.plot.impact_spectrum(low)
    assert [text.get_text().partition(": ")[2] for text in ax.get_legend().get_texts()] == expected
    assert list(ax.texts) == []  # beside peaks that are near to each other they would overlap
    (label,) = gd.plot.impact_spectrum(low.isel(sam_fraction=0)).texts
    assert label.get_text() == expected[0]
    assert ax.get_xlim()[1] <= 0.5 / float(low.time[1] - low.time[0]) * (1 + 1e-9)


def test_of_a_sweep_the_only_run_that_rings_is_named(low):
    still = low.copy(deep=True)
    still["gear_speed"][1] = 1.5
    shown = gd.plot.impact_spectrum(still)
    assert [text.get_text() for text in shown.texts] == ["SAM 100 %: 1274 Hz"]


def test_spectrogram_shows_one_run_up_to_where_it_rings(low):
    ax = gd.plot.spectrogram(low.sel(sam_fraction=1.0))
    assert 4e3 < ax.get_ylim()[1] < 7e3
    drawn(ax.figure)
    with pytest.raises(gd.SceneError, match="one run"):
        gd.plot.spectrogram(low)


def test_map_shows_the_first_impacts_the_later_ones_and_an_assessment(chart, low):
    assessment = gd.analysis.assess(low.sel(sam_fraction=0.7), chart)
    ax = gd.plot.coating_map(chart, assessment=assessment)
    names = [text.get_text() for text in ax.get_legend().get_texts()]
    assert names == ["first impact", "later impacts", "assessed"]
    first = next(line for line in ax.get_lines() if line.get_label() == "first impact")
    assert np.array_equal(first.get_xdata(), [100.0, 80.0, 60.0])
    assert np.array_equal(first.get_ydata(), chart.characteristic_frequency)
    drawn(ax.figure)


def test_the_label_has_the_unit_and_the_prefix_of_all_ticks(chart, low, torques):
    frequencies = gd.plot.power_spectrum(low).xaxis
    impact = gd.plot.coating_map(chart).yaxis
    starting = gd.plot.starting_torque(torques).yaxis
    scales = {"Hz": 1.0, "kHz": 1e3, "aN m": 1e-18, "fN m": 1e-15}
    for axis, units in ((frequencies, ("Hz", "kHz")), (impact, ("Hz", "kHz")), (starting, ("aN m", "fN m"))):
        unit = axis.get_label_text().rpartition("(")[2].removesuffix(")")
        assert unit in units
        assert axis.get_major_formatter()(5.0 * scales[unit]) == "5"
        assert 1.0 <= max(axis.get_view_interval()) / scales[unit] < 1000.0


def test_map_over_torque_names_its_lines():
    chart = gd.analysis.coating_map(LOW, [1.0, 0.8], over={"drive.torque": [4e-18, 5e-18]})
    names = [text.get_text() for text in gd.plot.coating_map(chart).get_legend().get_texts()]
    assert names == ["torque 4 aN m", "torque 5 aN m"]


def test_starting_torque_leaves_out_where_nothing_holds(torques):
    ax = gd.plot.starting_torque(torques)
    line, drive = ax.get_lines()
    assert np.array_equal(drive.get_ydata(), [LOW.drive.torque] * 2)
    assert np.array_equal(line.get_xdata(), [50.0, 45.0])
    assert np.array_equal(line.get_ydata(), torques.static_torque[1:])
    with pytest.raises(gd.SceneError, match="does not hold"):
        gd.plot.starting_torque(torques.isel(sam_fraction=[0]))


def test_datasets_of_another_kind_are_refused(low, chart):
    with pytest.raises(gd.SceneError, match="is no coating map"):
        gd.plot.coating_map(low)
    with pytest.raises(gd.SceneError, match="static_torque"):
        gd.plot.starting_torque(chart)
    with pytest.raises(gd.SceneError, match="gear_speed"):
        gd.plot.power_spectrum(chart)
    with pytest.raises(gd.SceneError, match="no impact rings"):
        gd.plot.impact_spectrum(low.isel(time=slice(0, 300)))


def _with_speed(speed, size=20_001, duration=2.0):
    """Make a run of the slow gears with a given speed, without a simulation."""
    time = np.linspace(0.0, duration, size)
    values = speed(time)
    angle = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(time) * (values[1:] + values[:-1]))])
    data = {
        "gear_speed": ("time", values, {"units": "rad s-1"}),
        "gear_angle": ("time", angle, {"units": "rad"}),
        **{name: ("event", np.zeros(0)) for name in ("event_time", "event_gap_rate")},
        **{
            name: ("event", np.zeros(0, dtype=np.int64))
            for name in ("event_kind", "event_pair", "event_flank")
        },
    }
    return xr.Dataset(data, {"time": time}, {"scene": json.dumps(LOW.to_dict())})


def test_no_mesh_is_marked_at_the_mean_speed_of_a_run_up():
    for speed, marked in ((lambda t: 4.0 * t, False), (lambda t: 4.0 + 0.1 * np.sin(900.0 * t), True)):
        texts = [text.get_text() for text in gd.plot.power_spectrum(_with_speed(speed)).texts]
        assert ("mesh" in texts) is marked


def test_orders_mark_mesh_and_pinion_in_turns_of_the_gear():
    ax = gd.plot.orders(_with_speed(lambda t: 1.0 + 4.0 * t))
    marked = {text.get_text(): text.xy[0] for text in ax.texts if isinstance(text, Annotation)}
    assert marked["mesh"] == LOW.gears.gear_teeth
    assert marked["pinion"] == pytest.approx(LOW.gears.gear_teeth / LOW.gears.pinion_teeth)


def test_a_spectrogram_of_a_run_up_has_the_mesh_at_the_speed_of_the_instant():
    ax = gd.plot.spectrogram(_with_speed(lambda t: 4.0 * t), highest=150.0)
    mesh = next(line for line in ax.get_lines() if line.get_label() == "mesh")
    time, frequency = mesh.get_data()
    # the mean of a straight line over a segment is its value at the middle; trapezoids are exact for it
    assert frequency == pytest.approx(LOW.gears.gear_teeth * 4.0 * time / (2.0 * np.pi), rel=1e-6)


def test_the_cycle_of_a_braked_run_is_its_last_pitch_while_it_ran():
    braked = _with_speed(lambda t: np.maximum(4.0 - 4.0 * t, 0.0))  # stands from 1 s on
    speed = gd.plot.cycle(braked).get_lines()[0].get_ydata()
    # v^2 / (2 a) is the angle that is left: a pitch, and what lies below 1 % of the largest speed
    assert speed[0] == pytest.approx(np.sqrt(2.0 * 4.0 * 2.0 * np.pi / LOW.gears.gear_teeth), rel=0.01)
    assert speed[-1] == pytest.approx(0.04, abs=0.001)


ORBIT = {
    "mesh.backlash": "0.5 um",
    "drive.torque": 0.0,
    "drive.law": {"name": "microengine", "radius": "10 um", "force": "10 uN", "frequency": "600 Hz"},
    "gears.pinion_hub_clearance": "0.5 um",
}


@pytest.mark.parametrize("changes", [{"mesh.pitch_error_rms": "1 nm"}, ORBIT], ids=["errors", "orbit"])
def test_turns_of_both_shafts_and_sidebands_are_named_where_turns_differ(changes):
    teeth = LOW.replace(changes)
    run = _with_speed(lambda t: 30.0 + 0.1 * np.sin(900.0 * t)).assign_attrs(
        scene=json.dumps(teeth.to_dict())
    )
    ratio = LOW.gears.gear_teeth / LOW.gears.pinion_teeth
    for ax, turn in ((gd.plot.orders(run), 1.0), (gd.plot.power_spectrum(run), 30.0 / (2.0 * np.pi))):
        marked = {text.get_text(): text.xy[0] for text in ax.texts if isinstance(text, Annotation)}
        # the mean speed of the wave is 30 rad/s to a few parts in ten thousand
        assert marked["gear"] == pytest.approx(turn, rel=1e-3)
        assert marked["pinion"] == pytest.approx(turn * ratio, rel=1e-3)
        dotted = [line.get_xdata()[0] for line in ax.get_lines() if line.get_linestyle() == ":"]
        mesh = LOW.gears.gear_teeth * turn
        expected = [mesh + side * turn * ratio for side in (-2, -1, 1, 2)]
        np.testing.assert_allclose(dotted, expected, rtol=1e-3)
