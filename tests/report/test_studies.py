"""What every study writes is known to info, plot and report, which give the same answer."""

from __future__ import annotations

import html
import json
import re
import subprocess
import sys

import pytest

import gearidae as gd
from gearidae.cli import main
from gearidae.report import build_report
from gearidae.studies.declared import studies
from gearidae.studies.products import answer, kind_of, open_product

LOW = gd.preset("teodorescu2009_low_speed").replace({"run.duration": 4e-3, "run.samples": 401})
LAW = gd.wear.loss_law("adhesion_work", energy=1e-6)
WINDOWS = {"cycles": 3, "settle": 2, "starts": 1, "places": 2, "fraction": 0.68, "tolerance": 1e-2}
WORN = LOW.replace({"coating.sam_fraction": 0.7})
DRAWN = {"drive.torque": "uniform(4e-18, 5e-18)", "coating.sam_fraction": "uniform(0.5, 1)"}


def lives(path, **more):
    vary = {"law.energy": "uniform(1e-6, 2e-6)"}
    return gd.studies.lives(WORN, LAW, vary, 2, **WINDOWS, archive=path, **more)


def operating_map(path, **more):
    over = {"drive.torque": [4e-18, 5e-18], "coating.sam_fraction": [1.0, 0.5]}
    return gd.studies.operating_map(LOW, over, archive=path, **more)


def hub_life(path, **more):
    joints = {"gears.pinion_hub_radius": 3e-6, "gears.gear_hub_radius": 6e-6, "run.duration": 0.1e-3}
    wear = {"coefficient": 1e-16, "threshold": "2 sigma", "spread": 2.0, "seeds": 5, "clearance": True}
    rubbing = gd.preset("teodorescu2009").replace(joints)
    return gd.studies.hub_life(rubbing, **wear, turns=1, tolerance=0.1, archive=path, **more)


def posterior(path, **more):
    seen = [gd.studies.Observation(value=False)]
    priors = {"drive.torque": "normal(4.5e-18, 2e-19)"}
    return gd.studies.calibrate(LOW, priors, seen, points=3, archive=path, **more)


def starting_torque(path, **more):
    bare = LOW.replace({"coating.sam_fraction": 0.45})
    return gd.studies.starting_torque(bare, "own", impacts=1, tolerance=0.5, archive=path, **more)


def starting_torques(path, **more):
    gears = gd.preset("teodorescu2009").replace({"contact.roughness": "discrete", "load.torque": 0.0})
    return gd.studies.starting_torque(gears, seeds=2, archive=path, **more)


def sticking_threshold(path, **more):
    ends = {"between": (0.4, 0.7), "exits": 5, "width": 0.05}
    return gd.studies.sticking_threshold(LOW, **ends, archive=path, **more)


STUDIES = {
    "coating_map": lambda path, **more: gd.studies.coating_map(LOW, [1.0, 0.8], archive=path, **more),
    "convergence": lambda path, **more: gd.studies.convergence(
        LOW, ["gear_angle", "adhesion_loss"], rtols=[1e-4, 1e-5, 1e-6], archive=path, **more
    ),
    "ensemble": lambda path, **more: gd.studies.ensemble(
        LOW, DRAWN, 4, of="min_gear_speed", archive=path, **more
    ),
    "hub_life": hub_life,
    "life": lambda path, **more: gd.studies.life(
        WORN, LAW, **WINDOWS, resolved="place", archive=path, **more
    ),
    "lives": lives,
    "operating_map": operating_map,
    "posterior": posterior,
    "pull_off": lambda path, **more: gd.studies.pull_off(LOW, 5, archive=path, **more),
    "starting_torque": starting_torque,
    "starting_torques": starting_torques,
    "sticking_threshold": sticking_threshold,
}


@pytest.fixture(scope="module", params=STUDIES)
def product(request, tmp_path_factory):
    """Make a study's file: its kind, its name, its content."""
    path = tmp_path_factory.mktemp("study") / f"{request.param}.nc"
    return request.param, path, STUDIES[request.param](path)


def test_a_file_is_known_for_what_it_is(product):
    kind, path, ds = product
    found, name = open_product(path)
    assert name == kind == kind_of(ds)
    assert answer(found, kind) == answer(ds, kind)
    opened = gd.open(path)
    assert opened.identical(found)
    assert opened.gearidae.kind == kind
    assert answer(ds, kind).sentence in repr(opened.gearidae)
    for row in repr(opened.gearidae).splitlines()[1:]:
        call = row.split("  ")[1]
        found_name = call if call.startswith("gearidae.") else f"opened.gearidae.{call}"
        assert eval(found_name, {"opened": opened, "ds": opened, "gearidae": gd}) is not None, call


def test_a_file_holds_what_its_study_declares(product):
    """Dimensions and units of the columns, as the reference lists them."""
    kind, path, _ = product
    found, _ = open_product(path)
    columns = studies()[kind].columns
    assert columns
    for name, column in columns.items():
        if name not in found.variables:
            assert not column.required, name
            continue
        assert len(found[name].dims) == len(column.dims), name
        if column.units and not column.units.startswith("{"):
            assert found[name].attrs.get("units", "1") == column.units, name


def test_a_study_needs_neither_the_engine_nor_matplotlib_to_be_read():
    script = (
        "import sys; from gearidae.studies.declared import studies; studies(); "
        "heavy = ('numba', 'matplotlib', 'scipy.stats', 'gearidae.engine', 'gearidae.compiled', 'gearidae.cli'); "
        "print([name for name in heavy if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_every_kind_is_tested_here():
    assert set(studies()) == set(STUDIES)


def test_a_whole_file_is_not_computed_again(product, monkeypatch):
    kind, path, _ = product
    before = path.read_bytes()
    monkeypatch.setattr("gearidae.engine.solve", None)  # any run would fail
    again = STUDIES[kind](path, resume=True)
    assert answer(again, kind) == answer(product[2], kind)
    assert path.read_bytes() == before


def test_terminal_report_and_json_give_the_same_answer(product, tmp_path, capsys):
    kind, path, ds = product
    found = answer(ds, kind)
    assert found.sentence.endswith(".")
    assert main(["info", str(path)]) == 0
    assert found.sentence in capsys.readouterr().out
    assert main(["info", str(path), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["kind"], told["answer"]) == (kind, found.sentence)
    assert main(["report", str(path), "-o", str(tmp_path / "page.html")]) == 0
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert f'<p class="headline">{html.escape(found.sentence)}</p>' in page
    assert page.count("<figure") >= 1
    assert main(["plot", str(path), "-o", str(tmp_path / "picture.png")]) == 0
    assert (tmp_path / "picture.png").stat().st_size > 5000


def test_a_gear_that_adhesion_does_not_hold_starts_at_once():
    ds = gd.studies.starting_torque(LOW, "own", impacts=1, tolerance=0.5)
    assert answer(ds, "starting_torque").sentence.startswith(
        "Adhesion of the teeth does not hold a gear at rest"
    )


def test_a_report_on_an_ensemble_says_first_what_was_asked(tmp_path):
    ds = STUDIES["ensemble"](tmp_path / "out.nc")
    page = build_report(ds)
    places = [page.index(words) for words in ("probability of sticking", "Sobol indices of", "<details>")]
    assert places == sorted(places)
    assert "drawn from uniform(4e-18, 5e-18)" in page
    folded = page[places[-1] : page.index("</details>")]
    assert len(re.findall("<tr>", folded)) == 1 + ds.sizes["member"]
    assert f"{1e18 * float(ds.torque[0]):.6g} aN m" in folded
