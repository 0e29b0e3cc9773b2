"""Features against each other: every allowed pair, and some triples, resumed and continued, and in both drivers.

The scenes are short runs of gears in contact (`reference.feature_scenes`); what a single feature does is tested where
it lives.
"""

from functools import cache

import numpy as np
import pytest

import gearidae as gd
from balances import assert_closes
from gearidae.engine.backend import run_blocks, solve
from gearidae.engine.continuing import end_of
from gearidae.engine.setup.build import make_problem
from gearidae.records import Statistics
from reference.feature_scenes import CHANGES, HALF, SAMPLES, scene_with
from same import assert_same

TABLE = gd.combinations()
PAIRS = [
    (a, b) for a, b, allowed in zip(TABLE["first"], TABLE["second"], TABLE.allowed, strict=True) if allowed
]
TRIPLES = [
    ("elastic bodies", "coulomb friction", "hub friction"),
    ("elastic bodies", "coulomb friction", "coating by place"),
    ("elastic bodies", "coulomb friction", "exposures"),
    ("elastic bodies", "hub friction", "dry resistance"),
    ("elastic bodies", "coating by place", "radius force"),
    ("elastic bodies", "coating by place", "maugis asperities"),
    ("attraction", "coulomb friction", "hub friction"),
    ("attraction", "shear friction", "independent coatings"),
    ("attraction", "coulomb friction", "radius force"),
    ("attraction", "coulomb friction", "discrete asperities"),
    ("discrete asperities", "shear friction", "exposures"),
    ("shear friction", "maugis asperities", "hub friction"),
    ("coulomb friction", "hub friction", "discrete asperities"),
    ("coulomb friction", "static error", "mesh damping"),
    ("coulomb friction", "pitch errors", "runout"),
    ("elastic bodies", "pitch errors", "radius force"),
    ("hub friction", "held speed", "dry resistance"),
    ("pin friction", "hub friction", "coulomb friction"),
    ("pin friction", "hub friction", "discrete asperities"),
]
WHOLE = {"run.duration": 2 * HALF, "run.samples": 2 * SAMPLES - 1, "run.checkpoints": [HALF]}
AGREE = 1e-5
"""Of the range of a sample, at a tolerance of 1e-8."""
TIGHTER = {("film of gas", "spring with play"): 1e-9}
"""Tolerances of pairs whose motion multiplies errors: 2.7e-5 at 1e-8, 4e-7 at 1e-9, 8e-8 at 1e-10."""
HALF_A_STEP = 5e-3
"""Of the largest exposure: a step belongs to one place, and of some hundred steps at a place the first and the last are
half out."""


@pytest.mark.parametrize("feature", [*CHANGES, "no friction"])
def test_a_feature_acts_in_the_short_scene(feature):
    """What would not change the motion would be tested by nothing here."""
    friction = {"coulomb friction", "shear friction", "hub friction", "friction that ages", "pin friction"}
    without = solve(scene_with(), backend="native")
    run = without if feature == "no friction" else solve(scene_with(feature), backend="native")
    assert (friction_loss(run.balance) > 1e-4 * run.balance.throughput) is (feature in friction)
    if feature == "exposures":  # they only look on
        assert np.any(np.array(run.extremes.exposures) > 0.0)
    elif feature != "no friction":
        assert np.any(run.samples["gear_speed"] != without.samples["gear_speed"])


def friction_loss(balance):
    return (
        balance.drive_friction_loss
        + balance.coast_friction_loss
        + balance.pinion_hub_loss
        + balance.gear_hub_loss
        + balance.pin_loss
    )


def exposures_of(run):
    """Exposures by flank, tooth, quantity and place; the largest of each quantity."""
    table = np.array(run.extremes.exposures).reshape(2, 19, -1, CHANGES["exposures"]["run.exposures"])
    return table, table.max(axis=(0, 1, 3), keepdims=True)


@cache
def run_of(features):
    """The native driver's run of both halves, and its blocks."""
    blocks = []
    return solve(scene_with(*features).replace(WHOLE), backend="native", on_block=blocks.append), blocks


EVERY = 5
"""One pair of so many is run by both drivers in every run of the tests, with each feature in one of them."""
IN_BOTH = [
    *(
        pytest.param(pair, marks=() if k % EVERY == 0 else pytest.mark.by_hand)
        for k, pair in enumerate(PAIRS)
    ),
    *TRIPLES,
]


def test_each_feature_is_run_by_both_drivers():
    assert {name for pair in (*PAIRS[::EVERY], *TRIPLES) for name in pair} >= {
        name for p in PAIRS for name in p
    }


@pytest.mark.parametrize("features", IN_BOTH, ids=" + ".join)
def test_drivers_agree(features):
    whole, (native, _) = scene_with(*features).replace(WHOLE), run_of(features)
    if features in TIGHTER:
        whole = whole.replace({"run.rtol": TIGHTER[features]})
        native = solve(whole)
    portable = solve(whole, backend="sksundae")
    assert portable.status == "finished"
    assert_closes(whole, portable)
    for name, values in native.samples.items():
        if name not in ("pairs_in_contact", "asperities_in_contact"):
            extent = np.max(np.abs(values))
            np.testing.assert_allclose(
                portable.samples[name], values, rtol=0.0, atol=AGREE * extent, err_msg=name
            )

    if "exposures" in features:
        (ours, largest), (theirs, _) = exposures_of(native), exposures_of(portable)
        assert np.all(np.abs(theirs - ours) <= HALF_A_STEP * largest)


@pytest.mark.parametrize("features", [*PAIRS, *TRIPLES], ids=" + ".join)
def test_features_go_together(features):
    scene = scene_with(*features)
    whole, (native, blocks) = scene.replace(WHOLE), run_of(features)
    assert native.status == "finished"
    assert_closes(whole, native)

    # resumed from the checkpoint in the middle, and continued from a run of the first half
    (cut, *_) = [k for k, block in enumerate(blocks) if block.checkpoint is not None]
    assert cut < len(blocks) - 1
    resumed = list(
        run_blocks(make_problem(whole), 1e-8, 2 * SAMPLES - 1, "native", Statistics(), blocks[cut].checkpoint)
    )
    for name in ("rows", "events", "passages"):
        parts = ([*blocks[: cut + 1], *resumed], blocks)
        np.testing.assert_array_equal(
            *(np.concatenate([getattr(rows, name) for rows in part]) for part in parts)
        )
    assert_same(resumed[-1].balance, blocks[-1].balance)
    assert_same(resumed[-1].extremes, blocks[-1].extremes)
    first = solve(scene, backend="native")
    second = solve(scene, backend="native", start=end_of(scene, first.checkpoint, 0.0))
    for name, values in native.samples.items():
        parts = np.concatenate([first.samples[name], second.samples[name][1:]])
        np.testing.assert_array_equal(parts, values, err_msg=name)
    assert second.balance == native.balance
