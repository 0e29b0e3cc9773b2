"""Forces in the residual against the readable force law, and the Jacobian against differences."""

import numpy as np
import pytest

import gearidae as gd
from gearidae.contact import line_force
from gearidae.engine.laws.statistical import pair_force, set_joined
from gearidae.engine.model.state import U, V
from gearidae.engine.motion.residual import jacobian, residual
from gearidae.engine.pairs.coverage import WHOLE
from gearidae.engine.pairs.tooth_pairs import history_of
from gearidae.engine.setup.build import make_problem


@pytest.mark.parametrize("roughness", [0.9e-9, 1.2e-9, 6e-9, 30e-9])
@pytest.mark.parametrize("fraction", [0.0, 0.5, 1.0])
def test_pair_force_is_the_readable_law_with_history(roughness, fraction):
    """Roughnesses for which both materials keep branches, one of them does, or neither."""
    scene = gd.preset("roller_slow").replace(
        {
            "surface.roughness": roughness,
            "coating.sam_fraction": fraction,
            "roller.height": 3 * roughness,
            "contact.bodies": "rigid",
        }
    )
    m = make_problem(scene).model
    k = history_of(m, 0, 0)
    m.state.history[k].direction = 1.0
    parts = [(p, s) for p, s in ((scene.surface, 1 - fraction), (scene.coated_surface, fraction)) if s > 0]
    for joined in (3.0, 1.5, -0.5):
        for material in range(2):
            set_joined(m, k, material, joined)
        for stretch in (0.01, 0.1, 0.5, 1.5):
            gap = joined + stretch
            ours = pair_force(m, k, True, 0.0, gap, 1.0, 0.0, WHOLE)[0] * m.scene.force_unit
            geometry = (scene.roller.radius, scene.roller.width)
            terms = [
                s * float(line_force(gap * roughness, stretch * roughness, *geometry, p)) for p, s in parts
            ]
            pushing = [s * float(line_force(gap * roughness, 0.0, *geometry, p)) for p, s in parts]
            # 1e-9 is the law's own bound, on the sum of what pushes and what pulls
            assert ours == pytest.approx(
                sum(terms), abs=1e-9 * (np.abs(terms).sum() + 2 * np.abs(pushing).sum())
            )


@pytest.mark.parametrize("name", ["teodorescu2009", "teodorescu2009_low_speed", "roller_slow"])
def test_jacobian_is_the_derivative(name):
    scene = gd.preset(name).replace({"coating.sam_fraction": 0.5, "contact.bodies": "rigid"})
    if scene.mesh is not None:
        scene = scene.replace({"mesh.damping": 1e-9, "initial.mesh_phase": 0.02})  # a pair on its tip relief
    problem = make_problem(scene)
    m, n = problem.model, problem.start.size
    y = problem.start.copy()
    y[U] = m.scene.clearance[0] - 4.0
    y[V] = 0.1  # the way it was going: within a turning step the Jacobian is a guess
    yp, cj = np.linspace(0.1, 0.4, n), 2.5
    ours = np.empty(n * n)
    jacobian(m, 0.3, cj, y, ours)
    numeric = np.empty((n, n))
    for j in range(n):
        step = 1e-6 * np.eye(n)[j]
        out = np.empty((2, n))
        residual(m, 0.3, y + step, yp + cj * step, out[0])
        residual(m, 0.3, y - step, yp - cj * step, out[1])
        numeric[:, j] = (out[0] - out[1]) / 2e-6
    # slopes of the contact's length along the path are left out of the Jacobian: a pitch is long against a roughness,
    # so that they are small where each state is counted in the error that matters
    matter = problem.tolerance_scale
    np.testing.assert_allclose(
        ours.reshape(n, n).T * matter, numeric * matter, rtol=1e-5, atol=1e-3 * np.abs(numeric * matter).max()
    )
