"""Losses by friction of flanks and hubs, integrated over every step from powers and their rates at both ends."""

from __future__ import annotations

from typing import Final

from gearidae.compiled import compiled, compiled_once
from gearidae.engine.compiling import FRICTION
from gearidae.engine.formulas.quadrature import error_estimate, integral
from gearidae.engine.friction.forces import Mesh, Shafts, solve_shafts
from gearidae.engine.friction.pairs import direction, flank_of_history, lever_rate, levers
from gearidae.engine.model.state import COAST, Floats, Model, W
from gearidae.engine.motion.shafts import forces_at_shafts

_POWERS: Final = 4


@compiled_once(FRICTION)
def note_rubbing(m: Model, t: float, y: Floats) -> None:
    """Note the powers of friction and their rates, with the present directions of slip."""
    turn, pinion, gear = forces_at_shafts(m, t, y)
    found = solve_shafts(m, t, y, turn, pinion, gear)
    r = m.work.rubbing
    r.time = t
    for which in range(_POWERS):
        r.power[which] = r.power_rate[which] = 0.0
    drive = coast = drive_friction = coast_friction = 0.0  # rates
    for i in range(m.work.notes.count):
        noted = m.work.notes.pair[i]
        flank = flank_of_history(m, noted.history)
        first, second = levers(m, noted.position)
        slip = direction(m, noted) if m.scene.friction.flanks != 0 else 0.0
        friction, rate = slip * noted.limit, slip * noted.limit_rate
        speed = first * turn - second * y[W]
        speed_rate = first * found.pinion - second * found.gear + lever_rate(m, noted, turn, y[W])
        r.power[flank] += friction * speed
        r.power_rate[flank] += rate * speed + friction * speed_rate
        if flank == COAST:
            coast += noted.force_rate
            coast_friction += rate
        else:
            drive += noted.force_rate
            drive_friction += rate
    if found.hubs > 0.0:
        load_rate = _load_rate(m, found, Mesh(drive, coast, drive_friction, coast_friction))
        own, slip = m.scene.friction, m.state.slip if m.scene.friction.gear_hub > 0.0 else 0.0
        r.power[2] = own.pinion_hub * found.hubs * m.state.pinion_slip * turn
        r.power_rate[2] = own.pinion_hub * m.state.pinion_slip * (load_rate * turn + found.hubs * found.pinion)
        r.power[3] = own.gear_hub * found.hubs * slip * y[W]
        r.power_rate[3] = own.gear_hub * slip * (load_rate * y[W] + found.hubs * found.gear)


@compiled(inline=True)
def _load_rate(m: Model, found: Shafts, rate: Mesh) -> float:
    """Rate of the bearings' load, for the rates of the forces that it is the vector sum of."""
    own, now = m.scene.friction, found.mesh
    half = now.drive * rate.drive + now.coast * rate.coast
    half += now.drive_friction * rate.drive_friction + now.coast_friction * rate.coast_friction
    half -= own.cosine * (rate.drive * now.coast + now.drive * rate.coast)
    half -= own.cosine * (rate.drive_friction * now.coast_friction + now.drive_friction * rate.coast_friction)
    half += own.sine * (rate.drive * now.coast_friction + now.drive * rate.coast_friction)
    half -= own.sine * (rate.drive_friction * now.coast + now.drive_friction * rate.coast)
    return half / found.hubs


@compiled_once(FRICTION)
def book_rubbing(m: Model, t: float, y: Floats) -> None:
    """Add the losses since the last call, and note the powers here."""
    r, e = m.work.rubbing, m.state.energy
    h = t - r.time
    if h == 0.0:
        return
    before = (r.power[0], r.power[1], r.power[2], r.power[3])
    rates = (r.power_rate[0], r.power_rate[1], r.power_rate[2], r.power_rate[3])
    note_rubbing(m, t, y)
    for which in range(_POWERS):
        power, rate = r.power[which], r.power_rate[which]
        loss = integral(h, before[which], power, rates[which], rate)
        if which < 2:
            e.flank_loss[which] += loss
        else:
            e.hub_loss[which - 2] += loss
        e.loss_error += error_estimate(h, before[which], power, rates[which], rate)
        e.throughput += abs(loss)
