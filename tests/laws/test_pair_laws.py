"""Laws of a tooth pair: each compiles alone, sums keep the order of the list, and a mesh has the laws it asks for."""

import subprocess
import sys
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad

import gearidae as gd
from gearidae.engine.laws.pairs import PAIR_LAWS, force_of_pair, laws_of_mesh
from gearidae.engine.model.state import PHASE, SCENE, U, V, blank_model
from gearidae.engine.pairs.tooth_pairs import PairState, pair_state
from gearidae.engine.setup.build import make_problem
from gearidae.formulas.quadrature import Ends
from gearidae.laws.pair.damping import DAMPING
from gearidae.laws.pair.film import FILM
from gearidae.laws.pair_law import NO_PAIR_FORCE, GapMotion, PairForce
from reference.compilations import COUNTING

SMALL = gd.preset("teodorescu2009").replace(
    {"contact.bodies": "rigid", "coating.sam_fraction": 0.5, "mesh.radius_force": False}
)
FEATURES = {
    "statistical asperities": {},
    "elastic bodies": {"contact.bodies": "elastic"},
    "discrete asperities": {"contact.roughness": "discrete"},
    "attraction": {"surface.hamaker": 1e-19, "coating.hamaker": 1e-19},
    "mesh damping": {"mesh.damping": 7e-6},
    "film of gas": {"mesh.film_damping": 2e-5, "mesh.film_gap": 2e-8},
}
"""Changes that give a mesh a law; of laws of contacts it has one."""


@pytest.fixture(scope="module")
def film():
    """Return constants of a mesh with film and damping and nothing else."""
    m = blank_model(np.zeros(1, SCENE)[0], np.zeros(1), 1)
    m.scene.film_damping, m.scene.film_gap, m.scene.cutoff, m.scene.damping = 3.0, 0.5, 8.0, 0.7
    return m


def pair_at(gap, rate):
    return PairState(0, 0, 0, False, gap, rate, 0.0, 0.5, 0.0, True)


@pytest.mark.parametrize("gap", [-2.0, 0.0, 1e-9, 0.5, 7.9])
@pytest.mark.parametrize("rate", [-10.0, 0.0, 3.7])
def test_a_film_resists_as_the_formula_of_reynolds_says(film, gap, rate):
    """And its slopes are those of its force; below a gap of zero its damping stays."""
    y, height = np.zeros(4), 0.5 + max(gap, 0.0)
    force = FILM.force(film, 0.0, y, pair_at(gap, rate), False, NO_PAIR_FORCE)
    assert force.load == pytest.approx(-3.0 * (0.5 / height) ** 3 * rate, rel=1e-14)
    assert force.by_rate == pytest.approx(-3.0 * (0.5 / height) ** 3, rel=1e-14)
    assert force.by_gap == pytest.approx(
        3.0 * 3.0 * 0.5**3 / height**4 * rate if gap > 0.0 else 0.0, rel=1e-14
    )
    assert force[4:] == NO_PAIR_FORCE[4:]  # neither contact nor path nor friction


@pytest.mark.parametrize("end", [6.0, 2.0, 0.5])
def test_a_film_takes_the_work_of_its_force(film, end):
    """Of a pair that closes at a steady rate from a gap of 1 on or opens to `end`, in steps of 0.01."""
    rate, h = (1.0 if end > 1.0 else -1.0), 0.01
    gaps = np.arange(1.0, end + 0.5 * rate * h, rate * h)
    lost = 0.0
    for before, now in pairwise(gaps.tolist()):
        lost, _ = FILM.loss(film, h, GapMotion(before, rate, 0.0), GapMotion(now, rate, 0.0), (lost, 0.0))
    taken = quad(lambda gap: 3.0 * (0.5 / (0.5 + gap)) ** 3, min(1.0, gaps[-1]), max(1.0, gaps[-1]))[0]
    assert lost == pytest.approx(taken, rel=1e-9)  # the formula is of sixth order in the step


def test_damping_takes_the_work_of_its_force(film):
    """Of a rate that rises evenly from 1 to 2 in a unit of time: the integral of its square is 7/3."""
    lost, error = DAMPING.mesh_loss(film, 1.0, 1.5, Ends(1.0, 1.0, 2.0, 1.0), (1.0, 0.0))
    assert lost == pytest.approx(1.0 + 0.7 * 7.0 / 3.0, rel=1e-14)
    assert error == pytest.approx(0.0, abs=1e-14)
    assert DAMPING.mesh_force(film, 2.0, 1.0) == 1.0 + 0.7 * 2.0
    assert DAMPING.mesh_by_rate(film, 1.0) == 1.7


def test_a_mesh_has_the_laws_that_its_scene_asks_for():
    assert [law.name for law in PAIR_LAWS] == list(FEATURES)
    for name, changes in FEATURES.items():
        there = laws_of_mesh(make_problem(SMALL.replace(changes)).model.scene)
        names = {law.name for k, law in enumerate(PAIR_LAWS) if there >> k & 1}
        contact = name if name in ("elastic bodies", "discrete asperities") else "statistical asperities"
        assert names == {name, contact}


@pytest.mark.parametrize("radius_force", [True, False])
def test_a_sum_is_its_laws_one_after_the_other(radius_force):
    """To the last bit, of the laws that the mesh has: all but those of other contacts."""
    changes = FEATURES["attraction"] | FEATURES["film of gas"] | {"mesh.radius_force": radius_force}
    problem = make_problem(SMALL.replace(changes))
    m, y = problem.model, problem.start.copy()
    y[U] += float(m.scene.clearance[0]) - y[U] - 0.7
    y[V], y[PHASE] = -0.3, 0.45
    pair = pair_state(m, 0, 0, y)
    value = PairForce(*(-0.0,) * 12)
    for k, law in enumerate(PAIR_LAWS):
        if law.force is not None and m.scene.pair_laws >> k & 1:
            value = law.force(m, 0.0, y, pair, False, value)
    assert value.load != value.contact != 0.0
    assert (value.path != 0.0) == radius_force
    assert force_of_pair(m, 0.0, y, pair, False) == value


ALONE = """
import numpy as np
from gearidae.engine.laws.statistical import STATISTICAL
from gearidae.engine.model.state import SCENE, blank_model
from gearidae.engine.pairs.tooth_pairs import PairState
from gearidae.laws.pair.film import FILM
from gearidae.laws.pair_law import NO_PAIR_FORCE

m = blank_model(np.zeros(1, SCENE)[0], np.zeros(100_000), 1)
m.scene.film_damping, m.scene.film_gap, m.scene.cutoff, m.scene.start_radius = 3.0, 0.5, 8.0, 1.0
pair, y = PairState(0, 0, 0, False, 1.5, 2.0, 0.0, 0.0, 0.0, False), np.zeros(4)
begun = count.n
for law in (FILM, STATISTICAL):
    print(law.force(m, 0.0, y, pair, False, NO_PAIR_FORCE).load)
print(count.n - begun)
"""


@pytest.mark.by_hand  # that of a shaft is in the suite
def test_a_law_compiles_alone(tmp_path, monkeypatch):
    """Some dozens of functions and not the solver's six hundred, and none in a second process."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    lines = [
        subprocess.run(
            [sys.executable, "-c", COUNTING + ALONE], capture_output=True, text=True, check=True
        ).stdout.split()
        for _ in range(2)
    ]
    assert [[float(x) for x in line[:2]] for line in lines] == [[-3.0 * 0.25**3 * 2.0, 0.0]] * 2
    assert 0 < int(lines[0][2]) < 100
    assert lines[1][2] == "0"
