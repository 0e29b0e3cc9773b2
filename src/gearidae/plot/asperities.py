"""A pair of teeth seen close up: a rough flank under a smooth one, heights stretched so that nanometres can be seen.

The model puts the roughness of both flanks on one, and knows of its asperities density, tip radius and the
distribution of their heights; the single asperities drawn are a sample of these. Which of a sample would be pressed,
stretched or free follows from the gap and the joined height.
"""

from __future__ import annotations

import math

import numpy as np
import scipy
from matplotlib.axes import Axes
from numpy.typing import NDArray

from gearidae.arrays import Floats
from gearidae.plot.style import NEGATIVE, POSITIVE
from gearidae.scene import MATERIAL_NAMES, Scene
from gearidae.studies.tooth_states import ToothContact

FLANKS = "#d3e5f3", "#deb968"
"""Colours of pinion and gear, one lighter than the other in grey."""
_WIDTH = 2.5  # of half a close-up over sqrt(2 R sigma)
_BELOW, _ABOVE = 3.5, 12.0  # roughnesses shown below the mean plane, and above it at least
SAMPLES = 8
"""Rows of asperities drawn at all."""
COATING = "#007a5a"
"""Colour of the monolayer."""


def half_width(scene: Scene) -> float:
    """Half the width of the close-ups of a scene [m], the same for all of them."""
    geometry = scene.geometry
    pinion, gear = geometry.tangent_pinion, geometry.tangent_gear
    return _WIDTH * math.sqrt(2.0 * pinion * gear / (pinion + gear) * scene.surface.roughness)


def rough_sample(scene: Scene, pair: int) -> tuple[Floats, Floats, NDArray[np.int64]]:
    """Draw a row of asperities for a pair of teeth, always the same for the same pair.

    Parameters
    ----------
    pair : int
        Number of the pair; `SAMPLES` rows take turns.

    Returns
    -------
    x, height : ndarray, shape (n,)
        Places along the flank and heights over the mean plane [m], less the recess where a monolayer is lost.
    material : ndarray of int, shape (n,)
        Which of `gearidae.scene.MATERIAL_NAMES` each belongs to.
    """
    surface, reach = scene.surface, 1.05 * half_width(scene)
    # as many in a row as asperities stand side by side on average, no more than can be seen
    count = int(np.clip(2.0 * reach * math.sqrt(surface.asperity_density), 6, 80))
    random = np.random.default_rng(pair % SAMPLES)
    x = (np.arange(count) + 0.5 + random.uniform(-0.3, 0.3, count)) * (2.0 * reach / count) - reach
    height = surface.roughness * random.standard_normal(count)
    # the coated first, so that what is covered stays so while the share falls
    materials = {one.name: one for one in scene.materials()}
    order = [materials[name] for name in ("coated", "mixed", "bare") if name in materials]
    drawn = np.searchsorted(
        np.cumsum([one.share for one in order[:-1]]), random.uniform(size=count), side="right"
    )
    number = np.array([MATERIAL_NAMES.index(one.name) for one in order])[drawn]
    return x, height - np.array([one.gap_offset for one in order])[drawn], number


def joined_asperities(scene: Scene, contact: ToothContact) -> float:
    """Return how many asperities of a pair are joined on average.

    Returns
    -------
    float
        ``N L sqrt(2 R sigma)`` times the integral of the share of heights above ``zeta + s^2`` over s; far below one
        where the surfaces hardly touch. NaN where the record does not tell.
    """
    assert scene.gears is not None
    sigma = scene.surface.roughness
    s, step = np.linspace(-6.0, 6.0, 1201, retstep=True)
    materials = {one.name: one for one in scene.materials()}
    above = sum(
        materials[part].share
        * float(np.sum(scipy.special.ndtr(-((joined + materials[part].gap_offset) / sigma + s**2))))
        for part, joined in contact.joined.items()
    )
    area = scene.gears.face_width * math.sqrt(2.0 * contact.radius * sigma)
    return scene.surface.asperity_density * area * above * float(step)


def close_up(ax: Axes, scene: Scene, contact: ToothContact) -> float:
    """Draw one pair of teeth close up.

    Parameters
    ----------
    ax : matplotlib Axes
        Where to draw; micrometres along the flank, nanometres across.

    Returns
    -------
    float
        By how much heights are stretched against lengths.
    """
    half, sigma, radius = half_width(scene), scene.surface.roughness, contact.radius
    x = np.linspace(-half, half, 801)
    upper = contact.gap + x**2 / (2.0 * radius)
    places, heights, materials = rough_sample(scene, contact.pair)
    caps = heights[:, None] - (x - places[:, None]) ** 2 / (2.0 * scene.surface.asperity_radius)
    owner = np.argmax(caps, axis=0)
    rough = caps[owner, np.arange(len(x))]
    pressed = rough > upper
    lower = np.minimum(rough, upper)
    top = max(_ABOVE * sigma, contact.gap + _BELOW * sigma)
    ax.fill_between(x * 1e6, lower * 1e9, -_BELOW * sigma * 1e9, color=FLANKS[1], linewidth=0.0)
    ax.fill_between(x * 1e6, upper * 1e9, top * 1e9, color=FLANKS[0], linewidth=0.0)
    ax.plot(x * 1e6, upper * 1e9, color="0.2", linewidth=0.9)
    ax.plot(x * 1e6, lower * 1e9, color="0.2", linewidth=0.9)
    ax.plot(x * 1e6, np.where(materials[owner] > 0, lower, np.nan) * 1e9, color=COATING, linewidth=2.2)
    ax.plot(x * 1e6, np.where(pressed, upper, np.nan) * 1e9, color=POSITIVE, linewidth=3.5)
    for place, height, material in zip(places, heights, materials, strict=True):
        rise = place**2 / (2.0 * radius)
        joined = contact.joined[MATERIAL_NAMES[material]] + rise
        if abs(place) < half and joined < height < contact.gap + rise:
            ax.plot(
                [place * 1e6] * 2, [height * 1e9, (contact.gap + rise) * 1e9], color=NEGATIVE, linewidth=3.0
            )
    ax.annotate(
        "",
        (0.0, contact.gap * 1e9),
        (0.0, 0.0),
        arrowprops={"arrowstyle": "<->", "color": "0.1", "linewidth": 1.0, "shrinkA": 0, "shrinkB": 0},
    )
    ax.axhline(0.0, color="0.35", linewidth=0.7, linestyle=(0, (4, 3)))
    ax.set_xlim(-half * 1e6, half * 1e6)
    ax.set_ylim(-_BELOW * sigma * 1e9, top * 1e9)
    ax.spines[["top", "right"]].set_visible(False)
    ax.tick_params(labelsize="x-small")
    box = ax.get_window_extent()
    return (box.height / (top + _BELOW * sigma)) / (box.width / (2.0 * half))
