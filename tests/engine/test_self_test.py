"""The boundary with SUNDIALS is tested as it behaves; what does not is named, and the next simpler way is taken."""

import json
from types import SimpleNamespace

import numpy as np
import pytest

import gearidae as gd
from gearidae.compiled import compiled_callback
from gearidae.engine import callbacks as real
from gearidae.engine import choose_backend, drivers, self_test
from gearidae.engine.model.addresses import model_at
from gearidae.engine.step import Attempt, iterate
from gearidae.engine.sundials import memory as ptr
from gearidae.errors import SceneError

STATES = 4  # of a gear pair


@pytest.fixture
def afresh():
    """Nothing is known of this machine's SUNDIALS, in this process."""

    def forget():
        drivers.native_formulas.cache_clear()
        self_test.failure.cache_clear()
        real.callbacks.cache_clear()
        real._newton.cache_clear()

    forget()
    yield
    forget()


@pytest.fixture
def nothing_kept(afresh, monkeypatch, tmp_path):
    """Nor on disk."""
    monkeypatch.setattr(self_test, "cache_folder", lambda: tmp_path)
    return tmp_path


@pytest.mark.parametrize("way", ["adams", "bdf"])
def test_sundials_behaves_as_believed(way):
    assert self_test.examine(way) == ""


@pytest.mark.parametrize("way", ["adams", "bdf"])
def test_the_error_follows_the_tolerance(way):
    """Over three decades, by a hundred at least: what the gain of the self-test, 20 or 50, is far below."""
    runs = [self_test._run(way, rtol) for rtol in (1e-5, 1e-8)]
    assert runs[0].error * 1e-5 > 100.0 * runs[1].error * 1e-8
    assert all(run.marks < self_test.MARKS for run in runs)


def deaf_solve(newton, start, correction, weights, tolerance, renew, solver):
    """Solve as the driver does, on a copy of the weights: as if IDA handed over one, and heeded its own."""
    t, predicted, rates, yy, yp, rr, cj, data = ptr.system(solver)
    copied = np.empty(STATES)
    ida_weights = ptr.numbers(weights, STATES)
    for j in range(STATES):
        copied[j] = ida_weights[j]
    attempt = Attempt(
        t,
        ptr.step(solver),
        cj,
        tolerance,
        ptr.numbers(predicted, STATES),
        ptr.numbers(rates, STATES),
        ptr.numbers(correction, STATES),
        ptr.numbers(yy, STATES),
        ptr.numbers(yp, STATES),
        ptr.numbers(rr, STATES),
        copied,
    )
    return iterate(STATES, model_at(data), attempt)


def careless_weights(yy, weights, data):
    """Call every error small."""
    m = model_at(data)
    out = ptr.numbers(weights, m.scene.states)
    for i in range(m.scene.states):
        out[i] = 1e-6
    return 0


def test_step_control_that_is_not_heeded_is_named_and_idas_formulas_are_taken(
    nothing_kept, monkeypatch, caplog
):
    kind, solve, note = real._newton(STATES)
    deaf = compiled_callback(real._INT(*(real._PTR,) * 4, real._REAL, real._INT, real._PTR))(deaf_solve)
    assert deaf.address != solve.address
    monkeypatch.setattr(real, "_newton", lambda n: (kind, deaf, note))
    assert drivers.native_formulas("auto") == "bdf"
    assert "fails its self-test with Adams' formulas: " in caplog.text
    assert len(caplog.records) == 1
    kept = json.loads((nothing_kept / "self_test.json").read_text())
    assert kept["adams"]
    assert kept["bdf"] == ""
    # what runs is what has passed, and it is said
    scene = gd.preset("teodorescu2009").replace({"contact.bodies": "rigid"})
    assert choose_backend("auto", "auto") == "native"
    ds = gd.simulate(scene, t_end=2e-5, samples=21)
    assert (ds.attrs["backend"], ds.attrs["method"]) == ("native", "bdf")
    plain = gd.simulate(scene.replace({"run.method": "bdf"}), t_end=2e-5, samples=21)
    np.testing.assert_array_equal(ds["gear_speed"], plain["gear_speed"])


def test_weights_that_are_not_heeded_leave_scikit_sundae(nothing_kept, monkeypatch, caplog):
    """Both ways ask for the weights: where they mean nothing, neither follows the tolerance."""
    wrong = compiled_callback(real._INT(real._PTR, real._PTR, real._PTR))(careless_weights)
    monkeypatch.setattr(real, "_weights", SimpleNamespace(address=wrong.address))
    assert drivers.native_formulas("bdf") == ""
    assert "IDA's own formulas" in caplog.text
    assert choose_backend("auto", "bdf") == "sksundae"
    assert "it fails its self-test" in caplog.text
    with pytest.raises(SceneError, match="self-test"):
        choose_backend("native", "bdf")


def test_what_was_seen_is_kept(nothing_kept, monkeypatch):
    asked = []
    monkeypatch.setattr(self_test, "examine", lambda way: asked.append(way) or "")
    assert self_test.failure("adams") == ""
    self_test.failure.cache_clear()  # another process
    assert self_test.failure("adams") == ""
    assert asked == ["adams"]
    (nothing_kept / "self_test.json").write_text("{")  # half written
    self_test.failure.cache_clear()
    assert self_test.failure("adams") == ""
    assert asked == ["adams", "adams"]


def test_idas_formulas_by_a_key_of_the_scene():
    scene = gd.preset("teodorescu2009").replace({"contact.bodies": "rigid"})
    runs = {
        method: gd.simulate(scene.replace({"run.method": method}), t_end=1e-4, samples=201)
        for method in ("auto", "bdf")
    }
    assert [ds.attrs["method"] for ds in runs.values()] == ["adams", "bdf"]
    assert int(runs["bdf"].attrs["steps"]) > 1.2 * int(runs["auto"].attrs["steps"])
    portable = gd.simulate(scene, t_end=1e-4, samples=201, backend="sksundae")
    assert portable.attrs["method"] == "bdf"
    # the same formulas, iteration and root search: the same events to the last bit
    np.testing.assert_array_equal(runs["bdf"]["event_time"], portable["event_time"])
    with pytest.raises(SceneError, match=r"run\.method"):
        scene.replace({"run.method": "adams"})
