"""What Teodorescu et al. 2009 say beyond their figures, and what the runs of the presets give.

Makes the numbers of a table of `docs/validation.md`; without numbers of rows all of them::

    python -m gearidae_pages.paper_statements 1 3
    python -m gearidae_pages.paper_statements --picture docs/images/coating_family.png
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Final

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

import gearidae as gd
from gearidae.asperities import law_of
from gearidae.asperities.tip import INTERACTION_RANGE, asperity_of, tabor_parameter
from gearidae.drawing.style import COLOURS, LINE_STYLES
from gearidae.mesh import Geometry
from gearidae.records import EventKind, Flank
from gearidae.scene import Scene

__all__ = [
    "STATEMENTS",
    "coast_contact",
    "contact_time",
    "draw_family",
    "root_stress",
    "tip_radius_of_tabor",
]

MODULUS: Final = 2e9
"""Table 1's modulus of the monolayer [Pa]."""
RATIO: Final = 0.4
"""Poisson's ratio of the monolayer."""
SPEEDS: Final = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0)
"""Speeds over that of Table 1."""
SHARE: Final = 0.3 / 2.43
"""Harmonic over mean torque of the drive, Table 1."""
SHARES: Final = (0.5, 0.9, 1.0, 1.1, 1.2, 1.5, 2.0)
_LITTLE: Final = 1e-2
"""Part of the peak force from which on bodies count as in contact, of either sign."""
_BURST: Final = 2e-3
"""Negative torques that are farther apart belong to two bursts [s]: a thirtieth of a mesh cycle."""
_RANDOM: Final = 0.03, 0.06
"""Product N beta sigma of random surfaces."""
_STRENGTHS: Final = 1.56e9, 3.09e9
"""Tensile strengths of polysilicon from two foundries [Pa], doi:10.1115/imece2000-1100."""


def tip_radius_of_tabor(tabor: float, modulus: float, work_of_adhesion: float) -> float:
    """Tip radius at which Tabor's parameter has a value [m], atoms 0.165 nm apart."""
    return tabor**3 * INTERACTION_RANGE**3 * (modulus / work_of_adhesion) ** 2


def contact_time(run: xr.Dataset) -> float:
    """Time from the first to the last force above a hundredth of the peak, of either sign [s]."""
    force = np.abs(run["force"].values)
    times = run["time"].values[force > _LITTLE * float(run["force"].max())]
    return float(times[-1] - times[0])


def coast_contact(run: xr.Dataset) -> tuple[int, float]:
    """Contacts that begin on the coast flank, and the share of the time at which the teeth pull."""
    begins = (run["event_flank"] == Flank.COAST) & (run["event_kind"] == EventKind.ONSET)
    return int(begins.sum()), float((run["mesh_force"] < 0.0).mean())


def root_stress(geometry: Geometry, width: float, force: float) -> float:
    """Bending stress at the root of a pinion's tooth that is loaded at its tip [Pa].

    A cantilever, its flanks radial below the base circle, its root a dedendum of 1.25 modules below the pitch circle.
    """
    base, teeth, alpha = geometry.base_radius_pinion, geometry.pinion_teeth, geometry.pressure_angle
    pitch = base / math.cos(alpha)
    tip, root = pitch + geometry.module, pitch - 1.25 * geometry.module
    half = math.pi / (2.0 * teeth) + math.tan(alpha) - alpha  # of a tooth on the base circle [rad]
    slope = math.tan(math.acos(base / tip)) - half  # of the line of action against the tooth's middle plane
    arm = base / math.cos(slope) - root
    thickness = 2.0 * root * math.sin(half)
    return force * math.cos(slope) * arm * 6.0 / (width * thickness**2)


def _monolayer(scene: Scene) -> Scene:
    """Take the monolayer's modulus for that of the bodies, in a scene that is coated throughout."""
    return scene.replace(
        {
            "coating.sam_fraction": 1.0,
            "surface.youngs_modulus": MODULUS,
            "surface.poisson_ratio": RATIO,
            "contact.bodies": "rigid",
        }
    )


def _modulus() -> Iterator[str]:
    for words, scene in (
        ("silicon's modulus", gd.preset("roller_slow").replace({"coating.sam_fraction": 1.0})),
        (f"{MODULUS / 1e9:g} GPa, Poisson's ratio {RATIO:g}", _monolayer(gd.preset("roller_slow"))),
    ):
        surface = next(material.surface for material in scene.materials() if material.share > 0.0)
        tip = asperity_of(surface)
        law = law_of("jkr", surface)
        loss = law.loss * tip.hertz_factor * surface.roughness**2.5
        run = gd.simulate(scene)
        yield (
            f"{words}: Tabor {tabor_parameter(surface):.3g}, stretch {1e9 * tip.stretch_limit:.3g} nm, "
            f"loss {loss:.3g} J; Fig. 2(a) peak {1e6 * float(run['largest_mesh_force']):.3g} uN, "
            f"largest tension {1e6 * max(-float(run['smallest_mesh_force']), 0.0):.3g} uN"
        )


def _roughness() -> Iterator[str]:
    surface = gd.preset("roller_slow").surface
    tip = asperity_of(surface)
    for words, modulus, energy in (
        ("bare silicon", tip.modulus, tip.work_of_adhesion),
        ("monolayer, silicon's modulus", tip.modulus, 0.2),
        ("monolayer, its own modulus", MODULUS / (2.0 * (1.0 - RATIO**2)), 0.2),
    ):
        radius = tip_radius_of_tabor(5.0, modulus, energy)
        low, high = (1e9 * product / (surface.asperity_density * radius) for product in _RANDOM)
        yield (
            f"{words}: Tabor 5 from a tip radius of {1e9 * radius:.4g} nm on, whatever the roughness; with the "
            f"product N beta sigma of random surfaces up to a roughness of {low:.2g} to {high:.2g} nm"
        )


def _at_speed(part: float, fraction: float, share: float, *, follows: bool) -> Scene:
    """High-speed preset at a part of its speed, the mean torque that holds it and a harmonic in proportion."""
    base = gd.preset("teodorescu2009")
    assert base.load is not None
    assert base.initial is not None
    speed = part * base.initial.gear_speed
    ratio = base.geometry.base_radius_pinion / base.geometry.base_radius_gear
    torque = ratio * (base.load.torque + base.load.drag * speed**2)
    frequency = 1e4 * (part if follows else 1.0)
    return base.replace(
        {
            "coating.sam_fraction": fraction,
            "drive.torque": torque,
            "drive.harmonic": {"amplitude": share * torque, "frequency": frequency},
            "initial.gear_speed": speed,
            "run.duration": 10.0 / frequency,
        }
    )


def _speed() -> Iterator[str]:
    for words, fraction in (("SAM", 1.0), ("bare", 0.0)):
        for follows in (False, True):
            runs = [
                coast_contact(gd.simulate(_at_speed(part, fraction, SHARE, follows=follows)))
                for part in SPEEDS
            ]
            yield (
                f"{words}, harmonic {'in proportion to the speed' if follows else 'of 10 kHz'}, "
                f"{SPEEDS[0]:g} to {SPEEDS[-1]:g} times the speed: {sum(count for count, _ in runs)} contacts on the "
                f"coast flank, teeth pull for up to {100.0 * max(pull for _, pull in runs):.2g} % of the time"
            )
        for share in SHARES:
            run = gd.simulate(_at_speed(1.0, fraction, share, follows=False))
            count, pull = coast_contact(run)
            yield (
                f"{words}, harmonic {share:g} times the mean torque: smallest speed "
                f"{float(run['min_gear_speed']):.4g} rad/s, {count} contacts on the coast flank, "
                f"teeth pull for {100.0 * pull:.2g} % of the time"
            )


def _worn(fraction: float) -> xr.Dataset:
    scene = gd.preset("teodorescu2009_low_speed")
    return gd.simulate(scene.replace({"coating.sam_fraction": fraction, "run.samples": 300_001}))


def _reversals() -> Iterator[str]:
    for fraction in (0.6, 0.5):
        run = _worn(fraction)
        times = run["time"].values[run["gear_contact_torque"].values < 0.0]
        bursts = times[np.flatnonzero(np.diff(times, prepend=-np.inf) > _BURST)]
        exits = (run["event_kind"] == EventKind.MESH_EXIT) & (run["event_flank"] == Flank.DRIVE)
        begins = run["event_time"].values[exits]
        after = [int(((bursts > low) & (bursts < low + 5e-3)).sum()) for low in begins]
        yield (
            f"SAM {100 * fraction:g} %: {begins.size} mesh exits, bursts of negative torque within 5 ms of each: "
            f"{after}, elsewhere {bursts.size - sum(after)}"
        )


def _forces() -> Iterator[str]:
    for fraction in (1.0, 0.5):
        run = _worn(fraction)
        yield f"SAM {100 * fraction:g} %: force of the teeth up to {float(run['largest_mesh_force']):.2g} N"
    peak = float(gd.simulate(gd.preset("roller_fast"))["largest_mesh_force"])
    yield f"Fig. 2(b): {peak:.2g} N"


def _fatigue() -> Iterator[str]:
    scene = gd.preset("teodorescu2009")
    assert scene.gears is not None
    bare = gd.simulate(scene.replace({"coating.sam_fraction": 0.0}))
    largest = float(bare["largest_mesh_force"])
    for force in (largest, 40e-6):
        stress = root_stress(scene.geometry, scene.gears.face_width, force)
        low, high = (100.0 * stress / strength for strength in reversed(_STRENGTHS))
        yield (
            f"{1e6 * force:.3g} uN at the tip: {1e-6 * stress:.3g} MPa at the root, "
            f"{low:.2g} to {high:.2g} % of the strength"
        )


def _parting() -> Iterator[str]:
    for name in ("roller_slow", "roller_fast"):
        scene = gd.preset(name).replace({"run.samples": 40_001})
        bare, coated = (
            1e6 * contact_time(gd.simulate(scene.replace({"coating.sam_fraction": fraction})))
            for fraction in (0.0, 1.0)
        )
        assert scene.roller is not None
        yield f"{scene.roller.speed:g} m/s: in contact for {bare:.3g} us bare, {coated:.3g} us with the monolayer"


def _family() -> Iterator[str]:
    yield "a picture: see draw_family"


def _broken_silicon() -> Iterator[str]:
    bare = gd.preset("teodorescu2009_low_speed").replace({"coating.sam_fraction": 0.0, "run.samples": "off"})
    for duration, energies in ((0.3, (1.5, 1.2, 1.0, 0.88, 0.86, 0.8, 0.072)), (3.0, (0.82, 0.8, 0.78))):
        ds = gd.sweep(bare.replace({"run.duration": duration}), {"surface.energy": energies})
        for energy, outcome, slowest in zip(energies, gd.outcomes(ds), ds.min_gear_speed.values, strict=True):
            word = outcome.verdict.replace("_", " ")
            yield f"{energy:g} J/m^2, {duration:g} s: {word}, at least {slowest:.3g} rad/s"


def _sizes() -> Iterator[str]:
    geometry = gd.preset("teodorescu2009").geometry
    for name, base in (("pinion", geometry.base_radius_pinion), ("gear", geometry.base_radius_gear)):
        pitch = 2.0 * base / math.cos(geometry.pressure_angle)
        tips = pitch + 2.0 * geometry.module
        yield f"{name}: {1e6 * pitch:.4g} um across the pitch circle, {1e6 * tips:.4g} um across the tips"


STATEMENTS: Final[Mapping[int, Callable[[], Iterator[str]]]] = {
    1: _modulus,
    2: _roughness,
    3: _speed,
    4: _reversals,
    5: _forces,
    6: _fatigue,
    7: _parting,
    8: _family,
    9: _sizes,
    10: _broken_silicon,
}
"""Rows of the table, and what makes their numbers."""


def draw_family() -> Figure:
    """Draw Fig. 10 as a family over the torque and the thickness of the monolayer."""
    scene = gd.preset("teodorescu2009_low_speed")
    assert scene.drive is not None
    torques, layers = [part * scene.drive.torque for part in (0.7, 1.0, 1.3)], (0.0, 0.5e-9, 1e-9)
    chart = gd.studies.coating_map(
        scene,
        np.round(np.linspace(1.0, 0.5, 13), 4),
        over={"drive.torque": torques, "coating.thickness": layers},
    )
    figure = Figure(figsize=(8.0, 3.2), layout="constrained")
    for column, ax in enumerate(figure.subplots(1, len(layers), sharey=True)):
        for row, torque in enumerate(torques):
            line = chart["characteristic_frequency"].isel(torque=row, thickness=column)
            ax.plot(
                100.0 * line["sam_fraction"],
                1e-3 * line,
                color=COLOURS[row],
                linestyle=LINE_STYLES[row],
                label=f"{1e18 * torque:.3g} aN m",
            )
        ax.set_yscale("log")
        ax.set_title(f"monolayer of {1e9 * layers[column]:g} nm", fontsize="medium", loc="left")
        ax.set_xlabel("SAM (%)")
        if column == 0:
            ax.set_ylabel("characteristic frequency (kHz)")
            ax.legend(frameon=False, fontsize="small")
    return figure


def main(arguments: Sequence[str]) -> None:
    """Print rows, or draw the picture of row 8 into a file."""
    if arguments[:1] == ["--picture"]:
        draw_family().savefig(Path(arguments[1]), dpi=150, metadata={"Software": None})
        return
    for number in [int(argument) for argument in arguments] or STATEMENTS:
        for line in STATEMENTS[number]():
            sys.stdout.write(f"{number}  {line}\n")
            sys.stdout.flush()


if __name__ == "__main__":
    main(sys.argv[1:])
