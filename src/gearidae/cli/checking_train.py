"""What ``gearidae check`` says of a train: each mesh, each hub, how loops close, and what starts it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gearidae.archive.train.variables import TRAIN_SAMPLES, TWO_SHAFTS, left_out
from gearidae.cli.checking import ageing_fact
from gearidae.cli.fact import Fact, Facts
from gearidae.mesh.pair_contact import pair_contact
from gearidae.mesh.train_modes import natural_frequencies
from gearidae.runs.rubbing import flank_loss
from gearidae.runs.train_statics import (
    hub_loads,
    hubs_at_rest,
    mesh_forces,
    overlapping,
    starting_torque,
    steady_speed,
)
from gearidae.scene.group import shorten
from gearidae.scene.joints import ages, train_pin
from gearidae.scene.train_pair import rubbing_mesh

if TYPE_CHECKING:
    from gearidae.arrays import Floats
    from gearidae.scene import TrainScene
    from gearidae.scene.train import TrainMesh


def train_facts(scene: TrainScene) -> Facts:
    """Yield the rows of a train."""
    train, forces = scene.train, mesh_forces(scene)
    drive, load = train.shafts[train.drive], train.shafts[train.load]
    size = f"{len(train.shafts)} shafts, {len(train.meshes)} meshes, without friction of the teeth"
    yield Fact("Train", "", size)
    ratio = 1 / load.ratio
    yield Fact("ratio", f"{ratio}", f"speed of {drive.name} over that of {load.name}", float(ratio), "1")
    yield _speed(scene)
    for mesh, force in zip(train.meshes, forces, strict=True):
        yield from _mesh(scene, mesh, float(force))
    yield Fact("Whole train")
    yield from _loops(scene, forces)
    yield from _hubs(scene, forces)
    frequencies = natural_frequencies(scene, forces)
    if frequencies:
        text = ", ".join(f"{frequency:.4g}" for frequency in frequencies)
        words = "of small oscillations of the whole train"
        yield Fact("natural frequencies", f"{text} Hz", words, tuple(frequencies), "Hz")
    for first, second in overlapping(train):
        yield Fact("tip circles overlap", f"{first} and {second}", "they must lie in different planes")
    yield from _sides(scene)


def train_columns(scene: TrainScene) -> int:
    """Count the samples at one time that a dataset of a train keeps."""
    sizes = {"shaft": len(scene.train.shafts), "mesh": len(scene.train.meshes), "time": 1}
    absent = left_out(scene)
    along = sum(sizes[v.dims[0]] for name, v in TRAIN_SAMPLES.items() if name not in absent)
    return along + sum(source not in absent for source in TWO_SHAFTS.values())


def _mesh(scene: TrainScene, mesh: TrainMesh, force: float) -> Facts:
    geometry, contact = mesh.geometry, pair_contact(scene.pair(mesh.name))
    yield Fact(f"Mesh {mesh.name}", "", f"{mesh.driver} drives {mesh.driven}")
    teeth = geometry.pinion_teeth, geometry.gear_teeth
    yield Fact("teeth", f"{teeth[0]}:{teeth[1]}", f"ratio {mesh.ratio}", teeth, "1")
    contacts = geometry.contact_ratio
    yield Fact("contact ratio", f"{contacts:.4g}", "pairs in mesh on average", contacts, "1")
    where = f"line of centres at {math.degrees(mesh.angle):.6g} deg"
    yield Fact(
        "phase", f"{mesh.phase:.10g}", f"of {geometry.base_pitch * 1e6:.5g} um; {where}", mesh.phase, "1"
    )
    own = [
        f"{table}.{key} = {shorten(value)}"
        for table in ("coating", "surface")
        for key, value in scene.meshes[mesh.name].own(table).items()
    ]
    if own:
        yield Fact("of its own", ", ".join(own), "in place of what Contact says below")
    yield Fact("force", f"{force * 1e6:.4g} uN", "under the mean drive", force, "N")
    gap = contact.resting_gap(force)
    if not math.isnan(gap):
        yield Fact("equilibrium gap", f"{gap * 1e9:.4g} nm", "one pair at the pitch point", gap, "m")
        stiffness = contact.stiffness(gap)
        yield Fact("stiffness", f"{stiffness:.4g} N/m", "there", stiffness, "N/m")
    loss = flank_loss(scene.pair(mesh.name), force)
    if loss != 0.0 and not math.isnan(loss):
        words = "of the work that arrives, at a constant force"
        yield Fact("lost to flank friction", f"{100.0 * loss:.3g} %", words, loss, "1")


def _speed(scene: TrainScene) -> Fact:
    load = scene.train.shafts[scene.train.load]
    speed, name = steady_speed(scene) * float(load.ratio), f"speed of {load.name}"
    if scene.drive.law is not None or scene.load.law is not None:
        return Fact(name, "unknown", "a torque law decides")
    if math.isinf(speed):
        return Fact(name, "unbounded", "nothing slows the train down")
    words = "from the mean torques, without friction or sticking"
    return Fact(name, f"{speed:.5g} rad/s", words, speed, "rad/s")


def _loops(scene: TrainScene, forces: Floats) -> Facts:
    """Say how loops close, and how the shafts that are driven twice share their load."""
    train = scene.train
    for loop in train.loops:
        mesh = train.mesh(loop[-1])
        length = mesh.residual * mesh.geometry.base_pitch
        text = f"{mesh.residual:.4g} pitches, {length * 1e9:.4g} nm"
        words = f"residual with which the loop {', '.join(loop)} closes"
        yield Fact("loop", text, words, mesh.residual, "1")
    for number, shaft in enumerate(train.shafts):
        driving = [k for k, mesh in enumerate(train.meshes) if mesh.b == number]
        torques = [float(forces[k]) * train.meshes[k].geometry.base_radius_gear for k in driving]
        if len(driving) > 1 and sum(torques) != 0.0:
            shares = tuple(torque / sum(torques) for torque in torques)
            text = ", ".join(
                f"{train.meshes[k].name} {100.0 * share:.4g} %"
                for k, share in zip(driving, shares, strict=True)
            )
            yield Fact(f"load of {shaft.name} shared", text, "at the phases of the start", shares, "1")


def _hubs(scene: TrainScene, forces: Floats) -> Facts:
    """Loads of the hubs, and the torque that starts the train against them."""
    vectors = hub_loads(scene.train, forces)
    for (name, shaft), vector in zip(scene.shafts.items(), vectors, strict=True):
        if (hub := shaft.hub_of(name)) is None:
            continue
        load, angle = math.hypot(*vector), math.atan2(vector[1], vector[0])
        words = "without the force of the law"
        if scene.drive.law is None:
            words = f"friction takes {hub.torque(load):.4g} N m"
        text = f"{load * 1e6:.4g} uN at {math.degrees(angle):.4g} deg"
        yield Fact(f"load of the hub of {name}", text, words, load, "N")
        if hub.rise > 0.0:
            yield ageing_fact(hub, load if scene.drive.law is None else None)
    if (pin := train_pin(scene)).rise * pin.radius > 0.0:
        yield ageing_fact(pin, None)
    there = hubs_at_rest(scene)
    if not any(hub is not None and hub.largest > 0.0 for hub in there) or scene.drive.law is not None:
        return
    torque, starting = starting_torque(scene)
    if math.isinf(torque):
        locked = [mesh.driven for mesh, f in zip(scene.train.meshes, starting, strict=True) if np.isinf(f)]
        words = f"the hub of {locked[0]} locks the train" if locked else "hubs lock the train"
        yield Fact("starting torque", "none", words)
    elif rubbing_mesh(scene) is not None:
        yield Fact("starting torque", "unknown", "what friction of flanks holds is not unique")
    else:
        words = "of the drive: dry resistances and hubs, without the teeth"
        words += ", at the phases of the start" if scene.train.loops else ""
        if ages(scene):
            words += f"; after {scene.initial.rest_time:g} s of rest"
        yield Fact("starting torque", f"{torque:.8g} N m", words, torque, "N m")


def _sides(scene: TrainScene) -> Facts:
    """Remind that a gear in two meshes has the coverage of each, where coverage changes along the flank."""
    for shaft in scene.train.shafts:
        for gear in shaft.gears:
            met = [mesh for mesh in scene.train.meshes if gear in (mesh.driver, mesh.driven)]
            roles = {mesh.driver == gear for mesh in met}
            if len(met) > 1 and any(mesh.coating.by_place for mesh in met):
                flanks = "; the drive flank of one is the coast flank of the other" if len(roles) > 1 else ""
                yield Fact(f"coverage of {gear}", "one table in each mesh", f"it has {len(met)}{flanks}")
