from datetime import datetime
from pathlib import Path

import numpy as np
import pytest

from gearidae_bench import SCENES
from gearidae_bench.error import run_error
from gearidae_bench.reference import find_reference, load_reference, make_reference, scene_hash
from gearidae_bench.scenes import BenchScene

FOLDER = Path(__file__).parents[2] / "benchmarks" / "references"


@pytest.mark.parametrize("name", SCENES)
def test_a_shipped_reference_is_of_its_scene(name):
    reference = load_reference(FOLDER / f"{name}.npz")
    provenance = reference.provenance
    assert provenance.scene == name
    assert provenance.scene_hash == scene_hash(SCENES[name])
    assert datetime.fromisoformat(provenance.date).tzinfo is not None
    assert set(provenance.versions) == {"gearidae", "numpy", "numba"}
    # errors down to 1e-8 are compared: the references must be much better
    assert provenance.own_error < 1e-10
    assert reference.time.shape == reference.speed.shape == reference.position.shape
    assert reference.time[-1] == pytest.approx(SCENES[name].scene.run.duration)


def test_a_reference_can_be_made_again():
    shipped = load_reference(FOLDER / "roller_slow_bare.npz")
    anew = make_reference(SCENES["roller_slow_bare"])
    error = run_error(shipped.speed, shipped.position, anew.speed, anew.position, shipped.length)
    assert error < 1e-10  # both claim some 1e-12; another machine's rounding is well within


def test_an_outdated_reference_is_made_anew_and_kept(tmp_path):
    short = SCENES["roller_fast_sam"]
    scene = BenchScene("short", "short", short.scene.replace({"run.duration": 1e-6, "run.samples": 21}))
    first = find_reference(scene, [tmp_path])
    assert find_reference(scene, [tmp_path]).provenance == first.provenance
    other = BenchScene("short", "short", scene.scene.replace({"roller.speed": 0.09}))
    second = find_reference(other, [tmp_path])
    assert second.provenance.scene_hash != first.provenance.scene_hash
    stored = load_reference(tmp_path / "short.npz")
    np.testing.assert_array_equal(stored.speed, second.speed)
