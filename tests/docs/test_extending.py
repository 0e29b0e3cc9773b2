"""The page on extending: its laws do what has a formula, its changes of the sources apply and work."""

from __future__ import annotations

import math
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy import special

import gearidae as gd
from gearidae.archive.totals import balance_of
from gearidae.asperities import law_names
from gearidae.contact import asperity_of, register, rough_pressure, unregister

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "extending.md"
I1 = 1.5263e-20  # pinion of the preset
START = 6.0  # rad/s, of the pinion


def balance(run) -> dict[str, float]:
    """Energy balance of a run [J]."""
    numbers = balance_of(run)
    assert numbers is not None
    return numbers


def blocks(language: str) -> list[str]:
    """The page's blocks of a language."""
    return re.findall(
        rf"^```{language}\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE
    )


@pytest.fixture(scope="module")
def page():
    """What the page's code has defined and run; its last block takes the laws out again."""
    *code, ending = blocks("python")
    names: dict[str, object] = {"__name__": "__extending__"}
    for block in code:
        exec(compile(block, str(PAGE), "exec", dont_inherit=True), names)
    yield names
    exec(ending, names)
    assert not {"soft", "springs"} & set(law_names())
    assert "pressed" not in gd.wear.loss_law_names()


# -- asperity laws ---------------------------------------------------------------------------------------------------


def test_half_the_modulus_is_half_the_pressure(page):
    surface = gd.preset("roller_slow").surface
    gap = surface.roughness * np.linspace(-1.0, 4.0, 11)
    np.testing.assert_allclose(
        rough_pressure(gap, 0.0, surface, "soft"),
        0.5 * rough_pressure(gap, 0.0, surface, "hertz"),
        rtol=1e-14,
    )


def test_the_impact_on_soft_tips_loses_nothing(page):
    impact = page["impact"]
    # ten tolerances of the run
    assert float(impact.speed[-1] / impact.speed[0]) == pytest.approx(-1.0, rel=1e-3, abs=0)
    assert balance(impact)["adhesion_loss"] == 0.0


def test_springs_lose_the_energy_between_joining_and_letting_go(page):
    assert page["springs"].loss == pytest.approx(0.5 * 2.0 * (1.5**2 - 0.5**2), rel=1e-13, abs=0)


def test_springs_press_as_their_closed_form(page):
    """Stretched to their limit: ``int_{gap - far} k (y - gap) phi(y) dy``."""
    surface = gd.preset("roller_slow").surface
    tip, sigma = asperity_of(surface), surface.roughness
    stiffness, far = tip.pull_off / tip.stretch_limit * sigma, (1e-9 + tip.stretch_limit) / sigma
    for gap in (-1.0, 0.5, 2.0):
        z = gap - far
        above = 0.5 * special.erfc(z / math.sqrt(2.0))
        density = math.exp(-0.5 * z**2) / math.sqrt(2.0 * math.pi)
        wanted = surface.asperity_density * stiffness * (density - gap * above)
        got = float(rough_pressure(gap * sigma, math.inf, surface, "springs"))
        # rounding of the quadrature, against the part that cancels
        assert got == pytest.approx(wanted, rel=0, abs=1e-11 * surface.asperity_density * stiffness)


def test_the_impact_on_springs_takes_what_is_booked(page):
    lossy, mass = page["lossy"], page["sticky"].roller.mass
    assert balance(lossy)["adhesion_loss"] > 0.0
    assert abs(balance(lossy)["residual"]) <= balance(lossy)["residual_bound"]
    taken = -balance(lossy)["kinetic_change"] - balance(lossy)["stored_change"]
    assert taken == pytest.approx(
        balance(lossy)["adhesion_loss"], rel=0, abs=balance(lossy)["residual_bound"]
    )
    assert balance(lossy)["kinetic_change"] == pytest.approx(
        0.5 * mass * float(lossy.speed[-1] ** 2 - lossy.speed[0] ** 2),
        rel=0,
        abs=2 * balance(lossy)["residual_bound"],
    )


# -- torque laws -----------------------------------------------------------------------------------------------------


def test_the_ramp_speeds_the_pinion_up_by_its_square(page):
    run = page["ramped"]
    wanted = START + 5.6e-16 * run.time.to_numpy() ** 2 / (2.0 * I1)
    np.testing.assert_allclose(run.pinion_speed, wanted, rtol=1e-7)  # a hundred tolerances


def test_the_brake_lets_the_speed_decay(page):
    run = page["braked"]
    speed = START * np.exp(-100.0 * run.time.to_numpy())
    np.testing.assert_allclose(run.pinion_speed, speed, rtol=1e-7)
    lost = 0.5 * I1 * (speed[0] ** 2 - speed[-1] ** 2)
    assert balance(run)["drive_work"] == pytest.approx(-lost, rel=1e-7, abs=0)


def test_the_energy_balance_of_the_motor_closes(page):
    run = page["turned"]
    assert abs(balance(run)["residual"]) <= balance(run)["residual_bound"]
    assert balance(run)["drive_work"] > 0.0


# -- loss laws -------------------------------------------------------------------------------------------------------


def test_the_loss_is_proportional_to_coverage_work_and_pressure(page):
    law = gd.wear.loss_law("pressed", coefficient="2000 m^2/J", pressure="5 Pa")
    work, pressure = np.array([1e-8, 3e-8]), np.array([0.1, 0.4])
    seen = gd.wear.Exposure(np.full(2, 1e3), np.full(2, 1e-9), work, pressure)
    coverage = np.array([0.5, 0.0])
    np.testing.assert_allclose(law.rate(coverage, seen), [-0.5 * 2000.0 * 1e-8 * 0.1 / 5.0, 0.0], rtol=1e-14)


def test_a_life_is_inverse_to_the_coefficient(page):
    slow, fast = page["slow"], page["fast"]
    assert slow.attrs["ending"] == fast.attrs["ending"] == "coverage"
    # the same windows, scaled: rounding of the integration over passages
    np.testing.assert_allclose(slow.passages, 2.0 * fast.passages, rtol=1e-9)
    np.testing.assert_allclose(slow.coverage, fast.coverage, rtol=1e-9)


# -- changes of the sources ------------------------------------------------------------------------------------------


def apply(block: str, root: Path) -> str:
    """Make one change of the page in a copy of the sources, and name its file."""
    heading, *lines = block.splitlines()
    name = heading.removeprefix("--- ")
    before = "".join(f"{line[1:]}\n" for line in lines if line[0] in " -")
    after = "".join(f"{line[1:]}\n" for line in lines if line[0] in " +")
    file = root / name
    text = file.read_text(encoding="utf-8")
    assert text.count(before) == 1, f"{name} has another text than the page: {before}"
    file.write_text(text.replace(before, after), encoding="utf-8")
    return name


PITCH_POINT = """
from types import SimpleNamespace
import numpy as np
from gearidae.archive.variables import EVENTS
from gearidae.engine.events import mesh_marks
from gearidae.engine.events.record import EVENT_NUMBERS
from gearidae.records import EventKind

assert "pitch_point" in EVENTS["event_kind"].attributes["flag_meanings"].split()
mesh_marks.gap_and_rate = lambda *given: (0.0, 0.0)
ratio, approach = 1.6, 0.7
marks, coast = mesh_marks.MARKS, 2.0 * approach + 0.5
scene = SimpleNamespace(contact_ratio=ratio, coast_phase=coast, marks=marks, time_unit=1.0, length_unit=1.0)
extremes = SimpleNamespace(mesh_exits=0)
m = SimpleNamespace(scene=scene, state=SimpleNamespace(whole_pitches=0.0, extremes=extremes))
events, count = np.zeros((99, EVENT_NUMBERS)), 0
for sign in (1.0, -1.0):
    mesh_marks.set_marks(m, sign * -0.01)
    first = count
    while count < first + 10:
        crossed = m.state.mesh_mark_above if sign > 0.0 else m.state.mesh_mark_below - 1e-12
        y = np.array([0.0, 0.0, crossed, 0.0])
        assert mesh_marks.crossed_mark(m, y)
        before = count
        count = mesh_marks.cross_mark(m, crossed, y, events, count)
        assert count > before
    passed = events[first:count]
    found = passed[passed[:, 1] == EventKind.PITCH_POINT]
    assert len(found) == 2 and (found[:, 3] == 0).all(), found
    # a pair passes the pitch point the approach after its entry
    np.testing.assert_allclose(found[:, 0] - found[:, 2], approach, atol=1e-9)
"""

DRIVE_POWER = """
from gearidae.archive.variables import SAMPLES
from gearidae.records import sampled_columns
from gearidae.records import GEAR_COLUMNS
assert sampled_columns(roller=False)[12] == GEAR_COLUMNS[12] == "drive_power"
assert SAMPLES["drive_power"].units == "W"
import inspect
from gearidae.engine.motion import observe
assert "row[GEAR.drive_power] = " in inspect.getsource(observe.observe)
assert observe.GEAR.drive_power == 12
"""

VISCOUS_LOSS = """
import numpy as np
from types import SimpleNamespace
from gearidae.archive.variables import ENERGY_BALANCE
from gearidae.engine.model.state import STATE
from gearidae.formulas.quadrature import Ends
from gearidae.laws.shaft.drag import DRAG
from gearidae.laws.shafts import ACTING, book_losses
from gearidae.records.energy import (ENERGY_SUMS, LOSSES)
from gearidae.records.quantity import in_si

assert "viscous_loss" in LOSSES
assert ENERGY_BALANCE["viscous_loss"].units == "J"
scene = SimpleNamespace(
    torque=[SimpleNamespace(acts=1 << ACTING.index(DRAG), drag=0.0, viscous=3.0)] * 2,
    force_unit=5.0, length_unit=7.0, time_unit=1.0, gear_radius=1.0
)
energy, time = np.zeros(1, STATE["energy"])[0], 0.25
m = SimpleNamespace(scene=scene, state=SimpleNamespace(energy=energy))
assert book_losses(m, 1, time, 0.0, 2.0 * time, Ends(2.0, 0.0, 2.0, 0.0)) == 3.0 * 2.0**2 * time
numbers = in_si(ENERGY_SUMS, energy, scene)
np.testing.assert_allclose(numbers["viscous_loss"], 3.0 * 2.0**2 * time * 5.0 * 7.0)
assert numbers["drag_loss"] == 0.0
"""


CHANGES = (
    ("PITCH_POINT|coast_phase", {"records/events.py", "engine/events/mesh_marks.py"}, PITCH_POINT),
    ("drive_power", {"records/columns.py", "engine/motion/observe.py"}, DRIVE_POWER),
    ("viscous_loss", {"records/energy.py", "laws/shaft/drag.py"}, VISCOUS_LOSS),
)


def test_changes_apply_and_work(tmp_path):
    """All in one copy of the sources, run as plain Python: compiling it would take half a minute."""
    shutil.copytree(ROOT / "src", tmp_path / "src", ignore=shutil.ignore_patterns("__pycache__"))
    for pattern, files, _ in CHANGES:
        touched = {apply(block, tmp_path) for block in blocks("diff") if re.search(pattern, block)}
        assert touched == {f"src/gearidae/{name}" for name in files}
    environment = os.environ | {"PYTHONPATH": str(tmp_path / "src"), "NUMBA_DISABLE_JIT": "1"}
    scripts = "\n".join(script for *_, script in CHANGES)
    done = subprocess.run(
        [sys.executable, "-c", scripts], env=environment, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


def test_every_file_that_the_page_names_is_there():
    named = set(re.findall(r"`((?:src|tests)/[\w/]+(?:\.py|/))`", PAGE.read_text(encoding="utf-8")))
    assert len(named) > 8
    for name in named:
        assert (ROOT / name).exists(), name


def test_two_laws_of_one_name_are_refused(page):
    with pytest.raises(gd.SceneError, match="soft"):
        register(page["Soft"])
    with pytest.raises(gd.SceneError, match=r"contact\.asperity"):
        unregister("softer")
