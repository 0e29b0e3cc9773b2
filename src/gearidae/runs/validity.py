"""How far the model can be believed for a scene: numbers beside the limits of what the model presumes.

Nothing here stops a run. Each row says in words what follows if its limit is not kept; `docs/limits.md` explains them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import lru_cache
from typing import TYPE_CHECKING, Final

import numpy as np

from gearidae.asperities import law_class, law_of
from gearidae.asperities.tip import tabor_parameter
from gearidae.contact.asperity_statistics import (
    asperities_for_mean,
    density_product,
    expected_asperities,
    half_spacing,
    mean_square_position,
    zero_load_radius,
)
from gearidae.contact.surroundings import (
    AIR_MEAN_FREE_PATH,
    ROOM_TEMPERATURE,
    disc_drag,
    film_damping,
    thermal_amplitude,
)
from gearidae.mesh.pair_contact import PairContact
from gearidae.runs.estimates import Rest, balanced_speed, mean_drive_torque, rest_of
from gearidae.runs.rubbing import locking_rows
from gearidae.runs.train_statics import stages
from gearidae.runs.yielding import yielding_row
from gearidae.scene import TrainScene
from gearidae.scene.gears import DISC_FACTOR, SILICON, disc_inertia
from gearidae.scene.orbit import has_orbit, journal_speeds
from gearidae.scene.pitch_errors import has_pitch_errors, rms_of_sums
from gearidae.scene.prefixes import with_prefix
from gearidae.scene.validity_row import EXPECTED_ASPERITIES, ValidityRow, rows_to_json

if TYPE_CHECKING:
    import pandas as pd

    from gearidae.scene import GearScene, Scene

_DENSEST: Final = 0.06
"""Random surfaces have a product N beta sigma of 0.03 to 0.06."""
_SPACINGS: Final = 0.165e-9, 0.3e-9
"""Range of the equilibrium spacing of atoms, for the Tabor parameter [m]."""
_LITTLE_DAMPING: Final = 0.1
"""Damping ratio below which the air leaves an impact response as it is."""
_CLEARANCE: Final = 2e-6
"""Distance between gear and substrate that the drag of the air is estimated for [m]: a usual sacrificial layer."""
_USUAL_HAMAKER: Final = 5e-20
"""Hamaker constant [J] of flanks in a scene that has none: an assumption, to say what it leaves out."""
_LITTLE_ATTRACTION: Final = 0.1
"""Share of the force that presses below which the attraction may be left out."""
_USUAL_ERROR: Final = 10e-9
"""Error of two teeth that meet [m], in a scene without any: an assumption, as lithography places to 5 to 100 nm."""
_SLOWER: Final = 3.0
"""Times by which the force in a hub turns more slowly than the journal would by itself: the centre then stands within
a ninth of where a slow force holds it."""
_NO_LOAD = "no mean torque of the drive presses the teeth together: there is no resting contact"


def validity(scene: Scene) -> pd.DataFrame:
    """Say how far the model can be believed for a scene.

    Parameters
    ----------
    scene : Scene
        A gear pair (its contact at the pitch point, at rest under the mean torque of the drive), a train (each of its
        meshes likewise, under its own mean force) or a roller (at its closest approach, with rigid bodies).

    Returns
    -------
    pandas.DataFrame
        One row a quantity, by its short name. Columns ``quantity``, ``value``, ``limit`` and ``verdict`` are texts with
        units; ``holds`` says whether the limit is kept, ``number``, ``bound`` and ``unit`` are the same in SI.

    Examples
    --------
    >>> import gearidae as gd
    >>> rows = gd.studies.validity(gd.preset("teodorescu2009"))
    >>> rows.value["expected_asperities"]
    '0.115'
    """
    import pandas as pd

    rows = validity_rows(scene)
    columns = [field for field in ValidityRow.__slots__ if field != "name"]
    table = {column: [getattr(row, column) for row in rows] for column in columns}
    return pd.DataFrame(table, index=pd.Index([row.name for row in rows], name="name"), columns=columns)


def validity_attribute(scene: Scene, force: float = math.nan) -> str:
    """Return the rows of `validity` as JSON, for the attributes of an archive.

    Parameters
    ----------
    force : float, optional
        As for `validity_rows`.

    Returns
    -------
    str
        A list of objects with the fields of `ValidityRow`; `gearidae.scene.validity_row.rows_from_json` reads it.
    """
    return rows_to_json(validity_rows(scene, force))


def validity_rows(scene: Scene, force: float = math.nan) -> list[ValidityRow]:
    """Return the rows of `validity` as plain records.

    Parameters
    ----------
    force : float, optional
        Largest force of a run [N], at which asperities are compared with those that yield; by default that at rest.
    """
    if isinstance(scene, TrainScene):
        return [row for mesh, pair in stages(scene) for row in _of_mesh(mesh, validity_rows(pair))]
    return [*_rows(scene), yielding_row(scene, force)]


def _of_mesh(mesh: str, rows: Iterable[ValidityRow]) -> Iterator[ValidityRow]:
    """Name the rows of one mesh of a train after it; what depends on a whole shaft is not of a mesh."""
    for row in rows:
        if row.name != "disc_drag" and not row.name.startswith("inertia_"):
            yield replace(row, name=f"{mesh}.{row.name}", quantity=f"{mesh}: {row.quantity}")


# Some 15 ms: an archive needs them at its beginning and at its end.
@lru_cache(maxsize=16)
def _rows(scene: GearScene) -> tuple[ValidityRow, ...]:
    rest = rest_of(scene)
    stiffness = math.nan if math.isnan(rest.gap) else rest.contact.stiffness(rest.gap)
    real = scene.contact.is_discrete
    rows = [
        _asperities(rest, real),
        _density(rest.contact),
        *_merging(scene),
        *_law_of_asperities(scene, rest),
        *_tabor(scene),
    ]
    rows += [_temperature(rest, stiffness), _gas(rest, stiffness), _adhesion(scene, rest)]
    rows += [_attraction(scene, rest, rest.gap, "attraction", "attraction across the gap")]
    if scene.gears is not None:
        behind = scene.mesh.backlash - rest.gap
        rows += [
            _attraction(scene, rest, behind, "attraction_behind", "attraction across the backlash behind")
        ]
        rows += [_memory(scene, rest), _tooth_errors(scene, rest, stiffness), _disc_drag(scene)]
        rows += [*_inertia(scene), *locking_rows(scene), *_journal(scene)]
    return tuple(rows)


def _row(
    name: str, quantity: str, number: float, unit: str, limit: str, bound: float, holds: bool, verdict: str
) -> ValidityRow:
    """Make the row of a number; one that is NaN needs a contact that rests, and there is none."""
    if math.isnan(number):
        holds, verdict = False, _NO_LOAD
    return ValidityRow(name, quantity, with_prefix(number, unit), limit, verdict, holds, number, bound, unit)


def _times(ratio: float) -> str:
    """Write a ratio: ``"45 times"``."""
    return f"{f'{ratio:.2g}' if ratio < 10.0 else f'{ratio:,.0f}' if ratio < 1e6 else f'{ratio:.0e}'} times"


def _about(count: float) -> str:
    """Write a large number with two digits: ``"26,000"``."""
    return f"{float(f'{count:.2g}'):,.0f}" if count < 1e9 else f"{count:.0e}"


def _asperities(rest: Rest, real: bool) -> ValidityRow:
    """Compare the asperities in contact with those that a mean law needs; `real` ones do without."""
    count = needed = math.nan
    limit = verdict = "-"
    if not math.isnan(rest.gap):
        parts = [(surface, share, offset) for surface, share, offset, _ in rest.contact.parts]
        needed = asperities_for_mean(rest.gap, parts, rest.contact.law)
        count = sum(_counts(rest))
        limit = f"at least {_about(needed)}"
        words = (
            "one pair's force is the mean to 10 %"
            if count >= needed
            else "each asperity is followed: a run is one specimen, another contact.seed another"
            if real
            else "the smooth law of force is an ensemble mean, not one pair of teeth"
        )
        verdict = f"{words} (gap {rest.gap / rest.contact.surface.roughness:.2f} roughnesses)"
    quantity = "expected asperities in contact"
    return _row(EXPECTED_ASPERITIES, quantity, count, "1", limit, needed, real or count >= needed, verdict)


def _counts(rest: Rest) -> list[float]:
    """Asperities of each material of the interface that are expected in contact."""
    contact = rest.contact
    return [
        share * float(expected_asperities(rest.gap + offset, contact.radius, contact.width, surface))
        for surface, share, offset, _ in contact.parts
    ]


def _memory(scene: Scene, rest: Rest) -> ValidityRow:
    """Compare the contact's width with the flank that rolls through it while the pair is engaged."""
    contact, geometry = rest.contact, scene.geometry
    ratio, holds, verdict = math.nan, False, ""
    if not math.isnan(rest.gap):
        squares = [
            mean_square_position(rest.gap + part.gap_offset, contact.radius, part.surface)
            for part in contact.parts
        ]
        width = 4.0 * math.sqrt(
            np.average(squares, weights=_counts(rest))
        )  # four standard deviations of the positions
        begin = geometry.tangent_pinion - geometry.approach
        rolled = ((begin + geometry.path_length) ** 2 - begin**2) / (2.0 * geometry.base_radius_pinion)
        ratio = width / rolled
        laws = [law_of(contact.law, part.surface) for part in contact.parts]
        forgets, real = all(law.detach == law.join for law in laws), scene.contact.is_discrete
        holds = forgets or real or ratio >= 1.0
        words = (
            "asperities of this law have no memory"
            if forgets
            else "each asperity remembers on its own, and passes through the contact"
            if real
            else "the same asperities stay in contact while the pair is engaged"
            if holds
            else "asperities pass through the contact; here those that an impact joins stay with the pair"
        )
        verdict = f"{words} ({with_prefix(width, 'm')} of {with_prefix(rolled, 'm')})"
    quantity, limit = (
        "width of the contact over the rolled distance",
        "at least 1: the same asperities all the time",
    )
    return _row("memory", quantity, ratio, "1", limit, 1.0, holds, verdict)


def _density(contact: PairContact) -> ValidityRow:
    product = density_product(contact.surface)
    holds = product <= _DENSEST
    verdict = (
        "as random surfaces, or sparser"
        if holds
        else f"{_times(product / _DENSEST)} as dense as random surfaces: asperities would share their load"
    )
    limit = "0.03 to 0.06 for random surfaces"
    return _row(
        "density_product", "density product N beta sigma", product, "1", limit, _DENSEST, holds, verdict
    )


def _merging(scene: Scene) -> Iterator[ValidityRow]:
    for surface, _, _, name in scene.materials():
        radius, half = zero_load_radius(surface), half_spacing(surface)
        holds = radius <= half
        verdict = (
            "contacts stay apart"
            if holds
            else "contacts grow into their neighbours before any load: the asperities are not independent"
        )
        limit = f"{with_prefix(half, 'm')}, half the mean spacing"
        quantity = f"{name}: contact radius without load"
        yield _row(f"merging_{name}", quantity, radius, "m", limit, half, holds, verdict)


def _law_of_asperities(scene: Scene, rest: Rest) -> Iterator[ValidityRow]:
    """What the law of one asperity says of itself."""
    law = law_class(scene.contact.asperity)
    for surface, _, _, name in scene.materials():
        if (said := law.validity(surface, rest.gap)) is not None:
            holds = said.number <= 1.0
            yield _row(
                f"{said.name}_{name}",
                f"{name}: {said.quantity}",
                said.number,
                "1",
                "1",
                1.0,
                holds,
                said.holds if holds else said.fails,
            )


def _tabor(scene: Scene) -> Iterator[ValidityRow]:
    law = scene.contact.asperity
    for surface, _, _, name in scene.materials():
        high, low = (tabor_parameter(surface, eps) for eps in _SPACINGS)
        limit, bound, holds, verdict = _tabor_verdict(law, low, high)
        # the end of the range that is compared: the small one where the law needs large parameters
        number = high if law == "dmt" else low
        yield ValidityRow(
            f"tabor_{name}",
            f"{name}: Tabor parameter",
            f"{high:.2g} to {low:.2g}" if high >= 0.01 else "0",
            limit,
            verdict,
            holds,
            number,
            bound,
            "1",
        )


def _tabor_verdict(law: str, low: float, high: float) -> tuple[str, float, bool, str]:
    """Limit in words and as a number, whether it is kept, and what follows, of a range of Tabor parameters."""
    if law == "jkr":
        limit = "at least 5 for JKR, atoms 0.165 to 0.3 nm apart"
        if low >= 4.5:
            return limit, 5.0, True, "JKR holds"
        partly = "JKR holds for the closest atoms only" if high >= 4.5 else "JKR overstates stretch and loss"
        return limit, 5.0, False, partly
    if law == "dmt":
        holds = high < 0.15
        return "at most 0.1 for DMT", 0.1, holds, "DMT holds" if holds else "DMT leaves the hysteresis out"
    if law == "hertz":
        return "none: asperities do not adhere", math.nan, True, "adhesion is left out by choice"
    return "none: the law holds for every value", math.nan, True, f"{law} covers the transition"


def _temperature(rest: Rest, stiffness: float) -> ValidityRow:
    sigma = rest.contact.surface.roughness
    bound = 0.1 * sigma
    limit = f"{with_prefix(bound, 'm')}, a tenth of the roughness ({with_prefix(sigma, 'm')})"
    amplitude = math.nan if math.isnan(stiffness) else thermal_amplitude(stiffness)
    holds = amplitude <= bound
    contact = f"this contact ({with_prefix(stiffness, 'N/m')})"
    verdict = (
        f"heat moves {contact} little"
        if holds
        else f"heat shakes {contact} by {amplitude / sigma:.2g} roughnesses: the model has none"
    )
    quantity = f"thermal motion at {ROOM_TEMPERATURE:g} K"
    return _row("thermal_motion", quantity, amplitude, "m", limit, bound, holds, verdict)


def _gas(rest: Rest, stiffness: float) -> ValidityRow:
    ratio, holds, verdict = math.nan, False, ""
    if stiffness > 0.0:
        contact = rest.contact
        film = max(rest.gap, contact.surface.roughness)  # mean planes that overlap leave the valleys
        damping = film_damping(film, contact.radius, contact.width)
        ratio = damping / (2.0 * math.sqrt(stiffness * rest.mass))
        holds = ratio <= _LITTLE_DAMPING
        where = f"film of {with_prefix(film, 'm')}, Kn = {AIR_MEAN_FREE_PATH / film:.2g}"
        verdict = (
            f"air hardly damps the contact ({where})"
            if holds
            else f"in air the contact would not ring as it does here, in vacuum ({where})"
        )
    limit, quantity = f"{_LITTLE_DAMPING:g}", "damping ratio of a film of air"
    return _row("gas_damping", quantity, ratio, "1", limit, _LITTLE_DAMPING, holds, verdict)


def _adhesion(scene: Scene, rest: Rest) -> ValidityRow:
    driven = "the drive's force" if scene.roller is None else "the peak force, rigid bodies"
    tension, limit, verdict = math.nan, driven, ""
    if not math.isnan(rest.gap):
        tension = rest.contact.largest_tension(rest.gap)
        limit = f"{with_prefix(rest.load, 'N')}, {driven}"
        if tension == 0.0:
            verdict = "it does not pull when it parts from rest; impacts press deeper"
        elif tension <= rest.load:
            verdict = "smaller than the force that presses"
        else:
            verdict = (
                f"{_times(tension / rest.load)} the force that presses: teeth that leave the mesh can stick"
            )
    quantity = "net adhesion of the pair when it parts"
    return _row("net_adhesion", quantity, tension, "N", limit, rest.load, tension <= rest.load, verdict)


def _attraction(scene: Scene, rest: Rest, gap: float, name: str, quantity: str) -> ValidityRow:
    """Compare what flanks attract each other with across a gap with the force that presses, in the scene or not."""
    pull, holds, verdict = math.nan, False, ""
    driven = "the drive's force" if scene.roller is None else "the peak force, rigid bodies"
    limit = driven
    if not math.isnan(gap):
        inside = rest.contact.attracts
        pull = -float(rest.contact.attraction(gap, None if inside else _USUAL_HAMAKER))
        holds = inside or pull <= _LITTLE_ATTRACTION * rest.load
        limit = f"{with_prefix(rest.load, 'N')}, {driven}"
        ratio = "" if rest.load == 0.0 else f", {_times(pull / rest.load)} that force"
        across = f"over {with_prefix(gap, 'm')}{ratio}"
        missing = f"with an assumed {_USUAL_HAMAKER:g} J, left out of the scene"
        verdict = f"in the scene, {across}" if inside else f"{missing}, {across}"
    bound = rest.load if rest.contact.attracts else _LITTLE_ATTRACTION * rest.load
    return _row(name, quantity, pull, "N", limit, bound, holds, verdict)


def _tooth_errors(scene: GearScene, rest: Rest, stiffness: float) -> ValidityRow:
    """Compare errors of single teeth, in the scene or not, with what a pair's gap closes by under the load.

    The force of a pair grows e-fold, about, over its load over its stiffness: by more than that between two pairs in
    mesh one of them carries the load alone.
    """
    closure, inside = math.nan, has_pitch_errors(scene)
    error = rms_of_sums(scene) if inside else _USUAL_ERROR
    if stiffness > 0.0:
        closure = rest.load / stiffness
    small = error <= closure
    words = (
        "pairs share the load as equal teeth do"
        if small
        else "one of two pairs in mesh carries the load alone"
    )
    where = (
        "in the scene"
        if inside
        else f"with an assumed {with_prefix(_USUAL_ERROR, 'm')}, left out of the scene"
    )
    verdict = f"{where}, {_times(error / closure)} that: {words}" if closure > 0.0 else ""
    limit = f"{with_prefix(closure, 'm')}, load over stiffness of one pair"
    quantity = "rms error of two teeth that meet"
    number = math.nan if math.isnan(closure) else error
    return _row("tooth_errors", quantity, number, "m", limit, closure, inside or small, verdict)


def _journal(scene: GearScene) -> Iterator[ValidityRow]:
    """Compare the turning force of a drive with the natural speed of the journal that is to follow it."""
    if not has_orbit(scene):
        return
    (own, turns), clearance = journal_speeds(scene), scene.gears.pinion_hub_clearance
    bound = own / _SLOWER
    swing = 100.0 * clearance / scene.geometry.base_radius_pinion
    if turns <= bound:
        verdict = (
            f"the journal follows the force; the speed of the gear swings by up to {swing:.3g} % once a turn"
        )
    else:
        verdict = "the journal does not follow the force: its centre lags behind or overshoots"
    limit = f"{with_prefix(bound, 'rad/s')}, a third of the journal's own, sqrt(P/(m c))"
    quantity = "turning of the force in the hub"
    yield _row("journal", quantity, turns, "rad/s", limit, bound, turns <= bound, verdict)


def _disc_drag(scene: GearScene) -> ValidityRow:
    speed = balanced_speed(scene, mean_drive_torque(scene))
    if not math.isfinite(speed) or speed == 0.0:
        speed = abs(scene.initial.gear_speed)
    resistance = scene.load.torque + scene.load.drag * speed**2
    torque = disc_drag(scene.geometry.base_radius_gear, speed, _CLEARANCE)
    holds = torque <= resistance or torque == 0.0
    limit = f"{with_prefix(resistance, 'N m')}, all that resists it in the scene"
    where = f"{speed:.4g} rad/s, {with_prefix(_CLEARANCE, 'm')} above a plane"
    if torque == 0.0:
        verdict = "the gear does not turn by the estimate"
    elif holds:
        verdict = f"smaller at {where}"
    elif resistance == 0.0:
        verdict = f"nothing else resists the gear at {where}"
    else:
        verdict = f"{_times(torque / resistance)} as much at {where}: in air the gear needs more torque"
    return _row("disc_drag", "drag of air under the gear", torque, "N m", limit, resistance, holds, verdict)


def _inertia(scene: GearScene) -> Iterator[ValidityRow]:
    gears, geometry = scene.gears, scene.geometry
    for name, inertia, radius in (
        ("pinion", gears.pinion_inertia, geometry.base_radius_pinion),
        ("gear", gears.gear_inertia, geometry.base_radius_gear),
    ):
        disc = disc_inertia(SILICON, gears.face_width, radius, gears.pressure_angle)
        times = disc / inertia
        holds = 1.0 / DISC_FACTOR <= times <= DISC_FACTOR
        if holds:
            verdict = "about that of a solid disc"
        elif times > 1.0:
            verdict = f"{_times(times)} lighter than a solid disc: pierced, smaller, or a mistake"
        else:
            verdict = f"{_times(1.0 / times)} heavier than a solid disc: a load on the shaft, or a mistake"
        limit = f"{with_prefix(disc, 'kg m^2')}, a solid disc of silicon on the pitch circle"
        quantity = f"{name}: moment of inertia"
        yield _row(f"inertia_{name}", quantity, inertia, "kg m^2", limit, disc, holds, verdict)
