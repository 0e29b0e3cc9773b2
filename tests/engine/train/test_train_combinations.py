"""Features of a train against each other: a chain of two meshes with every pair of them, and some triples.

What a single feature does is tested in `test_train_features`; here are short runs of teeth in contact.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from tests.reference.train_features import CHANGES, PAIRS, TRIPLES, train_with

from gearidae.engine.train import solve_train
from gearidae.scene import Scene

AGREE = 1e-4
"""Of the range of a sample, at a tolerance of 1e-8: teeth in contact multiply rounding, which other processors do
otherwise, by up to 2e-5 in 20 us, with real asperities by more."""
SHORT = 4e-6
"""Duration [s] of runs by the other driver, whose steps take a hundred times as long."""
EVERY = 12
"""One pair of so many is run by both drivers in every run of the tests."""
ERRORS = {"static error", "pitch errors", "runout"}
"""Features by which teeth stand elsewhere than the angles of the shafts say."""
SAMPLES = ("shaft_speed", "shaft_angle", "mesh_force", "transmission_error", "drive_gap", "hub_load")


@cache
def run_of(features):
    return solve_train(train_with(*features))


def assert_same_motion(ours, theirs, shafts=slice(None), meshes=slice(None)):
    for name in SAMPLES:
        order = shafts if name.startswith(("shaft", "hub")) else meshes
        values = ours.samples[name]
        np.testing.assert_allclose(
            theirs.samples[name][order], values, rtol=0.0, atol=AGREE * np.abs(values).max(), err_msg=name
        )


def assert_sound(scene, solution, features):
    energy, samples = solution.energy, solution.samples
    assert solution.status == "finished"
    assert abs(energy["residual"]) < energy["residual_bound"] < 1e-4 * energy["throughput"]
    for values in samples.values():
        assert np.isfinite(values).all()
    if not ERRORS & {*features}:
        for k, mesh in enumerate(scene.train.meshes):
            geometry, angle, error = mesh.geometry, samples["shaft_angle"], samples["transmission_error"][k]
            apart = geometry.base_radius_pinion * angle[mesh.a] - geometry.base_radius_gear * angle[mesh.b]
            np.testing.assert_allclose(apart, error - error[0], rtol=0.0, atol=1e-16)
    assert samples["hub_load"].min() >= 0.0
    assert (samples["shaft_speed"] <= solution.shaft_totals["max_speed"][:, None] * (1.0 + 1e-9)).all()
    # extremes of forces are those of cubics between the steps, which follow the samples' to some 1e-6
    largest = solution.mesh_totals["largest_mesh_force"][:, None]
    assert (samples["mesh_force"] <= largest + 1e-5 * np.abs(samples["mesh_force"]).max()).all()


@pytest.mark.parametrize("feature", CHANGES)
def test_a_feature_acts_in_the_short_run(feature):
    """What would not change the motion would be tested by nothing here."""
    with_it, without = run_of((feature,)), run_of(())
    assert np.any(with_it.samples["shaft_speed"] != without.samples["shaft_speed"])
    assert with_it.samples["pairs_in_contact"].max(axis=1).min() > 0.0


@pytest.mark.parametrize("features", [*PAIRS, *TRIPLES], ids=" + ".join)
def test_features_go_together(features):
    scene, solution = train_with(*features), run_of(features)
    assert_sound(scene, solution, features)
    # nothing hangs on the order of the tables
    tables = scene.to_dict()
    tables["drive"]["shaft"], tables["load"]["shaft"] = "input", "output"
    for kind in ("shafts", "meshes"):
        tables[kind] = dict(reversed(tables[kind].items()))
    backwards = slice(None, None, -1)
    assert_same_motion(solution, solve_train(Scene.from_dict(tables)), backwards, backwards)


def test_each_feature_is_run_by_both_drivers():
    assert {name for features in (*PAIRS[::EVERY], *TRIPLES) for name in features} == {*CHANGES}


@pytest.mark.parametrize(
    "features",
    [
        *(
            pytest.param(pair, marks=() if k % EVERY == 0 else pytest.mark.by_hand)
            for k, pair in enumerate(PAIRS)
        ),
        *TRIPLES,
    ],
    ids=" + ".join,
)
def test_drivers_agree(features):
    scene = train_with(*features).replace({"run.duration": SHORT})
    native, portable = (solve_train(scene, backend=backend) for backend in ("native", "sksundae"))
    assert_sound(scene, portable, features)
    assert_same_motion(native, portable)
