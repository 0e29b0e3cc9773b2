"""Operating maps: each place says what the run there does."""

from __future__ import annotations

import numpy as np
import pytest

import gearidae as gd
from gearidae.analysis.verdict import outcomes
from gearidae.analysis.verdict.codes import Outcome
from gearidae.cli import main
from gearidae.records import EventKind

RATTLING = gd.preset("teodorescu2009_low_speed").replace(
    {"run.duration": 0.06, "drive.harmonic": {"amplitude": 0.0, "frequency": "1 kHz"}}
)
OVER = {"drive.harmonic.amplitude": [0.0, 1e-16, 2e-15], "coating.sam_fraction": [0.9, 1.0]}


@pytest.fixture(scope="module")
def chart():
    return gd.studies.operating_map(RATTLING, OVER)


def test_a_sweep_that_kept_the_same_is_no_operating_map(tmp_path):
    short = RATTLING.replace({"run.duration": 1e-4})
    gd.sweep(short, OVER, keep="extremes", archive=tmp_path / "sweep.nc")
    with pytest.raises(gd.SceneError, match="of another sweep"):
        gd.studies.operating_map(short, OVER, archive=tmp_path / "sweep.nc", resume=True)


def test_a_stronger_harmonic_makes_the_teeth_cross_and_then_stick(chart):
    """A run with its events says the same: changes of flank, and the verdict."""
    assert chart.outcome.dims == ("amplitude", "sam_fraction")
    expected = [Outcome.TURNS, Outcome.CROSSES_BACKLASH, Outcome.STICKS]
    assert chart.outcome.sel(sam_fraction=1.0).values.tolist() == expected
    for amplitude in OVER["drive.harmonic.amplitude"]:
        run = gd.simulate(RATTLING.replace({"drive.harmonic.amplitude": amplitude}))
        (outcome,) = outcomes(run)
        place = chart.sel(amplitude=amplitude, sam_fraction=1.0)
        assert int(place.flank_changes) == int((run.event_kind == EventKind.FLANK_CHANGE).sum())
        assert place.verdict.item() == outcome.verdict
        assert place.gearidae.scene.drive.harmonic[0].amplitude == amplitude


@pytest.mark.parametrize("over", [{}, {"drive.torque": [1e-18]}, OVER | {"drive.torque": [1e-18]}, None, 3])
def test_it_takes_two_keys(over):
    with pytest.raises(gd.SceneError) as refused:
        gd.studies.operating_map(RATTLING, over)
    assert refused.value.key == "over"


def test_it_takes_gears():
    with pytest.raises(gd.SceneError, match="with gears"):
        gd.studies.operating_map(gd.preset("roller_slow"), {"roller.speed": [0.01], "roller.height": [1e-8]})


def test_the_picture_has_a_cell_for_each_run(chart):
    ax = gd.plot.outcome_map(chart)
    (cells,) = ax.collections
    assert np.array_equal(cells.get_array().reshape(3, 2), chart.outcome.values)
    words = [text.get_text() for text in ax.get_legend().get_texts()]
    assert words == ["turns", "crosses the backlash", "sticks"]
    assert ax.get_xlabel() == "SAM (%)"
    assert ax.get_xlim()[1] <= 100.0  # a cell reaches beyond its value, a share does not
    stuck = (chart.outcome == Outcome.STICKS) & (chart.flank_changes > 0)
    assert len(ax.get_lines()[0].get_xdata()) == int(stuck.sum()) > 0
    ax.figure.canvas.draw()
    with pytest.raises(gd.SceneError, match="operating map"):
        gd.plot.outcome_map(chart.drop_vars("outcome"))


def test_keys_that_are_words_and_falling_values_are_drawn(chart):
    laws = gd.studies.operating_map(
        RATTLING.replace({"run.duration": 1e-3}),
        {"contact.asperity": ["jkr", "dmt"], "coating.sam_fraction": [1.0, 0.9]},
    )
    ax = gd.plot.outcome_map(laws)
    assert [text.get_text() for text in ax.get_yticklabels()] == ["jkr", "dmt"]
    ax.figure.canvas.draw()
    turned = gd.plot.outcome_map(chart.isel(amplitude=slice(None, None, -1)))
    assert np.array_equal(turned.collections[0].get_array().reshape(3, 2), chart.outcome.values)


def test_the_command(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    command = [
        *("operating-map", "teodorescu2009_low_speed", "--set", "run.duration=2 ms"),
        *("--over", "drive.torque=4e-18,4.5e-18", "coating.sam_fraction=1,0.9,0.8"),
    ]
    assert main(command) == 0
    printed = capsys.readouterr().out
    assert "..." in printed
    assert "turns: 6" in printed
    assert main(["plot", "teodorescu2009_low_speed_operating_map.nc", "-o", "map.png"]) == 0
    assert (tmp_path / "map.png").exists()
