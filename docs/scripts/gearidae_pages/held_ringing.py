"""What a held gear's ringing costs with a damping and with a film: ``python -m gearidae_pages.held_ringing``.

Prints the table of ``docs/howto_long_runs.md``: processor time, steps and the balance of gears with discrete asperities
whose torque rises for five seconds (a minute on a quiet core).
"""

from __future__ import annotations

import sys
import time
from typing import Final

import gearidae as gd

__all__ = ["ACTIONS", "COVERAGES", "SCENE", "markdown"]

SCENE: Final = gd.Scene.from_dict(
    {
        "gears": {
            "pinion_teeth": 18,
            "gear_teeth": 54,
            "module": "3 um",
            "pressure_angle": "20 deg",
            "face_width": "2.5 um",
            "density": "2330 kg/m^3",
        },
        "mesh": {"backlash": "0.25 um", "tip_relief_radius": "10 um"},
        "surface": gd.preset("teodorescu2009").to_dict()["surface"],
        "coating": {"sam_fraction": 1.0, "energy": "0.1 J/m^2"},
        "contact": {"roughness": "discrete"},
        "drive": {"schedule": [["0 s", "0 N m"], ["5 s", "1.2e-17 N m"]]},
        "load": {"torque": "3e-18 N m", "drag": "8e-18 N m s^2/rad^2"},
        "initial": {"gear_speed": "0 rad/s", "gap": "0.1 um", "mesh_phase": 0.3},
        "run": {"duration": "5 s", "samples": "off"},
    }
)
"""Gears from rest under a torque that rises to twelve times what the dry load takes at the pinion."""
ACTIONS: Final = {
    "damping 1.4e-7 N s/m": {"mesh.damping": 1.4e-7},
    "film 1e-5 N s/m, 30 nm": {"mesh.film_damping": 1e-5, "mesh.film_gap": 3e-8},
}
"""Dampings that dissipate the energy of the ringing, as keys of a scene."""
COVERAGES: Final = {"full coverage": 1.0, "half": 0.5, "bare": 0.0}
"""Fractions of the surface under the coating."""
_RTOLS: Final = (1e-6, 1e-5, 1e-4)


def _cell(scene: gd.Scene, rtol: float) -> tuple[str, float, str]:
    """Processor time and steps of a run; its residual over the bound; its verdict."""
    begin = time.process_time()
    run = gd.simulate(scene, rtol=rtol, progress=False)
    taken = time.process_time() - begin
    balance = run.gearidae.energy_balance
    share = abs(balance["residual"]) / balance["residual_bound"]
    words = run.gearidae.verdicts()["words"].iloc[0]
    return f"{taken:.2g} s, {float(run.attrs['steps']) / 1e6:.2g} million", share, words


def markdown() -> str:
    """Make the table, and below it the verdicts that its runs come to."""
    lines = [
        f"| | `rtol` | {' | '.join(COVERAGES)} | balance: residual over its bound, at most |",
        f"| {' | '.join(['---'] * (3 + len(COVERAGES)))} |",
    ]
    verdicts = set()
    for rtol in _RTOLS:
        for name, changes in ACTIONS.items():
            cells = [
                _cell(SCENE.replace({**changes, "coating.sam_fraction": covered}), rtol)
                for covered in COVERAGES.values()
            ]
            verdicts |= {words for _, _, words in cells}
            worst = max(share for _, share, _ in cells)
            lines.append(
                f"| {name} | {rtol:.0e} | {' | '.join(text for text, _, _ in cells)} | {worst:.2g} |"
            )
    return "\n".join([*lines, "", *sorted(verdicts)])


if __name__ == "__main__":
    gd.simulate(SCENE.replace({"run.duration": 1e-3}), progress=False)  # compiles
    sys.stdout.write(f"{markdown()}\n")
