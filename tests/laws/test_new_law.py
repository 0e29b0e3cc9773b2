"""A new law is its own file, and a line of a list where its folder has one: no other file of the package names it."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import gearidae as gd
from gearidae.asperities import law_class, law_names

PACKAGE = Path(gd.__file__).parent
PAGE = Path(__file__).parents[2] / "docs" / "extending.md"

WALL = '''
"""Wall: flanks nearer than a distance repel each other like a spring, and lose what a dashpot takes."""

from gearidae.compiled import compiled
from gearidae.laws.law import Key, Loss
from gearidae.laws.pair_law import MeshConstant, PairLaw, both_forces, of_gap


@compiled(inline=True)
def _force(m, t, y, pair, settling, value):
    depth = max(m.scene.wall_gap - pair.gap, 0.0)
    slope = -m.scene.wall_stiffness if depth > 0.0 else 0.0
    return both_forces(value, of_gap(m.scene.wall_stiffness * depth, slope, 0.0))


@compiled
def _energy(m, y, pair, value):
    depth = max(m.scene.wall_gap - pair.gap, 0.0)
    return value[0] + 0.5 * m.scene.wall_stiffness * depth * depth, value[1]


@compiled
def _loss(m, h, before, now, value):
    return value


WALL = PairLaw(
    name="wall",
    acts=lambda scene: bool(scene.wall_stiffness != 0.0),
    constants=(
        MeshConstant(
            "wall_stiffness",
            Key("N/m", "stiffness of the wall", at_most=1e9, example=1.0),
            force=1,
            length=-1,
        ),
        MeshConstant(
            "wall_gap", Key("m", "gap at which it begins", at_most=1.0, example=1e-8), length=1
        ),
    ),
    losses=(Loss("wall_loss", "energy lost to the wall"),),
    force=_force,
    energy=_energy,
    loss=_loss,
)
'''
ASKED = """
import numpy as np
import gearidae as gd
from gearidae.engine.laws.pairs import PAIR_LAWS, laws_of_mesh
from gearidae.engine.model.state import SCENE, blank_model
from gearidae.engine.pairs.tooth_pairs import PairState
from gearidae.laws.pair_law import NO_PAIR_FORCE
from gearidae.records.energy import LOSSES

(law,) = [law for law in PAIR_LAWS if law.name == "wall"]
scene = gd.preset("teodorescu2009").replace({"mesh.wall_stiffness": "2 N/m", "mesh.wall_gap": "3 nm"})
print(scene.mesh.wall_stiffness, scene.mesh.wall_gap)
print("wall" in set(gd.combinations().first), "wall_loss" in LOSSES)
m = blank_model(np.zeros(1, SCENE)[0], np.zeros(1), 1)
m.scene.wall_stiffness, m.scene.wall_gap, m.scene.cutoff = 2.0, 3.0, 8.0
print(laws_of_mesh(m.scene) >> PAIR_LAWS.index(law) & 1)
pair, y = PairState(0, 0, 0, False, 2.5, 1.0, 0.0, 0.0, 0.0, False), np.zeros(4)
print(law.force(m, 0.0, y, pair, False, NO_PAIR_FORCE)[:2], law.energy(m, y, pair, (0.0, 0.0)))
"""


def test_a_law_of_a_pair_takes_two_files(tmp_path):
    """A wall of stiffness 2 from a gap of 3 on: its keys, its place in all lists, its closed form at a gap of 2.5."""
    source = tmp_path / "src" / "gearidae"
    shutil.copytree(PACKAGE, source, ignore=shutil.ignore_patterns("__pycache__"))
    (source / "laws" / "pair" / "wall.py").write_text(WALL, encoding="utf-8")
    listed = source / "laws" / "pairs.py"
    text = listed.read_text(encoding="utf-8")
    with_wall = text.replace("(DAMPING, FILM)", "(DAMPING, FILM, WALL)").replace(
        "from gearidae.laws.pair_law", "from gearidae.laws.pair.wall import WALL\nfrom gearidae.laws.pair_law"
    )
    assert with_wall.count("WALL") == 2
    listed.write_text(with_wall, encoding="utf-8")
    said = subprocess.run(
        [sys.executable, "-c", ASKED],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "PYTHONPATH": str(source.parent), "NUMBA_CACHE_DIR": str(tmp_path)},
    ).stdout
    assert said.splitlines() == ["2.0 3e-09", "True True", "1", "(1.0, -2.0) (0.25, 0.0)"]


BRAKED = """
import numpy as np
import gearidae as gd
from gearidae.engine.model.state import SCENE, blank_model
from gearidae.formulas.quadrature import Ends
from gearidae.laws.frictions import FRICTION_LAWS, asks_for, bits_of, book_friction, book_stop
from gearidae.laws.frictions import friction_laws_of, law_limit
from gearidae.records.energy import LOSSES
from gearidae.records.standing import Holding

law = FRICTION_LAWS[-1]
scene = gd.preset("teodorescu2009").replace({"gears.gear_brake": "2 pN m"})
print(scene.gears.gear_brake, scene.gears.pinion_brake, asks_for(scene, law))
print("brake" in set(gd.combinations().first), "brake_loss" in LOSSES, (Holding.BRAKE | Holding.HUB_FRICTION).words)
print([law.name for law in friction_laws_of(scene, 1)], [law.name for law in friction_laws_of(scene, 0)])
m = blank_model(np.zeros(1, SCENE)[0], np.zeros(1), 1)
m.state.slip = m.state.pinion_slip = -1.0
for shaft, brake in ((0, 3.0), (1, 2.0)):
    m.scene.torque[shaft].resists, m.scene.torque[shaft].brake = bits_of((law,)), brake
    speeds = Ends(-4.0, 0.0, -4.0, 0.0)
    lost = book_friction(m, shaft, 0.5, 0.5, 0.0, -2.0, speeds, (0.0, 0.0))
    print(law_limit(m, shaft, 0.0, 0.0, 0.0), *lost, book_stop(m, shaft, 0.25))
print(m.state.energy.brake_loss, m.state.energy.dry_loss)
"""


def test_a_set_valued_law_takes_two_files(tmp_path):
    """The brake of the page on extending, beside the dry load, which gears without a load do not have."""
    (brake,) = (
        block
        for block in re.findall(
            r"^```python\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE
        )
        if "BRAKE = FrictionLaw" in block
    )
    source = tmp_path / "src" / "gearidae"
    shutil.copytree(PACKAGE, source, ignore=shutil.ignore_patterns("__pycache__"))
    (source / "laws" / "shaft" / "brake.py").write_text(brake, encoding="utf-8")
    listed = source / "laws" / "frictions.py"
    text = listed.read_text(encoding="utf-8")
    with_brake = text.replace("(DRY_LOAD,)", "(DRY_LOAD, BRAKE)").replace(
        "from gearidae.laws.shaft.dry_load",
        "from gearidae.laws.shaft.brake import BRAKE\nfrom gearidae.laws.shaft.dry_load",
    )
    assert with_brake.count("BRAKE") == 2
    listed.write_text(with_brake, encoding="utf-8")
    said = subprocess.run(
        [sys.executable, "-c", BRAKED],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "PYTHONPATH": str(source.parent), "NUMBA_CACHE_DIR": str(tmp_path)},
    ).stdout
    assert said.splitlines() == [
        "2e-12 0.0 True",
        "True True hub friction and brake",
        "['dry resistance', 'brake'] []",
        "3.0 6.0 0.0 0.0",
        "2.0 4.0 0.0 0.0",
        "10.5 0.0",
    ]


def test_an_asperity_law_stands_in_its_file_alone():
    """Keys of the laws of asperities, and the names of laws that are features of a scene."""
    sources = {path: path.read_text(encoding="utf-8") for path in PACKAGE.rglob("*.py")}
    laws = [law_class(name) for name in law_names()]
    names = {law.name: law.__module__ for law in laws if law.keys}
    names |= {key.name: law.__module__ for law in laws for key in law.keys if key.name != "temperature"}
    assert {"meniscus", "humidity", "contact_angle"} <= set(names)
    for name, module in names.items():
        where = {path for path, text in sources.items() if f'"{name}"' in text or f".{name}" in text}
        assert where == {PACKAGE.parent / (module.replace(".", "/") + ".py")}
