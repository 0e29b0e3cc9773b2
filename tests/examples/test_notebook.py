"""The notebook runs in a real kernel, and in a plain interpreter where there is none."""

from __future__ import annotations

import ast
import json
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
NOTEBOOK = ROOT / "examples" / "first_look.ipynb"


def sources():
    """Code of the cells."""
    cells = json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"]
    return ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]


def run(cell, names):
    """Run a cell in these names; its last value, as a notebook would show it."""
    tree = ast.parse(cell)
    last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
    exec(compile(tree, NOTEBOOK.name, "exec"), names)
    return None if last is None else eval(compile(ast.Expression(last.value), NOTEBOOK.name, "eval"), names)


def test_cells_run_in_order_over_an_older_archive_and_show_something(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "first_look.nc").write_bytes(b"of a run before")
    names = {"__name__": "__main__"}
    shown = [run(cell, names) for cell in sources()]
    assert "compared with the preset teodorescu2009_low_speed: 2 keys differ" in shown[0]._repr_html_()
    assert [hasattr(shown[k], "_repr_png_") for k in (2, 4)] == [True, True]
    assert "sticks at" in shown[3]._repr_html_()
    assert "did you mean gears.module?" in capsys.readouterr().out
    assert shown[6] == pytest.approx(3.5708e-5, rel=1e-4, abs=0)  # 4 um * 19 * cos(20 deg) / 2
    assert [path.name for path in tmp_path.iterdir()] == ["first_look.nc"]


def test_no_output_is_kept_with_the_notebook():
    for cell in json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"]:
        assert not cell.get("outputs")
        assert cell.get("execution_count") is None


@pytest.mark.slow
@pytest.mark.filterwarnings("default")  # of the machinery that talks to the kernel
def test_a_kernel_shows_pictures_tables_and_progress(tmp_path):
    nbclient = pytest.importorskip("nbclient")
    nbformat = pytest.importorskip("nbformat")
    pytest.importorskip("ipykernel")
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    client = nbclient.NotebookClient(
        notebook, timeout=600, kernel_name="python3", resources={"metadata": {"path": str(tmp_path)}}
    )
    client.execute()
    cells = [cell["outputs"] for cell in notebook.cells if cell["cell_type"] == "code"]
    kinds = [{kind for output in outputs for kind in output.get("data", {})} for outputs in cells]
    assert "text/html" in kinds[0]
    bar = cells[1][0]["data"]
    assert 'max="100" value="100"' in bar["text/html"]
    assert "100 of 100 ms" in bar["text/plain"]
    assert ["image/png" in kinds[k] for k in (2, 4)] == [True, True]
    assert "4 of 4 runs" in cells[3][0]["data"]["text/plain"]
    assert "<table>" in cells[3][-1]["data"]["text/html"]
    assert "did you mean" in cells[5][0]["text"]
