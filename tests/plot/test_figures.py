"""Figures follow the settings of matplotlib and draw where they are told to; units and text."""

from __future__ import annotations

import inspect
import json
import re

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.figure import Figure
from PIL import Image

import gearidae as gd
from gearidae.analysis.verdict import outcomes
from gearidae.cli import main
from gearidae.cli.pictures import picture_names
from gearidae.drawing.parameter_axis import cell_edges, is_logarithmic, parameter_axis
from gearidae.drawing.style import COLOURS, runs_of

LOW = gd.preset("teodorescu2009_low_speed")


@pytest.fixture(scope="module")
def swept():
    return gd.sweep(LOW, {"coating.sam_fraction": [1.0, 0.5]}, t_end=0.06, samples=2401, jobs=1)


@pytest.mark.parametrize("name", picture_names())
def test_every_picture_draws_where_it_is_told(name):
    parameters = inspect.signature(getattr(gd.plot, name)).parameters
    assert {"ax", "figure"} & {*parameters}


def test_pictures_of_several_panels_draw_into_a_part_of_a_figure(swept):
    whole = Figure(figsize=(10, 6), layout="constrained")
    left, right = whole.subfigures(1, 2)
    assert gd.plot.overview(swept, figure=left) is left
    assert len(left.axes) == 2
    assert right.axes == []
    scan = np.random.default_rng(1).normal(0.0, 1e-8, (64, 64))
    statistics = gd.surface_from(scan, size=1e-6).statistics
    assert gd.plot.surface(statistics, figure=right) is right
    assert len(right.axes) == 3


def test_a_style_holds_in_its_block(swept):
    before = dict(mpl.rcParams)
    with gd.plot.style("journal", columns=1):
        figure = gd.plot.gear_speed(swept).figure
        assert figure.get_size_inches().tolist() == [3.4, 2.4]
        wide, high = gd.plot.overview(swept).get_size_inches()
        assert wide == 3.4
        usual = 7.6, 3.2 + 0.8 + 0.62 * 2  # panels keep their shape
        assert high == pytest.approx(3.4 * usual[1] / usual[0])
    assert dict(mpl.rcParams) == before
    with gd.plot.style("journal", columns=2):
        assert gd.plot.outcome(swept).figure.get_figwidth() == 7.0
    with mpl.rc_context():
        gd.plot.style("journal")  # without a block it stays
        assert gd.plot.outcome(swept).figure.get_figwidth() == 3.4
    assert gd.plot.outcome(swept).figure.get_figwidth() == 7.2


@pytest.mark.parametrize(
    ("options", "named"), [({"columns": 3}, "columns"), ({"name": "no/such.mplstyle"}, "style")]
)
def test_styles_that_there_are_not(options, named):
    before = dict(mpl.rcParams)
    with pytest.raises(gd.SceneError, match=f"^{named} = "):
        gd.plot.style(**options)
    assert dict(mpl.rcParams) == before


def test_lines_follow_the_settings(swept, tmp_path):
    def lines():
        return {line.get_label(): line for line in gd.plot.gear_speed(swept).get_lines()}

    usual = lines()
    file = tmp_path / "mine.mplstyle"
    file.write_text(
        "lines.linewidth: 3\naxes.prop_cycle: cycler('color', ['112233', '445566'])\nbackend: pdf\n"
    )
    backend = mpl.rcParams["backend"]
    with gd.plot.style(file):
        mine = lines()
        assert mpl.rcParams["backend"] == backend
    for number, label in enumerate(("SAM 100 %", "SAM 50 %")):
        assert mine[label].get_linewidth() == pytest.approx(2.0 * usual[label].get_linewidth())
        assert usual[label].get_color() == COLOURS[number]
        assert mine[label].get_color() == ("#112233", "#445566")[number]
        assert mine[label].get_linestyle() == usual[label].get_linestyle()
    with gd.plot.style("ggplot"):
        assert lines()["SAM 100 %"].get_color() == mpl.rcParams["axes.prop_cycle"].by_key()["color"][0]


def test_legends_fit_their_figure(swept):
    with gd.plot.style("journal"):
        figure = gd.plot.gear_speed(swept).figure
        figure.canvas.draw()
        box = figure.axes[0].get_legend().get_window_extent()
        assert box.x1 <= figure.bbox.x1


@pytest.mark.parametrize("ending", ["svg", "pdf"])
def test_text_stays_text(swept, ending, tmp_path):
    ax = gd.plot.gear_speed(swept)
    with gd.plot.style("journal"):
        path = gd.plot.write(ax.figure, tmp_path / f"speed.{ending}")
    if ending == "svg":
        assert re.search(r"<text[^>]*>gear speed \(rad/s\)</text>", path.read_text(encoding="utf-8"))
    else:
        assert b"/FontFile2" in path.read_bytes()  # TrueType


def test_units_stand_once(swept):
    run = swept.sel(sam_fraction=0.5)
    drawn = [
        (gd.plot.power_spectrum(run).xaxis, "Hz"),
        (gd.plot.impact_spectrum(run).xaxis, "Hz"),
        (gd.plot.spectrogram(run).yaxis, "Hz"),
    ]
    for axis, unit in drawn:
        axis.axes.figure.canvas.draw()
        assert re.search(rf"\(.?{unit}\)$", axis.get_label_text())
        numbers = [label.get_text() for label in axis.get_ticklabels() if label.get_text()]
        assert numbers
        assert all(re.fullmatch(r"[-0-9.e\u2212]+", number) for number in numbers)
    spectrum = drawn[0][0]
    factor = {"Hz": 1.0, "kHz": 1e-3}[spectrum.get_label_text().split("(")[1][:-1]]
    place = float(spectrum.get_ticklocs()[1])
    assert float(spectrum.get_major_formatter()(place)) == pytest.approx(place * factor, rel=1e-5)


def test_size_and_resolution_on_the_command_line(swept, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    gd.save(swept, "two.nc")
    for picture in ("overview", "outcome"):
        options = ["--size", "3.4 in, 60 mm", "--dpi", "100", "--style", "journal", "--picture", picture]
        assert main(["plot", "two.nc", *options, "-o", f"{picture}.png"]) == 0
        with Image.open(f"{picture}.png") as image:
            assert image.size == (340, 236)
    assert main(["plot", "two.nc", "-o", "usual.png"]) == 0
    with Image.open("usual.png") as image:
        assert image.size[0] == 1520  # 7.6 inches at 200 dots, whatever was drawn before
    (tmp_path / "mine.mplstyle").write_text("figure.figsize: 4, 3\n")
    assert main(["plot", "two.nc", "--picture", "outcome", "--style", "mine.mplstyle", "-o", "mine.png"]) == 0
    with Image.open("mine.png") as image:
        assert image.size == (800, 600)
    capsys.readouterr()
    wrong = (
        ("--size", "3 in"),
        ("--size", "3 s, 4 s"),
        ("--size", "3, 4"),
        ("--dpi", "0"),
        ("--style", "none"),
    )
    for option, value in wrong:
        assert main(["plot", "two.nc", option, value, "-o", "no.png"]) == 2
        assert option.removeprefix("--") in capsys.readouterr().err


def test_uneven_steps_have_a_logarithmic_axis():
    def axis(values):
        ds = gd.sweep(LOW, {"drive.torque": values}, t_end=1e-6, keep=["verdict"], jobs=1)
        return parameter_axis(ds["torque"])

    even, uneven = axis([3e-18, 4e-18, 6e-18]), axis([1e-18, 1e-17, 1e-15])
    assert not is_logarithmic(even)
    assert cell_edges(even) == pytest.approx([2.5, 3.5, 5.0, 7.0])
    assert is_logarithmic(uneven)
    middles = np.sqrt(uneven.positions[1:] * uneven.positions[:-1])
    assert cell_edges(uneven)[1:-1] == pytest.approx(middles)


def test_an_ensemble_shows_what_its_members_did():
    short = LOW.replace({"run.duration": 0.1})
    ds = gd.studies.ensemble(short, {"coating.sam_fraction": "uniform(0.3, 0.7)"}, 8, jobs=1)
    ax = gd.plot.sticking_probability(ds)
    marks = {
        line.get_label(): line for line in ax.get_lines() if re.search(r" \(\d+\)$", str(line.get_label()))
    }
    judged = outcomes(ds)
    verdicts = [outcome.verdict for outcome in judged]
    assert {*marks} == {f"{verdict} ({verdicts.count(verdict)})" for verdict in verdicts}
    assert len({*verdicts}) > 1
    for label, line in marks.items():
        verdict = label.rpartition(" (")[0]
        mine = [verdict == other for other in verdicts]
        np.testing.assert_allclose(line.get_xdata(), 100.0 * ds.sam_fraction.values[mine], rtol=1e-12)
        assert (np.asarray(line.get_ydata()) > 1.0).all() == (verdict in ("sticks", "runs back"))


def test_a_gear_driven_by_a_law_is_drawn_from_its_first_instant():
    ds = gd.simulate(LOW, t_end=0.003, samples=61)
    scene = json.loads(ds.attrs["scene"])
    scene["drive"]["law"] = {"name": "microengine"}
    (driven,), (plain,) = (
        runs_of(each, "gear_contact_torque") for each in (ds.assign_attrs(scene=json.dumps(scene)), ds)
    )
    torque = ds.gear_contact_torque.values
    whole = driven.settled("gear_contact_torque")
    assert (whole.number, whole.low, whole.high) == (torque.size, torque.min(), torque.max())
    assert plain.settled("gear_contact_torque").number < torque.size  # the start-up is left out
