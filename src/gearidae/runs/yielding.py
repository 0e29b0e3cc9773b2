"""Load of the highest asperity beside the load that yields its tip: a row of the validity of a scene or a run."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gearidae.contact.yielding import HARDNESS, highest_load, yield_load
from gearidae.mesh.pair_contact import pair_contact
from gearidae.runs.estimates import rest_of
from gearidae.scene.prefixes import with_prefix
from gearidae.scene.validity_row import ValidityRow

if TYPE_CHECKING:
    from gearidae.scene import Scene


def yielding_row(scene: Scene, force: float = math.nan) -> ValidityRow:
    """Compare the load of the highest asperity with that which yields it.

    Parameters
    ----------
    force : float, optional
        Largest force of a run [N], taken for that of one pair with rigid bodies, which is an upper bound where bodies
        deflect; NaN for the resting contact, see `rest_of`.
    """
    if math.isnan(force):
        rest = rest_of(scene)
        contact, gap, force = rest.contact, rest.gap, rest.load
        where = "at rest" if scene.roller is None else "at the closest approach"
    else:
        contact = pair_contact(scene)
        gap, where = contact.resting_gap(force), f"at the largest force of the run, {with_prefix(force, 'N')}"
    yields = yield_load(contact.surface)
    ratio, verdict = math.nan, "nothing presses the flanks together"
    if not math.isnan(gap):
        parts = [(surface, share, offset) for surface, share, offset, _ in contact.parts]
        load = highest_load(gap, force, parts, (contact.radius, contact.width), contact.law)
        ratio = load / yields
        stays = "the highest asperity stays elastic" if ratio <= 1.0 else "the highest asperity yields"
        verdict = f"{stays} {where}: it carries {with_prefix(load, 'N')}"
    limit = f"1: {with_prefix(yields, 'N')} yields a tip, hardness of {with_prefix(HARDNESS, 'Pa')} assumed"
    quantity = "load of the highest asperity over that which yields it"
    value = with_prefix(ratio, "1")
    return ValidityRow("yielding", quantity, value, limit, verdict, ratio <= 1.0, ratio, 1.0, "1")
