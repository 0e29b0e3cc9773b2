"""A pair of teeth seen close up: a rough flank under a smooth one, heights stretched so that nanometres can be seen.

The model puts the roughness of both flanks on one, and knows of its asperities density, tip radius and the
distribution of their heights; the single asperities drawn are a sample of these. Which of a sample would be pressed,
stretched or free follows from the gap and the joined height. A population's asperities are drawn as they are, all that
stand side by side across the face width, with marks on those that are joined.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import scipy
from matplotlib.axes import Axes
from numpy.typing import NDArray

from gearidae.arrays import Floats
from gearidae.drawing.style import NEGATIVE, POSITIVE
from gearidae.populations.met_flank import MetFlank, contact_arc, met_flank
from gearidae.records import Flank
from gearidae.records.tooth_states import ToothContact
from gearidae.scene import MATERIAL_NAMES, GearScene

FLANKS = "#d3e5f3", "#deb968"
"""Colours of pinion and gear, one lighter than the other in grey."""
_WIDTH = 2.5  # of half a close-up over sqrt(2 R sigma)
_BELOW, _ABOVE = 3.5, 12.0  # roughnesses shown below the mean plane, and above it at least
SAMPLES = 8
"""Rows of asperities drawn at all."""
COATING = "#007a5a"
"""Colour of the monolayer."""


def half_width(scene: GearScene) -> float:
    """Half the width of the close-ups of a scene [m], the same for all of them."""
    geometry = scene.geometry
    pinion, gear = geometry.tangent_pinion, geometry.tangent_gear
    return _WIDTH * math.sqrt(2.0 * pinion * gear / (pinion + gear) * scene.surface.roughness)


def rough_sample(scene: GearScene, pair: int) -> tuple[Floats, Floats, NDArray[np.int64]]:
    """Draw a row of asperities for a pair of teeth, always the same for the same pair.

    Parameters
    ----------
    pair : int
        Number of the pair; `SAMPLES` rows take turns.

    Returns
    -------
    x, height : ndarray, shape (n,)
        Positions along the flank and heights over the mean plane [m], less the recess where a monolayer is lost.
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
    materials = {material.name: material for material in scene.materials()}
    order = [materials[name] for name in ("coated", "mixed", "bare") if name in materials]
    drawn = np.searchsorted(
        np.cumsum([material.share for material in order[:-1]]), random.uniform(size=count), side="right"
    )
    number = np.array([MATERIAL_NAMES.index(material.name) for material in order])[drawn]
    return x, height - np.array([material.gap_offset for material in order])[drawn], number


def flank_asperities(scene: GearScene, pair: int, flank: Flank) -> MetFlank:
    """Return the asperities to draw of a pair: of a population those of its flank, of other models a sample."""
    if scene.contact.is_discrete:
        return met_flank(scene, pair, flank)
    x, height, material = rough_sample(scene, pair)
    return MetFlank(x, height, np.full_like(x, scene.surface.asperity_radius), material)


def touching_arc(scene: GearScene, position: float) -> float:
    """Return where a pair touches among the asperities to draw [m]: on a population's flank, or amid a sample."""
    return contact_arc(scene, position) if scene.contact.is_discrete else 0.0


def joined_asperities(scene: GearScene, contact: ToothContact) -> float:
    """Return how many asperities of a pair are joined: of a population, else on average.

    Returns
    -------
    float
        ``N L sqrt(2 R sigma)`` times the integral of the share of heights above ``zeta + s^2`` over s; far below one
        where the surfaces hardly touch. NaN where the bodies deflect.
    """
    if scene.contact.is_discrete:
        return float(len(contact.asperities or ()))
    sigma = scene.surface.roughness
    s, step = np.linspace(-6.0, 6.0, 1201, retstep=True)
    materials = {material.name: material for material in scene.materials()}
    above = sum(
        materials[part].share
        * float(np.sum(scipy.special.ndtr(-((joined + materials[part].gap_offset) / sigma + s**2))))
        for part, joined in contact.joined.items()
    )
    area = scene.gears.face_width * math.sqrt(2.0 * contact.radius * sigma)
    return scene.surface.asperity_density * area * above * float(step)


class _Row(NamedTuple):
    """Asperities of a close-up: positions, heights, tip radii and materials, and which are stretched and pressed."""

    x: Floats
    height: Floats
    radius: Floats
    material: NDArray[np.int64]
    stretched: NDArray[np.bool_]
    pressed: NDArray[np.bool_]


def _sampled_row(scene: GearScene, contact: ToothContact) -> _Row:
    """Return a sample of the model's asperities."""
    row = flank_asperities(scene, contact.pair, contact.flank)
    rise = row.arc**2 / (2.0 * contact.radius)
    joined = np.array([contact.joined[MATERIAL_NAMES[number]] for number in row.material]) + rise
    stretched = (joined < row.height) & (row.height < contact.gap + rise)
    return _Row(*row, stretched, row.height > contact.gap + rise)


def _real_row(scene: GearScene, contact: ToothContact) -> _Row:
    """Return the asperities of a population beside a contact."""
    flank = flank_asperities(scene, contact.pair, contact.flank)
    joined = np.zeros(flank.arc.size, np.bool_)
    joined[list(contact.asperities or ())] = True
    x = flank.arc - touching_arc(scene, contact.place)
    near = np.abs(x) < 1.1 * half_width(scene)
    some, joined = flank.some(near), joined[near]
    overlap = some.overlaps(scene, contact.place, contact.gap)
    return _Row(
        x[near], some.height, some.radius, some.material, joined & (overlap <= 0.0), joined & (overlap > 0.0)
    )


def close_up(ax: Axes, scene: GearScene, contact: ToothContact) -> float:
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
    real = scene.contact.is_discrete
    row = (_real_row if real else _sampled_row)(scene, contact)
    caps = row.height[:, None] - (x - row.x[:, None]) ** 2 / (2.0 * row.radius[:, None])
    caps = np.vstack([caps, np.full(x.size, -_BELOW * sigma)])
    owner = np.argmax(caps, axis=0)
    rough, materials = caps[owner, np.arange(len(x))], np.append(row.material, 0)
    pressed = rough > upper
    lower = np.minimum(rough, upper)
    top = max(_ABOVE * sigma, contact.gap + _BELOW * sigma)
    smooth, bumpy = FLANKS[::-1] if real else FLANKS  # a population stands on the pinion
    ax.fill_between(x * 1e6, lower * 1e9, -_BELOW * sigma * 1e9, color=bumpy, linewidth=0.0)
    ax.fill_between(x * 1e6, upper * 1e9, top * 1e9, color=smooth, linewidth=0.0)
    ax.plot(x * 1e6, upper * 1e9, color="0.2", linewidth=0.9)
    ax.plot(x * 1e6, lower * 1e9, color="0.2", linewidth=0.9)
    ax.plot(x * 1e6, np.where(materials[owner] > 0, lower, np.nan) * 1e9, color=COATING, linewidth=2.2)
    ax.plot(x * 1e6, np.where(pressed, upper, np.nan) * 1e9, color=POSITIVE, linewidth=3.5)
    shown = np.abs(row.x) < half
    for position, height in zip(row.x[row.stretched & shown], row.height[row.stretched & shown], strict=True):
        ends = [height * 1e9, (contact.gap + position**2 / (2.0 * radius)) * 1e9]
        ax.plot([position * 1e6] * 2, ends, color=NEGATIVE, linewidth=3.0)
    if real:
        for joined, colour in ((row.pressed & shown, POSITIVE), (row.stretched & shown, NEGATIVE)):
            at = row.x[joined]
            _mark(ax, at * 1e6, (contact.gap + at**2 / (2.0 * radius)) * 1e9, colour)
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


def _mark(ax: Axes, x: Floats, height: Floats, colour: str) -> None:
    """Mark joined asperities where they touch the other flank."""
    ax.plot(
        x, height, "v", color=colour, markeredgecolor="white", markeredgewidth=0.6, markersize=7, zorder=5
    )
