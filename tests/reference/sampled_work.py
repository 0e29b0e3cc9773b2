"""The energies of a run from its samples alone: a second way to what the engine keeps at its own steps.

``sum of mean(M) times the angle turned``: of a constant torque that is exact however the gear trembles between two
samples, and of a torque that changes it errs with the second power of the sampling only. What torques and speeds do not
explain is what the contacts took.
"""

import math

import numpy as np


class SampledWork:
    """Works and losses of a run [J] from its samples; trapezoids over the angles turned."""

    def __init__(self, scene, run):
        self._gears, self._mesh, self._drive, self._load = scene.gears, scene.mesh, scene.drive, scene.load
        self._pinion_radius = scene.gears.pinion_base_radius
        self._gear_radius = scene.geometry.base_radius_gear
        piece = {
            str(name): run[name].values for name in ("time", *run.data_vars) if run[name].dims == ("time",)
        }
        time, speed, u = piece["time"], piece["gear_speed"], piece["transmission_error"]
        kinetic = 0.5 * self._gears.pinion_inertia * piece["pinion_speed"] ** 2
        kinetic += 0.5 * self._gears.gear_inertia * speed**2
        self.kinetic_change = float(kinetic[-1] - kinetic[0])
        start = scene.initial.mesh_phase * scene.geometry.base_pitch / self._gear_radius
        gear = np.diff(piece["gear_angle"])
        pinion = np.diff(self._pinion_angle(start + piece["gear_angle"], u))
        rate = self._pinion_radius * piece["pinion_speed"] - self._gear_radius * speed
        resisting = np.maximum(prescribed_torque(self._load, time), 0.0)
        for name, torque, turned in (
            ("drive_work", prescribed_torque(self._drive, time), pinion),
            ("drag_loss", self._load.drag * speed * np.abs(speed), gear),
            ("dry_loss", resisting, np.abs(gear)),
            ("damping_loss", self._mesh.damping * rate, np.diff(u)),
        ):
            setattr(self, name, float(np.sum(0.5 * (torque[1:] + torque[:-1]) * turned)))

    @property
    def contact_loss(self):
        """What no torque and no speed accounts for."""
        taken = self.drag_loss + self.dry_loss + self.damping_loss
        return self.drive_work - taken - self.kinetic_change

    def _pinion_angle(self, gear, u):
        """phi1 of ``R1 phi1 = u + R2 phi2 + e(phi1)``, by iteration: e is small against R1."""
        rigid = (u + self._gear_radius * gear) / self._pinion_radius
        angle = rigid
        for _ in range(20 if self._mesh.static_error else 0):
            error = sum(h.amplitude * np.cos(h.order * angle + h.phase) for h in self._mesh.static_error)
            angle = rigid + error / self._pinion_radius
        return angle


def prescribed_torque(shaft, time):
    """Prescribed torque of a shaft [N m]."""
    torque = np.full(time.shape, shaft.torque)
    for harmonic in shaft.harmonic:
        torque += harmonic.amplitude * np.cos(2.0 * math.pi * harmonic.frequency * time + harmonic.phase)
    if shaft.schedule:
        knots = np.array(shaft.schedule)
        torque += np.interp(time, knots[:, 0], knots[:, 1])
    return torque
