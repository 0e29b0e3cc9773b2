"""Figures show themselves in a notebook."""

from __future__ import annotations

import struct

import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure

import gearidae as gd
from gearidae.drawing.picture import Picture, PictureAxes

SCENE = gd.preset("roller_slow").replace({"run.samples": 201})


def size_of(png):
    """Width and height in the header of a PNG file."""
    assert png[:8] == b"\x89PNG\r\n\x1a\n"
    return struct.unpack(">II", png[16:24])


@pytest.fixture(scope="module")
def ds():
    return gd.simulate(SCENE)


def test_axes_are_still_axes_and_show_their_figure(ds):
    ax = gd.plot.roller_force(ds)
    assert isinstance(ax, Axes)
    assert isinstance(ax, PictureAxes)
    png, page = ax._repr_png_()
    width, height = ax.figure.get_size_inches()
    assert size_of(png) == (round(150 * width), round(150 * height))
    assert page == {"width": round(100 * width), "height": round(100 * height)}


def test_figures_show_themselves(ds):
    figure = gd.plot.overview(ds)
    assert isinstance(figure, Figure)
    assert isinstance(figure, Picture)
    assert size_of(figure._repr_png_()[0])[0] == round(150 * figure.get_size_inches()[0])


def test_axes_that_are_given_are_drawn_into_and_left_to_their_figure(ds):
    ax = Figure().add_subplot()
    assert gd.plot.roller_force(ds, ax) is ax
    assert not hasattr(ax, "_repr_png_")


def test_axes_of_ours_in_another_figure_leave_showing_to_it():
    assert Figure().add_subplot(axes_class=PictureAxes)._repr_png_() is None
