"""Outcomes against what was swept, and which runs of a large sweep are shown."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.collections import LineCollection, PolyCollection

import gearidae as gd
from gearidae.cli import main
from gearidae.drawing.picking import pick
from gearidae.plot.outcome import outcome

LOW = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 0.1, "run.samples": 201})
FRACTIONS = [1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.46, 0.42, 0.38, 0.34]


@pytest.fixture(scope="module")
def sweep():
    return gd.sweep(LOW, {"coating.sam_fraction": FRACTIONS}, jobs=1)


@pytest.fixture(scope="module")
def grid():
    """Two keys, from the steep to the flat, and nothing but verdicts kept."""
    keys = {"coating.sam_fraction": [0.34, 1.0, 0.42], "drive.torque": [3e-18, 4.5e-18]}
    return gd.sweep(LOW, keys, keep=["min_gear_speed"], jobs=1)


def test_bars_reach_over_the_speeds_and_marks_tell_the_verdict(sweep):
    ax = gd.plot.outcome(sweep)
    judged = gd.outcomes(sweep)
    verdicts = [judgement.verdict for judgement in judged]
    assert {"turns smoothly", "sticks"} <= set(verdicts)
    (bars,) = (artist for artist in ax.collections if isinstance(artist, LineCollection))
    for judgement, bar in zip(judged, bars.get_segments(), strict=True):
        np.testing.assert_allclose(bar[:, 0], 100.0 * judgement.label["sam_fraction"])
        np.testing.assert_allclose(bar[:, 1], [judgement.min_speed, judgement.max_speed])
    marks = {line.get_label(): line for line in ax.get_lines() if line.get_label() in verdicts}
    assert len({line.get_marker() for line in marks.values()}) == len(set(verdicts))
    for verdict, line in marks.items():
        percents = [
            100.0 * judgement.label["sam_fraction"] for judgement in judged if judgement.verdict == verdict
        ]
        np.testing.assert_allclose(line.get_xdata(), percents)
    changes = [line.get_xdata()[0] for line in ax.get_lines() if line.get_linestyle() == ":"]
    expected = [
        50.0 * (fraction + other)
        for fraction, other, a, b in zip(FRACTIONS, FRACTIONS[1:], verdicts, verdicts[1:], strict=False)
        if a != b
    ]
    assert sorted(changes) == pytest.approx(sorted(expected))


def test_fields_over_two_keys_need_no_samples(grid):
    ax = gd.plot.outcome(grid)
    assert ax.get_xlabel() == "torque (aN m)"
    assert ax.get_ylabel() == "SAM (%)"
    assert [label.get_text() for label in ax.get_yticklabels()] == ["34", "42", "100"]
    assert [label.get_text() for label in ax.get_xticklabels()] == ["3", "4.5"]
    shown, edges = {}, set()
    names = [text.get_text() for text in ax.get_legend().get_texts()]
    fields = [artist for artist in ax.collections if isinstance(artist, PolyCollection)]
    for name, field in zip(names, fields, strict=True):
        for path in field.get_paths():
            left, bottom = path.vertices[:4].min(axis=0)
            right, top = path.vertices[:4].max(axis=0)
            (percent,) = (value for value in (34, 42, 100) if bottom < value < top)
            (torque,) = (value for value in (3.0, 4.5) if left < value < right)
            shown[percent, {3.0: 3e-18, 4.5: 4.5e-18}[torque]] = name
            edges |= {bottom, top}
    # limits lie in the middle between two values, whatever their distance
    assert sorted(edges) == pytest.approx([30.0, 38.0, 71.0, 129.0])
    assert ax.get_ylim() == pytest.approx((30.0, 100.0))
    assert len({artist.get_hatch() for artist in fields}) == len(fields)  # told apart without colours
    for judgement in gd.outcomes(grid):
        assert (
            shown[round(100 * judgement.label["sam_fraction"]), judgement.label["torque"]]
            == judgement.verdict
        )
    ax.figure.canvas.draw()


def test_the_command_draws_outcomes_where_there_are_no_samples(grid, tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    gd.save(grid, "grid.nc")
    drawn = []
    monkeypatch.setattr(gd.plot, "outcome", lambda ds: drawn.append(ds) or outcome(ds))
    assert main(["plot", "grid.nc"]) == 0
    assert len(drawn) == 1
    assert (tmp_path / "grid.png").is_file()
    capfd.readouterr()


def test_rollers_and_words(sweep):
    scene = gd.preset("roller_slow").replace({"run.samples": "off"})
    ds = gd.sweep(scene, {"contact.asperity": ["jkr", "hertz"]}, jobs=1)
    ax = gd.plot.outcome(ds)
    assert [label.get_text() for label in ax.get_xticklabels()] == ["jkr", "hertz"]
    assert ax.get_ylabel().startswith("largest pull and push (")
    with pytest.raises(gd.SceneError, match="0 swept keys"):
        gd.plot.outcome(sweep.isel(sam_fraction=0))
    with pytest.raises(gd.SceneError, match="holds no runs: it is of a study"):
        gd.plot.outcome(gd.studies.pull_off(scene, 2, load=1e-6, jobs=1))


def test_pictures_show_the_runs_at_which_the_outcome_changes(sweep):
    verdicts = [judgement.verdict for judgement in gd.outcomes(sweep)]
    begins = next(number for number, judgement in enumerate(verdicts) if judgement == "sticks")
    shown = [text.get_text() for text in gd.plot.gear_speed(sweep).get_legend().get_texts()]
    assert len(shown) == 7
    for number in (0, begins - 1, begins, len(verdicts) - 1):
        assert f"SAM {100 * FRACTIONS[number]:.4g} %" in shown


def test_the_only_irregular_one_and_the_first_that_sticks_are_picked():
    """The sweep of the bug: 24 runs, the irregular one at an odd place."""
    verdicts = ["turns smoothly"] * 16 + ["irregular"] + ["sticks"] * 7
    assert {0, 15, 16, 17, 23} <= set(pick(verdicts, 7))


@given(st.lists(st.sampled_from(["turns smoothly", "irregular", "sticks"]), min_size=2, max_size=60))
def test_picked_are_as_many_as_allowed_the_ends_and_a_change(verdicts):
    picked = pick(verdicts, 7)
    assert picked == sorted(set(picked))
    assert len(picked) == min(7, len(verdicts))
    assert {0, len(verdicts) - 1} <= set(picked)
    begins = [
        n for n in range(1, len(verdicts)) if (verdicts[n] == "sticks") != (verdicts[n - 1] == "sticks")
    ]
    if begins:
        assert {begins[0] - 1, begins[0]} <= set(picked)
