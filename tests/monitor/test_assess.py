"""Maps and what is asked of them: plain answers where a signal cannot tell, named errors where input is wrong."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

import gearidae as gd
from gearidae.analysis import assess, coating_map, open_map
from gearidae.archive import save
from gearidae.scene.prefixes import with_prefix
from same import assert_same

SCENE = gd.preset("teodorescu2009_low_speed")


@pytest.fixture(scope="module")
def chart():
    return coating_map(SCENE, [1.0, 0.9, 0.8, 0.7, 0.6])


@pytest.fixture(scope="module")
def worn():
    return gd.simulate(SCENE.replace({"coating.sam_fraction": 0.65}))


def test_map_rises_as_the_coating_wears(chart):
    frequency = chart.characteristic_frequency
    assert frequency.dims == ("sam_fraction",)
    assert (np.diff(frequency.values) > 0.0).all()
    first = chart.impact_frequency.isel(impact=0)
    assert np.array_equal(first, frequency)
    assert chart.attrs["title"].endswith("coating map")
    assert (chart.min_gear_speed > 0.0).all()


def test_map_over_torque_has_a_line_for_each():
    both = coating_map(SCENE, [1.0, 0.8], over={"drive.torque": ["4.5e-18 N m", "9e-18 N m"]})
    assert both.impact_frequency.dims == ("torque", "sam_fraction", "impact")
    assert list(both.torque.values) == [4.5e-18, 9e-18]
    assert both.torque.attrs["units"] == "N m"
    # Stiffness goes with load, see test_ringing; a worn contact remembers the first touch, which is much the same.
    ratio = both.characteristic_frequency.isel(torque=1) / both.characteristic_frequency.isel(torque=0)
    assert float(ratio.sel(sam_fraction=1.0)) == pytest.approx(np.sqrt(2.0), rel=0.05, abs=0)
    assert 1.1 < float(ratio.sel(sam_fraction=0.8)) < np.sqrt(2.0)
    signal = gd.simulate(SCENE)
    for chart in (both, both.sel(torque=4.5e-18)):
        assert assess(signal, chart).sam_fraction == pytest.approx(1.0, abs=0.01)
    assert np.isnan(assess(signal, both.sel(torque=4.5e-18)).torque)
    assert assess(signal, both).torque == pytest.approx(4.5e-18, rel=0.01, abs=0)


def test_map_over_torque_by_its_name_alone():
    """Torques around the scene's; another speed than all of them is another torque than the map's."""
    chart = coating_map(SCENE, [1.0, 0.8, 0.6], over="drive.torque")
    assert np.allclose(chart.torque / 4.5e-18, [0.7, 0.85, 1.0, 1.15, 1.3], rtol=1e-12)
    # low-speed steady state: the speed goes with the square root of the torque, to what the adhesion takes
    speeds = chart.median_gear_speed.sel(sam_fraction=1.0)
    assert np.allclose(speeds / 1.5, np.sqrt(chart.torque / 4.5e-18), rtol=2e-3)
    assessment = assess(gd.simulate(SCENE.replace({"drive.torque": 9e-18})), chart)
    assert assessment.verdict == "does not fit"
    assert "another torque" in assessment.explanation
    with pytest.raises(gd.SceneError, match="needs a drive torque above zero"):
        coating_map(SCENE.replace({"drive.torque": 0.0}), [1.0, 0.8], over="drive.torque")


def test_lines_over_another_key_are_to_be_picked():
    chart = coating_map(SCENE, [1.0, 0.8], over={"load.drag": [8e-18, 9e-18]})
    with pytest.raises(gd.SceneError, match=r"pick the signal's with .sel\(drag=...\)"):
        assess(gd.simulate(SCENE), chart)


def test_map_survives_the_disk(chart, tmp_path):
    save(chart, tmp_path / "map.nc")
    assert open_map(tmp_path / "map.nc").identical(chart)


def test_assessment_reads_as_a_sentence(chart, worn):
    assessment = assess(worn, chart)
    assert assessment.conclusive
    assert assessment.sam_fraction == pytest.approx(0.65, abs=0.005)  # between the map's points 0.1 apart
    assert assessment.low < assessment.sam_fraction < assessment.high
    assert assessment.uncertainty == 0.25 * (assessment.high - assessment.low)
    assert str(assessment).startswith("SAM fraction 0.6")


def test_signal_files(chart, worn, tmp_path):
    reference = assess(worn.gear_speed, chart)
    save(worn, tmp_path / "run.nc")
    assert_same(assess(tmp_path / "run.nc", chart), assess(worn, chart))
    columns = np.column_stack([worn.time * 1e3, np.zeros(worn.sizes["time"]), worn.gear_speed * 30.0 / np.pi])
    for name, separator in (("comma.csv", ","), ("semicolon.csv", ";"), ("tab.txt", "\t")):
        heading = separator.join(["# from the rig\ntime [ms]", "other", "gear_speed (rpm)"])
        np.savetxt(tmp_path / name, columns, fmt="%.10g", delimiter=separator, header=heading, comments="")
        assessment = assess(str(tmp_path / name), chart)
        assert assessment.frequencies[:5] == pytest.approx(reference.frequencies[:5], rel=1e-4, abs=0)


def test_one_impact_of_a_worn_contact_is_ambiguous_without_its_history(worn):
    impact = worn.gear_speed.sel(time=slice(0.18, 0.22))
    assessment = assess(impact, coating_map(SCENE, [0.8, 0.7, 0.6, 0.5]), history="unknown")
    assert assessment.verdict == "ambiguous"
    assert np.isnan(assessment.sam_fraction)
    assert assessment.low < 0.65 < assessment.high


@pytest.mark.parametrize(
    ("change", "verdict", "words"),
    [
        ({"coating.sam_fraction": 0.5}, "outside the map", "higher than the map's most worn coating"),
        ({"drive.torque": 2e-18}, "outside the map", "lower than anything in the map"),
        ({"load.drag": 4e-18, "initial.gear_speed": 2.12}, "does not fit", "rad/s where the map has 1.5"),
        ({"run.duration": 0.02}, "no impacts", "does not turn through a mesh impact"),
    ],
)
def test_what_a_signal_cannot_tell_is_said(change, verdict, words, chart):
    assessment = assess(gd.simulate(SCENE.replace(change)), chart)
    assert assessment.verdict == verdict, assessment
    assert not assessment.conclusive
    assert np.isnan(assessment.sam_fraction)
    assert words in assessment.explanation


def test_noise_alone_has_no_impacts(chart, worn):
    noise = xr.full_like(worn.gear_speed, 1.5) + 1e-2 * np.random.default_rng(0).standard_normal(
        worn.sizes["time"]
    )
    assessment = assess(noise, chart)
    assert assessment.verdict == "no impacts"
    assert "above the noise" in assessment.explanation


def test_slow_sampling_is_pointed_out(chart, worn):
    assessment = assess(worn.gear_speed.isel(time=slice(None, None, 13)), chart)  # 7.7 kHz
    assert "sampled at 7.69e+03 Hz" in assessment.explanation


def test_a_sensor_that_counts_backward(chart, worn):
    speed = worn.gear_speed.isel(time=slice(None, None, 2))
    known, reversed_sign = assess(speed, chart), assess(-speed, chart)
    assert known.conclusive
    assert_same(
        reversed_sign,
        replace(known, explanation=f"{known.explanation}; the speed is taken with its sign reversed"),
    )


HEADING = "time [s], gear_speed [rad/s]"
ROWS = "\n".join(f"{n * 1e-4:.4f}, 1.5" for n in range(20))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "is empty"),
        (f"time, gear_speed\n{ROWS}", "'time' states no unit"),
        (f"time [s], gear_speed []\n{ROWS}", "'gear_speed' states no unit"),
        (f"time [s], other [m]\n{ROWS}", "has no column gear_speed"),
        (f"time [s], gear_speed [flurb]\n{ROWS}", "is not a known unit"),
        (f"time [s], gear_speed [m/s]\n{ROWS}", "does not fit"),
        (f"time [s], gear_speed [rad/s], speed [rad/s]\n{ROWS}", "two columns for gear_speed"),
        (
            f"{HEADING}\n{ROWS}\n0.002, fast",
            r"line 22: column 'gear_speed \[rad/s\]', row 21 is 'fast', no number",
        ),
        (f"{HEADING}\n{ROWS}\n0.002", "line 22: row 21 has 1 cell, but there are 2 headings"),
        (f"{HEADING}\n{ROWS}\n0.002, nan\n0.0021, 1.5", r"sample 20 \(0.002 s\) is missing"),
        (f"{HEADING}\n{ROWS}\n0.1, 1.5", "off the uniform grid"),
        (f"{HEADING}\n0, 1.5", "16 samples or more"),
    ],
)
def test_bad_files_are_refused_with_a_reason(text, message, chart, tmp_path):
    path = tmp_path / "signal.csv"
    path.write_text(text)
    with pytest.raises(gd.SceneError, match=message):
        assess(path, chart)


def test_bad_binary_files_are_refused(chart, worn, tmp_path):
    with pytest.raises(gd.SceneError, match="cannot be read"):
        assess(tmp_path / "none.csv", chart)
    (tmp_path / "bytes.csv").write_bytes(b"\xfe\x00\x81")
    with pytest.raises(gd.SceneError, match="is no text"):
        assess(tmp_path / "bytes.csv", chart)
    save(worn, tmp_path / "run.nc")
    whole = (tmp_path / "run.nc").read_bytes()
    (tmp_path / "cut.nc").write_bytes(whole[: len(whole) // 3])
    with pytest.raises(gd.SceneError, match="is damaged"):
        assess(tmp_path / "cut.nc", chart)
    worn[["gear_speed"]].drop_attrs().to_netcdf(tmp_path / "bare.nc")
    with pytest.raises(gd.SceneError, match="does not state the units of time"):
        assess(tmp_path / "bare.nc", chart)
    worn[["pinion_speed"]].to_netcdf(tmp_path / "pinion.nc")
    with pytest.raises(gd.SceneError, match="lacks the variable gear_speed"):
        assess(tmp_path / "pinion.nc", chart)
    with pytest.raises(gd.SceneError, match="is no coating map: it lacks characteristic_frequency"):
        open_map(tmp_path / "run.nc")
    with pytest.raises(gd.SceneError, match="no such file"):
        open_map(tmp_path / "none.nc")


def test_wrong_arguments_are_named(chart, worn):
    with pytest.raises(gd.SceneError, match="lacks characteristic_frequency"):
        assess(worn, worn)
    with pytest.raises(gd.SceneError, match="must be a Dataset from coating_map"):
        assess(worn, "map.nc")
    with pytest.raises(gd.SceneError, match="history = perhaps"):
        assess(worn, chart, history="perhaps")
    two = xr.concat([worn.gear_speed, worn.gear_speed], dim="torque")
    with pytest.raises(gd.SceneError, match="must be one run"):
        assess(two, chart)
    with pytest.raises(gd.SceneError, match="at least two fractions"):
        assess(worn, chart.isel(sam_fraction=[0]))
    with pytest.raises(gd.SceneError, match="must be a scene with gears"):
        coating_map(gd.preset("roller_slow"))
    with pytest.raises(gd.SceneError, match="is the map's own axis"):
        coating_map(SCENE, over={"coating.sam_fraction": [1.0]})
    with pytest.raises(gd.SceneError, match="must be a list of numbers"):
        coating_map(SCENE, "all")
    with pytest.raises(gd.SceneError, match=r"coating\.sam_fraction"):
        coating_map(SCENE, [1.5])


@pytest.mark.parametrize(
    ("over", "message"),
    [
        ("load.drag", 'must be "drive.torque" or a table'),
        (["drive.torque"], 'must be "drive.torque" or a table'),
        ({"drive.torque": 4e-18}, "must be a list of values"),
        ({"drive.torque": "4e-18 N m"}, "must be a list of values"),
        ({"drive.torque": []}, "must be a list of at least one value"),
    ],
)
def test_wrong_further_keys_are_named(over, message):
    with pytest.raises(gd.SceneError, match=message):
        coating_map(SCENE, [1.0, 0.8], over=over)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda chart: chart.assign_attrs(width=np.array([1, 2])), "width must be a number"),
        (lambda chart: chart.assign_attrs(width="wide"), "width must be a number"),
        (lambda chart: chart.assign_attrs(scene=b"\x00"), "does not say how many teeth"),
        (lambda chart: chart.assign(uncertainty="sam_fraction"), "its uncertainty must be numbers"),
        (lambda chart: chart.drop_vars("sam_fraction"), "its sam_fraction must be numbers"),
        (
            lambda chart: chart.assign(impact_frequency=chart.impact_frequency.isel(impact=0, drop=True)),
            "impact_frequency must have the dimension impact",
        ),
        (lambda chart: chart.assign(impact_frequency=-chart.impact_frequency), "must be above zero"),
        (lambda chart: xr.concat([chart, chart], dim="sam_fraction"), "holds a fraction twice"),
        (lambda chart: chart.assign(median_gear_speed=0.0 * chart.median_gear_speed), "the gear turns"),
    ],
)
def test_damaged_maps_are_named(change, message, chart, worn):
    with pytest.raises(gd.SceneError, match=message):
        assess(worn, change(chart))


@pytest.mark.parametrize("cutoff", [0.0, -1.0, float("nan"), "high", [1.0, 2.0]])
def test_a_filter_is_a_frequency(cutoff, chart, worn):
    with pytest.raises(gd.SceneError, match="anti_alias_filter = "):
        assess(worn, chart, anti_alias_filter=cutoff)


def test_assessment_shows_itself_in_a_notebook(chart, worn):
    assessment = assess(worn, chart)
    shown = assessment._repr_html_()
    assert f"<b>{assessment.verdict}</b>" in shown
    assert f"{assessment.low:.4g} to {assessment.high:.4g}" in shown
    assert with_prefix(assessment.frequencies[0], "Hz", 4) in shown
    unknown = replace(assessment, sam_fraction=math.nan, low=math.nan, high=math.nan, explanation="<a & b>")
    shown = unknown._repr_html_()
    assert "interval" not in shown
    assert "&lt;a &amp; b&gt;" in shown
