"""What holds for every study: interrupted, resumed, kept from being replaced, and its file known to all who read it.

That another's lock and a name that cannot be written are refused is tested for all files in `tests/archive`.
"""

from __future__ import annotations

import html
import json
import re
import subprocess
import sys

import pytest
import xarray as xr

import gearidae as gd
from gearidae.archive.lock import is_locked
from gearidae.cli import main
from gearidae.report import build_report
from gearidae.studies.declared import studies
from gearidae.studies.products import answer, kind_of, open_product
from reference.small_studies import LOW, STUDIES
from sweeps import without_times

KEEPS_NOTHING = {"pull_off"}
"""Studies of seconds, which begin anew."""


@pytest.fixture(scope="module", params=STUDIES)
def product(request, tmp_path_factory):
    """Make a study's file: its kind, its name, its content."""
    path = tmp_path_factory.mktemp("study") / f"{request.param}.nc"
    return request.param, path, STUDIES[request.param](path, jobs=1)


def test_interrupted_and_resumed_by_two_threads_it_ends_alike(product, tmp_path):
    kind, _, ds = product
    path = tmp_path / "out.nc"

    def ctrl_c(done, total):
        if done > 1.0 or done == total:
            raise KeyboardInterrupt

    with pytest.raises(gd.Interrupted, match="--resume"):
        STUDIES[kind](path, jobs=1, progress=ctrl_c)
    assert not is_locked(path)
    left = list(tmp_path.glob("out.nc.*"))
    assert bool(left) is (kind not in KEEPS_NOTHING)
    if left:
        with pytest.raises(gd.SceneError, match=r"was cut off.*--resume.*--overwrite"):
            STUDIES[kind](path)
    whole = STUDIES[kind](path, jobs=2, resume=True)
    same = (without_times(dataset).drop_vars("time_to_take", errors="ignore") for dataset in (whole, ds))
    xr.testing.assert_identical(*same)
    assert list(tmp_path.iterdir()) == [path]


def test_what_is_whole_is_neither_computed_again_nor_replaced(product, monkeypatch):
    kind, path, ds = product
    before = path.read_bytes()
    monkeypatch.setattr("gearidae.engine.solve", None)  # any run would fail
    again = STUDIES[kind](path, resume=True)
    assert answer(again, kind) == answer(ds, kind)
    with pytest.raises(gd.SceneError, match="exists already"):
        STUDIES[kind](path)
    (usual,) = STUDIES[kind].__defaults__
    with pytest.raises(gd.SceneError, match="of another sweep or study"):
        STUDIES[kind](path, usual.replace({"name": "other"}), resume=True)
    assert path.read_bytes() == before


def test_a_file_is_known_for_what_it_is(product):
    kind, path, ds = product
    opened_product, name = open_product(path)
    assert name == kind == kind_of(ds)
    assert answer(opened_product, kind) == answer(ds, kind)
    opened = gd.open(path)
    assert opened.identical(opened_product)
    assert opened.gearidae.kind == kind
    assert answer(ds, kind).sentence in repr(opened.gearidae)
    for row in repr(opened.gearidae).splitlines()[1:]:
        call = row.split("  ")[1]
        found_name = call if call.startswith("gearidae.") else f"opened.gearidae.{call}"
        assert eval(found_name, {"opened": opened, "ds": opened, "gearidae": gd}) is not None, call


def test_a_file_holds_what_its_study_declares(product):
    """Dimensions and units of the columns, as the reference lists them."""
    kind, path, _ = product
    opened, _ = open_product(path)
    columns = studies()[kind].columns
    assert columns
    for name, column in columns.items():
        if name not in opened.variables:
            assert not column.required, name
            continue
        assert len(opened[name].dims) == len(column.dims), name
        if column.units and not column.units.startswith("{"):
            assert opened[name].attrs.get("units", "1") == column.units, name


def test_a_study_needs_neither_the_engine_nor_matplotlib_to_be_read():
    script = (
        "import sys; from gearidae.studies.declared import studies; studies(); "
        "heavy = ('numba', 'matplotlib', 'scipy.stats', 'gearidae.engine', 'gearidae.compiled.cache', 'gearidae.cli'); "
        "print([name for name in heavy if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_every_kind_is_tested_here():
    assert set(studies()) == set(STUDIES)


def test_terminal_report_and_json_give_the_same_answer(product, tmp_path, capsys):
    kind, path, ds = product
    reply = answer(ds, kind)
    assert reply.sentence.endswith(".")
    assert main(["info", str(path)]) == 0
    assert reply.sentence in capsys.readouterr().out
    assert main(["info", str(path), "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert (printed["kind"], printed["answer"]) == (kind, reply.sentence)
    assert main(["report", str(path), "-o", str(tmp_path / "page.html")]) == 0
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert f'<p class="headline">{html.escape(reply.sentence)}</p>' in page
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
