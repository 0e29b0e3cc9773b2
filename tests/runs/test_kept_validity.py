"""How far the model holds, in the archives of runs and sweeps: written with each, read back, and shown."""

from __future__ import annotations

import json

import pytest

import gearidae as gd
from gearidae.archive import save
from gearidae.cli import main
from gearidae.errors import Interrupted
from gearidae.report.page import build_report
from gearidae.runs import validity
from gearidae.runs.kept_validity import largest_force, validity_of
from gearidae.runs.validity import validity_attribute, validity_rows

LOW = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 2e-3, "run.samples": 21})
ROLLER = gd.preset("roller_slow").replace({"run.samples": 21})


@pytest.fixture
def path(tmp_path):
    return tmp_path / "run.nc"


@pytest.mark.parametrize("scene", [LOW, ROLLER], ids=["gears", "roller"])
def test_the_archive_of_a_run_keeps_the_rows_of_its_scene(scene, path):
    gd.simulate(scene, archive=path)
    ds = gd.open_archive(path)
    as_run = gd.Scene.from_dict(json.loads(ds.attrs["scene"]))
    assert ds.attrs["validity"] == validity_attribute(as_run, largest_force(ds))
    assert [row.name for row in validity_of(ds)] == [row.name for row in validity_rows(scene)]


def test_of_a_run_under_way_they_are_worked_out(path):
    def stop(time, events):
        raise KeyboardInterrupt

    with pytest.raises(Interrupted) as caught:
        gd.simulate(LOW.replace({"run.duration": 0.3}), archive=path, progress=stop)
    assert caught.value.dataset.attrs["status"] == "interrupted"
    assert "validity" not in caught.value.dataset.attrs
    assert validity_of(caught.value.dataset)[0].name == "expected_asperities"


def test_reading_takes_what_is_kept(path, monkeypatch):
    gd.simulate(LOW, archive=path)
    ds = gd.open_archive(path)

    def forbidden(scene, force):
        raise AssertionError("computed again")

    monkeypatch.setattr(validity, "validity_rows", forbidden)
    assert validity_of(ds)[0].number == pytest.approx(5.13e-8, rel=2e-3)  # checked independently
    ds.attrs["validity"] = "[1]"
    with pytest.raises(AssertionError, match="computed again"):
        validity_of(ds)


def test_a_run_in_memory_does_not_wait_for_them(monkeypatch):
    """They take as long as a short run does; asked for, they are computed from the scene."""
    asked = []
    whole = validity._rows
    monkeypatch.setattr(validity, "_rows", lambda scene: asked.append(scene) or whole(scene))
    ds = gd.simulate(LOW)
    assert "validity" not in ds.attrs
    assert asked == []
    assert validity_of(ds) == validity_rows(LOW, largest_force(ds))


def test_they_are_computed_once_for_a_run(path, monkeypatch):
    computed = []
    whole = validity._asperities
    monkeypatch.setattr(validity, "_asperities", lambda *of: computed.append(of) or whole(*of))
    gd.simulate(LOW.replace({"surface.roughness": 6.01e-9}), archive=path)
    assert len(computed) == 1


def test_a_sweep_keeps_those_of_its_base_and_one_run_has_its_own(path):
    ds = gd.sweep(LOW, {"coating.sam_fraction": [1.0, 0.5]}, archive=path)
    assert gd.open_archive(path).identical(ds)
    assert ds.attrs["validity"] == validity_attribute(LOW)
    assert validity_of(ds)[0].number == pytest.approx(5.13e-8, rel=2e-3)
    worn = validity_of(ds.sel(sam_fraction=0.5))[0]
    assert worn.number == pytest.approx(3.96e-7, rel=2e-3)  # checked independently
    assert validity_of(ds.sel(sam_fraction=1.0))[:-1] == validity_of(ds)[:-1]


def test_yielding_is_judged_by_the_largest_force_of_the_run_and_not_by_its_samples(path):
    """Few samples say the same as many; a sweep judges its base, and a run picked from it its own."""
    few = validity_of(gd.simulate(ROLLER.replace({"run.samples": 3})))[-1]
    many = validity_of(gd.simulate(ROLLER.replace({"run.samples": 4001})))[-1]
    assert few.name == "yielding"
    assert "at the largest force of the run, 16.7 uN" in many.verdict
    assert few.number == pytest.approx(many.number, rel=1e-5)  # of the solver's steps, rtol 1e-6
    swept = gd.sweep(ROLLER, {"roller.speed": [0.01, 0.1]}, archive=path)
    assert "at the closest approach" in validity_of(swept)[-1].verdict
    fast = validity_of(swept.sel(roller_speed=0.1))[-1]
    assert "at the largest force of the run, 559 uN" in fast.verdict
    assert not fast.holds


def test_info_and_report_show_them(path, capfd, monkeypatch):
    monkeypatch.setenv("COLUMNS", "120")
    gd.simulate(LOW, archive=path)
    assert main(["info", str(path)]) == 0
    out = " ".join(capfd.readouterr().out.split())
    assert "expected asperities in contact 5.13e-08 !" in out
    assert "of one pair at the pitch point, at rest under the mean torque." in out
    page = build_report(gd.open_archive(path))
    assert "How far the model holds" in page
    assert "<td>5.13e-08</td><td>!</td>" in page


def test_info_and_report_of_a_sweep_say_whose_they_are(path, capfd):
    gd.sweep(LOW, {"coating.sam_fraction": [1.0, 0.5]}, archive=path)
    assert main(["info", str(path)]) == 0
    words = "for the scene that the runs were derived from: {} may change it"
    assert words.format("sam_fraction") in " ".join(capfd.readouterr().out.split())
    assert words.format("coating.sam_fraction") in build_report(gd.open_archive(path))


def test_an_archive_without_them_is_judged_by_its_scene(path, capfd, tmp_path):
    save(gd.simulate(LOW), path)
    assert "How far the model holds" not in build_report(gd.open_archive(path))
    assert main(["report", str(path), "-o", str(tmp_path / "run.html")]) == 0
    assert "<td>5.13e-08</td>" in (tmp_path / "run.html").read_text(encoding="utf-8")
    capfd.readouterr()
    assert "validity" not in gd.open_archive(path).attrs
    assert main(["info", str(path)]) == 0
    assert "expected asperities in contact 5.13e-08 !" in " ".join(capfd.readouterr().out.split())


def test_what_an_archive_says_is_escaped(path):
    ds = gd.simulate(LOW, archive=path).load()
    rows = json.loads(ds.attrs["validity"])
    rows[0]["verdict"] = "<script>alert(1)</script>"
    ds.attrs["validity"] = json.dumps(rows)
    page = build_report(ds)
    assert "<script>alert" not in page
    assert "&lt;script&gt;alert(1)" in page
