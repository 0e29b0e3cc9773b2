"""``gearidae check``: estimates and limits of the model for a scene, without a run."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

from gearidae.archive.variables import EVENTS
from gearidae.cli.case import read_scene
from gearidae.cli.codes import DONE
from gearidae.cli.fact import Fact, Facts
from gearidae.cli.machine import print_json
from gearidae.cli.output import print_line, show_rows
from gearidae.cli.tables import show_validity
from gearidae.progress import in_words
from gearidae.runs.plausibility import doubts
from gearidae.runs.run_time import run_time
from gearidae.runs.validity import validity_rows
from gearidae.scene import GearScene, TrainScene, is_long_train, require_gears
from gearidae.scene.friction import has_flank_friction
from gearidae.scene.joints import Joint, has_joint_friction, has_pin, joints
from gearidae.scene.sampled import columns_of
from gearidae.scene.validity_row import contact_subject, mean_note

if TYPE_CHECKING:
    from gearidae.scene import Scene


def check_case(case: str, settings: Sequence[str], *, as_json: bool = False) -> int:
    """Check a case and print geometry, contact, estimates, limits of the model, and warnings.

    Parameters
    ----------
    case : str
        Case file or preset.
    settings : sequence of str
        ``key=value`` pairs.
    as_json : bool, optional
        Whether to print one JSON object in place of tables.

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
    if isinstance(scene, TrainScene) and len(scene.meshes) == 1:
        scene = require_gears(scene)
    facts, rows, warnings = list(_facts(scene)), validity_rows(scene), list(doubts(scene))
    if as_json:
        print_json(
            {
                "name": scene.name,
                "rows": list(_as_objects(facts)),
                "limits": [asdict(row) for row in rows],
                "warnings": warnings,
                "scene": scene.to_dict(),
            }
        )
        return DONE
    show_rows(fact[:3] for fact in facts)
    each = " in each mesh" * isinstance(scene, TrainScene)
    show_validity(rows, about=contact_subject(roller=scene.roller is not None) + each)
    if scene.contact.is_discrete:
        print_line("A run is one specimen of this design: contact.seed numbers the others.")
    elif note := mean_note(rows):
        print_line(f"Verdicts of runs are a {note}")
    for doubt in warnings:
        print_line(f"Warning: {doubt}")
    return DONE


def _as_objects(facts: Iterable[Fact]) -> Iterator[dict[str, Any]]:
    """Give each row the heading above it."""
    section = ""
    for fact in facts:
        if fact.text:
            yield {"section": section, **fact._asdict()}
        else:
            section = fact.name


def _facts(scene: Scene) -> Facts:
    yield Fact(f"{scene.name}: input is valid")
    if isinstance(scene, GearScene):
        yield from _geometry(scene)
        yield from _estimates(scene)
    elif isinstance(scene, TrainScene):
        from gearidae.cli.checking_train import train_facts

        yield from train_facts(scene)
    else:
        yield from _roller(scene)
    yield from _contact(scene)
    yield from _run(scene)


def _geometry(scene: Scene) -> Facts:
    geometry = scene.geometry
    pinion, gear = geometry.base_radius_pinion, geometry.base_radius_gear
    ratio, pitch, module, path = (
        geometry.contact_ratio, geometry.base_pitch, geometry.module, geometry.path_length
    )  # fmt: skip
    yield Fact("Gears")
    yield Fact("contact ratio", f"{ratio:.4g}", "pairs in mesh on average", ratio, "1")
    yield Fact("base pitch", f"{pitch * 1e6:.5g} um", "between neighbouring flanks", pitch, "m")
    radii = f"{pinion * 1e6:.6g} um, {gear * 1e6:.6g} um"
    yield Fact("base radii", radii, "pinion, gear", (pinion, gear), "m")
    yield Fact("module", f"{module * 1e6:.4g} um", "also the addendum", module, "m")
    yield Fact("path of contact", f"{path * 1e6:.4g} um", "from mesh entry to exit", path, "m")


def _estimates(scene: GearScene) -> Facts:
    from gearidae.runs.equilibrium import natural_frequency
    from gearidae.runs.estimates import effective_mass, resting_gap, steady_speed

    yield Fact("Estimates", "", "from the mean torques over the run, without sticking")
    speed = steady_speed(scene)
    if scene.drive.law is not None or scene.load.law is not None:
        yield Fact("gear speed", "unknown", "a torque law decides", None, "rad/s")
    elif speed == 0.0:
        words = "the mean drive torque does not overcome the dry resistance"
        yield Fact("gear speed", "0 rad/s", words, 0.0, "rad/s")
    elif math.isinf(speed):
        yield Fact("gear speed", "unbounded", "no limit: load.drag is 0", None, "rad/s")
    else:
        mesh = speed * scene.gears.gear_teeth / (2 * math.pi)
        turns = speed * scene.run.duration / (2 * math.pi)
        yield Fact("gear speed", f"{speed:.5g} rad/s", f"{speed * 30 / math.pi:.4g} rpm", speed, "rad/s")
        yield Fact("mesh frequency", f"{mesh:.5g} Hz", "teeth per second", mesh, "Hz")
        yield Fact("turns in the run", f"{turns:.4g}", "of the gear", turns, "1")
    yield from _friction(scene)
    mass = effective_mass(scene)
    yield Fact("effective mass", f"{mass:.4g} kg", "of the transmission error", mass, "kg")
    gap = resting_gap(scene)
    if not math.isnan(gap):
        relative = gap / scene.surface.roughness
        words = f"{relative:.3g} roughnesses, one pair at the pitch point"
        yield Fact("equilibrium gap", f"{gap * 1e9:.4g} nm", words, gap, "m")
        natural = natural_frequency(scene)
        words = "of small oscillations about the equilibrium gap"
        yield Fact("natural frequency", f"{natural:.4g} Hz", words, natural, "Hz")


def _friction(scene: GearScene) -> Facts:
    from gearidae.mesh.friction import hub_share, hub_starting_torque
    from gearidae.runs.estimates import mean_force, steady_speed
    from gearidae.runs.rubbing import flank_loss, hub_arms, hub_constants, joint_loads, rested, sliding

    geometry = scene.geometry
    if has_flank_friction(scene):
        loss = flank_loss(scene, mean_force(scene))
        if math.isnan(loss):
            words = "no mean torque presses the teeth together"
            yield Fact("lost to flank friction", "unknown", words, None, "1")
        else:
            words = "of the drive's work, at a constant force"
            yield Fact("lost to flank friction", f"{100 * loss:.3g} %", words, loss, "1")
    if not has_joint_friction(scene):
        return
    where = "at the load of the initial speed" if scene.drive.law else "under the mean drive"
    for joint, load in joint_loads(scene, mean_force(scene)):
        words = f"friction takes {joint.torque(load):.4g} N m of its shaft, {where}"
        yield Fact(f"load of the {joint.name}", f"{load * 1e6:.4g} uN", words, load, "N")
        if joint.rise > 0.0:
            yield ageing_fact(joint, load)
    if has_pin(scene):
        return
    lost = 1.0 - hub_share(geometry, 1.0, hub_arms(sliding(scene, steady_speed(scene))))
    words = "of the drive's work, without adhesion and axial loads"
    yield Fact("lost to hub friction", f"{100 * lost:.3g} %", words, lost, "1")
    there = rested(scene)
    start = hub_starting_torque(geometry, scene.load.torque, 1.0, hub_arms(there), hub_constants(there))
    words = "of the pinion: dry resistance and hubs, without the teeth"
    if there != joints(scene):
        words += f"; after {scene.initial.rest_time:g} s of rest"
    yield Fact("starting torque", f"{start:.4g} N m", words, start, "N m")


def ageing_fact(joint: Joint, load: float | None) -> Fact:
    """Say below which speed a joint that ages may chatter, and what friction takes of a load [N] after a long rest."""
    speed = joint.chatter_speed
    words = f"below this sliding speed, {speed / joint.sliding_radius:.4g} rad/s of its shaft, it may chatter"
    if load is not None:
        words += f"; after a long rest friction takes {joint.of_age(math.inf).torque(load):.4g} N m"
    return Fact(f"ageing of the {joint.name}", f"{speed * 1e6:.4g} um/s", words, speed, "m s-1")


def _roller(scene: Scene) -> Facts:
    roller = scene.roller
    assert roller is not None
    sizes, energy = (roller.radius, roller.width), 0.5 * roller.mass * roller.speed**2
    yield Fact("Roller")
    yield Fact("radius, width", ", ".join(f"{size * 1e6:.4g} um" for size in sizes), "", sizes, "m")
    yield Fact("energy of the approach", f"{energy:.4g} J", "", energy, "J")
    if roller.speed > 0.0:
        flight = roller.height / roller.speed
        yield Fact("flight to the mean plane", f"{flight * 1e6:.4g} us", "without contact", flight, "s")


def _contact(scene: Scene) -> Facts:
    from gearidae.asperities.tip import asperity_of

    contact, modulus = scene.contact, asperity_of(scene.surface).modulus
    yield Fact("Contact", "", f"{contact.bodies} bodies, {contact.roughness} {contact.asperity} asperities")
    yield Fact("contact modulus E*", f"{modulus * 1e-9:.5g} GPa", "", modulus, "Pa")
    yield from _coating(scene)
    for surface, _, _, name in scene.materials():
        tip = asperity_of(surface)
        pull, stretch = tip.pull_off, tip.stretch_limit
        yield Fact(f"{name}: pull-off load Pc", f"{pull * 1e6:.4g} uN", "of one asperity", pull, "N")
        words = f"{stretch / scene.surface.roughness:.3g} of the roughness"
        yield Fact(f"{name}: stretch limit dc", f"{stretch * 1e9:.4g} nm", words, stretch, "m")


def _coating(scene: Scene) -> Facts:
    coating = scene.coating
    pinion, gear = coating.fractions
    means = "means of tooth and place" if coating.by_place else ""
    if coating.pairing == "patches":
        yield Fact("SAM fraction", f"{pinion:g}", means, pinion, "1")
    else:
        words = f"{pinion:g} of the pinion, {gear:g} of the gear"
        yield Fact("SAM fractions", words, means or "independent sides", (pinion, gear), "1")
        shares = ", ".join(
            f"{100.0 * material.share:.3g} % {material.name}" for material in scene.materials()
        )
        yield Fact("interface", shares)
    if (thickness := coating.thickness) > 0.0:
        recess = 2.0 * thickness / scene.surface.roughness
        words = f"bare on bare is {recess:.3g} roughnesses farther apart"
        yield Fact("monolayer's thickness", f"{thickness * 1e9:.4g} nm", words, thickness, "m")


def _run(scene: Scene) -> Facts:
    from gearidae.runs.ringing_samples import ringing_samples

    needed = ringing_samples(scene)
    run = scene.run
    count = (needed or 0) if run.samples == "ringing" else run.sample_count
    yield Fact("Run")
    yield Fact("duration", f"{run.duration * 1e3:g} ms", "", run.duration, "s")
    expected = run_time(scene)
    columns = len(columns_of(scene))
    if is_long_train(scene):
        from gearidae.cli.checking_train import train_columns

        columns = train_columns(scene)
    numbers = 1 + columns  # with the time
    event = sum(np.dtype(variable.dtype).itemsize for variable in EVENTS.values())
    sizes = 8e-6 * numbers * count, 1e-6 * event * expected.events
    yield Fact("samples", f"{count}", f"{sizes[0]:.3g} MB, and some {sizes[1]:.1g} MB of events", count, "1")
    if needed is not None:
        words = 'to show how the contacts ring: run.samples = "ringing"'
        words = words if count < needed else "to show how the contacts ring"
        yield Fact("samples needed", f"{needed}", words, needed, "1")
    yield Fact("relative tolerance", f"{run.rtol:g}", "", run.rtol, "1")
    words = f"{expected.steps:.2g} steps, within a factor of about {expected.within}"
    yield Fact("expected wall time", in_words(expected.seconds), words, expected.seconds, "s")
