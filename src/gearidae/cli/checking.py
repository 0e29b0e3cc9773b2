"""``gearidae check``: estimates and limits of the model for a scene, without a run."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from gearidae.archive.variables import EVENTS
from gearidae.cli.case import read_scene
from gearidae.cli.codes import DONE
from gearidae.cli.output import print_line, show_rows
from gearidae.cli.tables import show_validity
from gearidae.progress import in_words
from gearidae.runs.plausibility import doubts
from gearidae.runs.run_time import run_time
from gearidae.runs.validity import validity_rows
from gearidae.scene import GearScene
from gearidae.scene.friction import has_flank_friction
from gearidae.scene.joints import has_joint_friction, has_pin
from gearidae.scene.sampled import columns_of
from gearidae.scene.validity_row import contact_subject, mean_note

if TYPE_CHECKING:
    from gearidae.scene import Scene

Rows = Iterator[tuple[str, str, str]]


def check_case(case: str, settings: Sequence[str]) -> int:
    """Check a case and print geometry, contact, estimates, limits of the model, and warnings.

    Parameters
    ----------
    case : str
        Case file or preset.
    settings : sequence of str
        ``key=value`` pairs.

    Returns
    -------
    int
        Exit code.

    Raises
    ------
    SceneError
        If the case is wrong.
    """
    scene = read_scene(case, settings)
    show_rows(_rows(scene))
    rows = validity_rows(scene)
    show_validity(rows, about=contact_subject(roller=scene.roller is not None))
    if scene.contact.is_discrete:
        print_line("A run is one specimen of this design: contact.seed numbers the others.")
    elif note := mean_note(rows):
        print_line(f"Verdicts of runs are a {note}")
    for doubt in doubts(scene):
        print_line(f"Warning: {doubt}")
    return DONE


def _rows(scene: Scene) -> Rows:
    yield f"{scene.name}: input is valid", "", ""
    if isinstance(scene, GearScene):
        yield from _geometry(scene)
        yield from _estimates(scene)
    else:
        yield from _roller(scene)
    yield from _contact(scene)
    yield from _run(scene)


def _geometry(scene: Scene) -> Rows:
    geometry = scene.geometry
    pinion, gear = geometry.base_radius_pinion, geometry.base_radius_gear
    yield "Gears", "", ""
    yield "contact ratio", f"{geometry.contact_ratio:.4g}", "pairs in mesh on average"
    yield "base pitch", f"{geometry.base_pitch * 1e6:.5g} um", "between neighbouring flanks"
    yield "base radii", f"{pinion * 1e6:.6g} um, {gear * 1e6:.6g} um", "pinion, gear"
    yield "module", f"{geometry.module * 1e6:.4g} um", "also the addendum"
    yield "path of contact", f"{geometry.path_length * 1e6:.4g} um", "from mesh entry to exit"


def _estimates(scene: GearScene) -> Rows:
    from gearidae.runs.equilibrium import natural_frequency
    from gearidae.runs.estimates import effective_mass, resting_gap, steady_speed

    yield "Estimates", "", "from the mean torques over the run, without sticking"
    speed = steady_speed(scene)
    if scene.drive.law is not None or scene.load.law is not None:
        yield "gear speed", "unknown", "a torque law decides"
    elif speed == 0.0:
        yield "gear speed", "0 rad/s", "the mean drive torque does not overcome the dry resistance"
    elif math.isinf(speed):
        yield "gear speed", "unbounded", "no limit: load.drag is 0"
    else:
        yield "gear speed", f"{speed:.5g} rad/s", f"{speed * 30 / math.pi:.4g} rpm"
        yield "mesh frequency", f"{speed * scene.gears.gear_teeth / (2 * math.pi):.5g} Hz", "teeth per second"
        yield "turns in the run", f"{speed * scene.run.duration / (2 * math.pi):.4g}", "of the gear"
    yield from _friction(scene)
    yield "effective mass", f"{effective_mass(scene):.4g} kg", "of the transmission error"
    gap = resting_gap(scene)
    if not math.isnan(gap):
        relative = gap / scene.surface.roughness
        yield (
            "equilibrium gap",
            f"{gap * 1e9:.4g} nm",
            f"{relative:.3g} roughnesses, one pair at the pitch point",
        )
        yield (
            "natural frequency",
            f"{natural_frequency(scene):.4g} Hz",
            "of small oscillations about the equilibrium gap",
        )


def _friction(scene: GearScene) -> Rows:
    from gearidae.mesh.friction import hub_share, hub_starting_torque
    from gearidae.runs.estimates import mean_force
    from gearidae.runs.rubbing import flank_loss, hub_constants, hub_radii, joint_loads

    geometry, coefficient, radii = scene.geometry, scene.gears.hub_friction, hub_radii(scene)
    if has_flank_friction(scene):
        loss = flank_loss(scene, mean_force(scene))
        if math.isnan(loss):
            yield "lost to flank friction", "unknown", "no mean torque presses the teeth together"
        else:
            yield "lost to flank friction", f"{100 * loss:.3g} %", "of the drive's work, at a constant force"
    if not has_joint_friction(scene):
        return
    where = "at the load of the initial speed" if scene.drive.law else "under the mean drive"
    for joint, load in joint_loads(scene, mean_force(scene)):
        torque = f"friction takes {joint.torque(load):.4g} N m"
        yield f"load of the {joint.name}", f"{load * 1e6:.4g} uN", f"{torque} of its shaft, {where}"
    if has_pin(scene):
        return
    lost = 1.0 - hub_share(geometry, coefficient, radii)
    words = "of the drive's work, without adhesion and axial loads"
    yield "lost to hub friction", f"{100 * lost:.3g} %", words
    start = hub_starting_torque(geometry, scene.load.torque, coefficient, radii, hub_constants(scene))
    words = "of the pinion: dry resistance and hubs, without the teeth"
    yield "starting torque", f"{start:.4g} N m", words


def _roller(scene: Scene) -> Rows:
    roller = scene.roller
    assert roller is not None
    yield "Roller", "", ""
    yield "radius, width", f"{roller.radius * 1e6:.4g} um, {roller.width * 1e6:.4g} um", ""
    yield "energy of the approach", f"{0.5 * roller.mass * roller.speed**2:.4g} J", ""
    if roller.speed > 0.0:
        yield "flight to the mean plane", f"{roller.height / roller.speed * 1e6:.4g} us", "without contact"


def _contact(scene: Scene) -> Rows:
    from gearidae.asperities.tip import asperity_of

    yield (
        "Contact",
        "",
        f"{scene.contact.bodies} bodies, {scene.contact.roughness} {scene.contact.asperity} asperities",
    )
    yield "contact modulus E*", f"{asperity_of(scene.surface).modulus * 1e-9:.5g} GPa", ""
    yield from _coating(scene)
    for surface, _, _, name in scene.materials():
        tip = asperity_of(surface)
        yield f"{name}: pull-off load Pc", f"{tip.pull_off * 1e6:.4g} uN", "of one asperity"
        relative = tip.stretch_limit / scene.surface.roughness
        yield (
            f"{name}: stretch limit dc",
            f"{tip.stretch_limit * 1e9:.4g} nm",
            f"{relative:.3g} of the roughness",
        )


def _coating(scene: Scene) -> Rows:
    coating = scene.coating
    pinion, gear = coating.fractions
    means = "means of tooth and place" if coating.by_place else ""
    if coating.pairing == "patches":
        yield "SAM fraction", f"{pinion:g}", means
    else:
        yield "SAM fractions", f"{pinion:g} of the pinion, {gear:g} of the gear", means or "independent sides"
        shares = ", ".join(
            f"{100.0 * material.share:.3g} % {material.name}" for material in scene.materials()
        )
        yield "interface", shares, ""
    if coating.thickness > 0.0:
        recess = 2.0 * coating.thickness / scene.surface.roughness
        yield (
            "monolayer's thickness",
            f"{coating.thickness * 1e9:.4g} nm",
            f"bare on bare is {recess:.3g} roughnesses farther apart",
        )


def _run(scene: Scene) -> Rows:
    from gearidae.runs.ringing_samples import ringing_samples

    needed = ringing_samples(scene)
    run = scene.run
    count = (needed or 0) if run.samples == "ringing" else run.sample_count
    yield "Run", "", ""
    yield "duration", f"{run.duration * 1e3:g} ms", ""
    expected = run_time(scene)
    numbers = 1 + len(columns_of(scene))  # with the time
    event = sum(np.dtype(variable.dtype).itemsize for variable in EVENTS.values())
    sizes = 8e-6 * numbers * count, 1e-6 * event * expected.events
    yield "samples", f"{count}", f"{sizes[0]:.3g} MB, and some {sizes[1]:.1g} MB of events"
    if needed is not None:
        words = 'to show how the contacts ring: run.samples = "ringing"'
        yield "samples needed", f"{needed}", words if count < needed else "to show how the contacts ring"
    yield "relative tolerance", f"{run.rtol:g}", ""
    yield (
        "expected wall time",
        in_words(expected.seconds),
        f"{expected.steps:.2g} steps, within a factor of about three",
    )
