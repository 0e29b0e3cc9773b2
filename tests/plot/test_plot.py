"""Pictures: they show the numbers of the dataset, in a readable unit, and leave no trace in matplotlib."""

from __future__ import annotations

import itertools
import sys
import warnings

import matplotlib as mpl
import numpy as np
import pytest
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import gearidae as gd
from gearidae.archive import combine, to_dataset
from gearidae.archive import pieces as pieces_module
from gearidae.drawing import style
from gearidae.drawing.style import scale_for, thin
from gearidae.records import GEAR_COLUMNS, ROLLER_COLUMNS, Events, Solution, Statistics

LOW = gd.preset("teodorescu2009_low_speed").replace({"run.samples": 1001})
ROLLER = gd.preset("roller_slow").replace({"run.samples": 1001})
GEAR_PICTURES = [gd.plot.gear_speed, gd.plot.contact_torque, gd.plot.transmission_error, gd.plot.gap]
ROLLER_PICTURES = [gd.plot.roller_force, gd.plot.roller_gap]


def solution_of(scene, *, reached=1.0):
    """Motion of plausible size, larger and livelier the less monolayer there is."""
    time = np.linspace(0.0, scene.run.duration, scene.run.samples)[: round(reached * scene.run.samples)]
    wave = (1.1 - scene.coating.sam_fraction) * np.sin(60.0 * time / scene.run.duration)
    size = {"height": 4e-8, "speed": 1e-2, "force": 2e-5, "gear_speed": 1.5, "gear_contact_torque": 1e-16,
            "transmission_error": 7e-8, "drive_gap": 3e-8, "coast_gap": 2e-7}  # fmt: skip
    names = GEAR_COLUMNS if scene.roller is None else ROLLER_COLUMNS
    samples = {name: size.get(name, 1.0) * (0.2 + wave) for name in names}
    none = np.empty(0)
    events = Events(none, none.astype(np.int8), none.astype(np.int64), none.astype(np.int8), none)
    statistics = Statistics(1, 1, 1, 0, 0, 0, 1, 0.1, "native")
    return Solution(time, samples, events, statistics, "finished", "")


def sweep_of(scene, fractions, **options):
    scenes = [scene.replace({"coating.sam_fraction": fraction}) for fraction in fractions]
    return combine(
        scene,
        {"coating.sam_fraction": fractions},
        scenes,
        [solution_of(member, **options) for member in scenes],
    )


@pytest.fixture
def single():
    return to_dataset(LOW, solution_of(LOW))


@pytest.fixture
def sweep():
    return sweep_of(LOW, [1.0, 0.8, 0.5, 0.45])


@pytest.fixture
def roller():
    return sweep_of(ROLLER, [1.0, 0.0])


def legend_of(ax):
    return [text.get_text() for text in ax.get_legend().get_texts()]


def test_a_picture_of_many_runs_says_how_many_it_shows(sweep):
    many = sweep_of(LOW, np.linspace(1.0, 0.45, 12).tolist())
    assert gd.plot.gear_speed(many).get_legend().get_title().get_text() == "7 of 12 runs"
    assert ", 7 of 12 runs" in gd.plot.contact_torque(many).get_title(loc="left")
    assert gd.plot.gear_speed(sweep).get_legend().get_title().get_text() == ""


@pytest.mark.parametrize("length", [1, 20, 60])
def test_legends_of_long_names_stay_on_the_picture(length):
    names = [f"{number} {'longest ' * length}"[:length] for number in range(10, 17)]
    scenes = [LOW.replace({"name": name}) for name in names]
    ds = combine(LOW, {"name": names}, scenes, [solution_of(member) for member in scenes])
    for draw in (gd.plot.gear_speed, gd.plot.power_spectrum, gd.plot.overview):
        figure = draw(ds)
        figure = figure if isinstance(figure, Figure) else figure.get_figure(root=True)
        figure.draw_without_rendering()
        width = figure.bbox.width
        for ax in figure.axes:
            if ax.get_legend() is not None:
                box = ax.get_legend().get_window_extent()
                assert (box.x0 >= 0.0, box.x1 <= width) == (True, True)


def test_lines_are_the_samples_in_the_unit_of_the_axis(single):
    ax = gd.plot.transmission_error(single)
    line = ax.get_lines()[0]
    assert ax.get_xlabel() == "time (ms)"
    assert ax.get_ylabel() == "transmission error (nm)"
    assert np.allclose(line.get_xdata() * 1e-3, single.time, rtol=1e-14, atol=0.0)
    assert np.allclose(line.get_ydata() * 1e-9, single.transmission_error, rtol=1e-14, atol=0.0)


@pytest.mark.parametrize("draw", GEAR_PICTURES)
def test_every_picture_of_gears_draws_into_given_axes(draw, single, sweep):
    for ds in (single, sweep):
        ax = Figure().add_subplot()
        assert draw(ds, ax) is ax
        assert isinstance(draw(ds), Axes)


@pytest.mark.parametrize("draw", ROLLER_PICTURES)
def test_every_picture_of_a_roller_draws_into_given_axes(draw, roller):
    ax = Figure().add_subplot()
    assert draw(roller, ax) is ax
    assert legend_of(ax) == ["SAM 100 %", "SAM 0 %"]
    first, second = ax.get_lines()[:2]
    assert first.get_linestyle() != second.get_linestyle()  # told apart without colours


def test_legend_names_the_runs_in_their_order_though_the_calm_ones_are_drawn_last(sweep):
    ax = gd.plot.gear_speed(sweep)
    assert legend_of(ax) == ["SAM 100 %", "SAM 80 %", "SAM 50 %", "SAM 45 %"]
    assert [line.get_label() for line in ax.get_lines()[:4]] == [
        "SAM 45 %",
        "SAM 50 %",
        "SAM 80 %",
        "SAM 100 %",
    ]
    assert gd.plot.gear_speed(sweep.sel(sam_fraction=0.5)).get_legend() is None


def test_other_swept_keys_are_named_with_their_unit():
    swept = {"drive.torque": [4e-18, 5e-18]}
    scenes = [LOW.replace({"drive.torque": torque}) for torque in swept["drive.torque"]]
    ds = combine(LOW, swept, scenes, [solution_of(scene) for scene in scenes])
    assert legend_of(gd.plot.gear_speed(ds)) == ["torque 4 aN m", "torque 5 aN m"]


def test_at_most_seven_runs_first_and_last_among_them():
    ds = sweep_of(LOW, np.linspace(1.0, 0.4, 31).tolist())
    shown = legend_of(gd.plot.gear_speed(ds))
    assert len(shown) == 7
    assert (shown[0], shown[-1]) == ("SAM 100 %", "SAM 40 %")


def test_every_line_of_a_sweep_has_a_style_of_its_own(sweep):
    """Told apart in grey print: solid, dashed, dotted and so on, in the picture and in its legend."""
    for draw in (gd.plot.gear_speed, gd.plot.transmission_error, gd.plot.gap):
        ax = draw(sweep)
        for lines in (ax.get_lines()[:4], ax.get_legend().get_lines()):
            assert len({str(line._unscaled_dash_pattern) for line in lines}) == 4


def test_torque_scale_is_not_set_by_the_start_up(single):
    single["gear_contact_torque"][:10] = 1e-12
    ax = gd.plot.contact_torque(single)
    assert ax.get_ylabel().endswith("(aN m)")
    settled = single.gear_contact_torque.values[50:] * 1e18
    low, high = ax.get_ylim()
    assert low < settled.min() < settled.max() < high < 1.2 * settled.max()


def test_the_torque_axis_shows_a_run_up(single):
    """Of a schedule from rest the beginning is what it was made for; of gears that move it is a blow."""
    for speed in (0.0, 1.5):
        scene = LOW.replace({"drive.schedule": [[0.0, 0.0], [1e-2, 1e-18]], "initial.gear_speed": speed})
        ds = to_dataset(scene, solution_of(scene))
        ds["gear_contact_torque"][:] = 1e-16
        ds["gear_contact_torque"][:5] = np.linspace(-4e-16, 1e-16, 5)
        low, high = gd.plot.contact_torque(ds).get_ylim()
        assert (low < -400.0) == (speed == 0.0)  # aN m
        assert high > 100.0


def test_a_picture_says_that_a_run_is_not_at_its_end(single):
    for status, said in (("finished", ""), ("interrupted", "; interrupted at 100 ms of 300 ms")):
        run = single.assign(reached=0.1).assign_attrs(status=status, t_end=0.3)
        for draw in GEAR_PICTURES:
            assert draw(run).get_xlabel() == f"time (ms){said}"
    ds = sweep_of(LOW, [1.0, 0.5])
    ds["status"][1] = "too_many_steps"
    assert gd.plot.gear_speed(ds).get_xlabel() == "time (ms); 1 of 2 runs are not at their end"


def test_torque_strips_do_not_overlap(sweep):
    ax = gd.plot.contact_torque(sweep)
    assert [label.get_text() for label in ax.get_yticklabels()] == legend_of(gd.plot.gear_speed(sweep))
    step = -np.diff(ax.get_yticks())[0]
    settled = sweep.gear_contact_torque.values[:, 50:] * 1e18
    assert np.ptp(settled) < step


def test_the_title_of_torque_strips_is_whole_and_names_what_is_cut_off():
    many = gd.plot.contact_torque(sweep_of(LOW, [1.0, 0.9, 0.8, 0.75, 0.7, 0.6, 0.5, 0.45]))
    many.figure.canvas.draw()
    title = many._left_title
    assert title.get_window_extent().x1 <= many.figure.bbox.x1
    assert "7 of 8 runs" in title.get_text()
    ds = sweep_of(LOW, [1.0, 0.5])
    assert "cut off" not in gd.plot.contact_torque(ds)._left_title.get_text()
    ds["gear_contact_torque"][0, 1] = 10.0 * float(abs(ds.gear_contact_torque).max())
    assert "start-up cut off" in gd.plot.contact_torque(ds)._left_title.get_text()


def test_runs_cut_short_are_drawn_to_their_end():
    ds = sweep_of(LOW, [1.0, 0.5])
    ds["gear_speed"][1, 300:] = np.nan
    lengths = {line.get_label(): len(line.get_xdata()) for line in gd.plot.gear_speed(ds).get_lines()}
    assert lengths["SAM 50 %"] == 300
    assert lengths["SAM 100 %"] == 1001


def test_runs_without_samples_are_left_out():
    ds = sweep_of(LOW, [1.0, 0.5])
    ds["gear_speed"][1] = np.nan
    assert gd.plot.gear_speed(ds).get_legend() is None
    ds["gear_speed"][0] = np.nan
    with pytest.raises(gd.SceneError, match="no samples"):
        gd.plot.gear_speed(ds)


def test_a_picture_of_what_is_not_there_is_refused(single, roller):
    with pytest.raises(gd.SceneError, match="gear_speed"):
        gd.plot.gear_speed(roller)
    with pytest.raises(gd.SceneError, match="force"):
        gd.plot.roller_force(single)
    with pytest.raises(gd.SceneError, match="sideways_gap"):
        gd.plot.gap(single, flank="sideways")


@pytest.mark.parametrize("name", ["single", "sweep", "roller"])
@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_overview_as_a_file(name, ending, request, tmp_path):
    figure = gd.plot.overview(request.getfixturevalue(name))
    path = gd.plot.write(figure, tmp_path / f"picture.{ending}")
    assert path.stat().st_size > 5000
    assert [entry.name for entry in tmp_path.iterdir()] == [f"picture.{ending}"]


def test_nothing_overlaps_in_the_overview(sweep):
    """Legend, titles, labels and axes each have a place of their own."""
    figure = gd.plot.overview(sweep)
    figure.canvas.draw()
    top, bottom = figure.axes
    boxes = {
        "heading": figure._suptitle.get_window_extent(),
        "legend": top.get_legend().get_window_extent(),
        "speed": top.get_window_extent(),
        "title": bottom.title.get_window_extent()
        if bottom.get_title()
        else bottom._left_title.get_window_extent(),
        "torque": bottom.get_window_extent(),
    }
    names = list(boxes)
    for above, below in itertools.pairwise(names):
        assert boxes[above].y0 >= boxes[below].y1 - 1.0, (above, below)  # a pixel for rounding
    for label in bottom.get_yticklabels():
        assert label.get_window_extent().x0 >= 0.0


def test_pictures_are_not_overwritten_unless_asked(single, tmp_path):
    figure = gd.plot.overview(single)
    path = tmp_path / "picture.png"
    path.write_bytes(b"precious")
    with pytest.raises(gd.SceneError, match="exists already"):
        gd.plot.write(figure, path)
    assert path.read_bytes() == b"precious"
    gd.plot.write(figure, path, overwrite=True)
    assert path.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("name", ["picture.xyz", "picture", "nowhere/picture.png"])
def test_pictures_that_cannot_be_written(name, single, tmp_path):
    with pytest.raises(gd.SceneError, match="picture"):
        gd.plot.write(gd.plot.overview(single), tmp_path / name)
    assert not any(tmp_path.iterdir())


def test_global_state_of_matplotlib_is_left_alone(sweep):
    """No pyplot, no changed settings, no warning: safe in servers and in other people's notebooks."""
    before = dict(mpl.rcParams)
    had_pyplot = "matplotlib.pyplot" in sys.modules
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        gd.plot.overview(sweep)
    assert dict(mpl.rcParams) == before
    assert ("matplotlib.pyplot" in sys.modules) == had_pyplot


@pytest.mark.parametrize(
    ("largest", "unit", "factor", "expected"),
    [
        (2e-16, "N m", 1e18, "aN m"),
        (1e-15, "N m", 1e15, "fN m"),  # exact powers belong to the prefix they reach
        (0.3, "s", 1e3, "ms"),
        (1.0, "s", 1.0, "s"),
        (999.0, "Hz", 1.0, "Hz"),
        (0.0, "m", 1.0, "m"),
        (float("nan"), "m", 1.0, "m"),
        (1e-40, "m", 1e24, "ym"),
    ],
)
def test_prefixes(largest, unit, factor, expected):
    scale = scale_for(largest, unit)
    assert scale.unit == expected
    assert scale.factor == pytest.approx(factor, rel=1e-12, abs=0)


def along_time(values):
    return xr.DataArray(values, dims="time")


def test_thinning_keeps_every_extreme():
    """Of 600 000 samples, 3000 blocks of 200 are kept by their extremes: exact in any row of whole blocks."""
    time = np.linspace(0.0, 1.0, 600_000)
    values = np.random.default_rng(1).normal(size=time.size)
    at, kept = thin(along_time(time), along_time(values))
    assert len(kept) < 6_010
    assert (np.diff(at) > 0.0).all()
    for block in range(0, time.size, 2_000):
        inside = (at >= time[block]) & (at <= time[block + 1_999])
        assert kept[inside].max() == values[block : block + 2_000].max()
        assert kept[inside].min() == values[block : block + 2_000].min()


def test_thinning_does_not_depend_on_how_the_file_is_read(monkeypatch):
    """Pieces of 1000 samples (whole blocks of 2 among them, and a rest) give what one piece gives."""
    time, values = (
        along_time(np.linspace(0.0, 1.0, 8_003)),
        along_time(np.random.default_rng(2).normal(size=8_003)),
    )
    whole = thin(time, values, 8_001)
    monkeypatch.setattr(style, "PIECE", 1_000)
    monkeypatch.setattr(pieces_module, "PIECE", 1_000)
    for piecewise, other in zip(thin(time, values, 8_001), whole, strict=True):
        np.testing.assert_array_equal(piecewise, other)


def test_thinning_leaves_short_traces_alone():
    time = np.linspace(0.0, 1.0, 100)
    at, kept = thin(along_time(time), along_time(time**2))
    assert np.array_equal(at, time)
    assert np.array_equal(kept, time**2)


def test_of_elastic_bodies_the_separation_is_drawn_and_not_the_rigid_distance():
    """Fig. 3 of the paper shows the smallest separation: 3.5 nm where the rigid shapes are 2.9 nm into each other."""
    ds = gd.simulate(gd.preset("roller_fast").replace({"contact.bodies": "elastic"}))
    axes = gd.plot.roller_gap(ds)
    (drawn,) = (line for line in axes.lines if len(line.get_xdata()) == ds.sizes["time"])
    assert float(np.min(drawn.get_ydata())) == pytest.approx(3.51, abs=0.01)
    assert axes.get_ylabel() == "smallest separation (nm)"
    assert float(ds.height.min()) < -2.8e-9
