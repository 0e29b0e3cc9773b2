"""The report on a life: a page that stands alone, and its slider over passages in a browser."""

from __future__ import annotations

import json
import re

import numpy as np
import pytest
import xarray as xr

import gearidae as gd
from gearidae.archive import save
from gearidae.archive.provenance import provenance
from gearidae.cli import main
from gearidae.report import build_report
from reference.browser import CHROMIUM, looked_at

LOOK = """<script>
const seen = { errors: [] };
window.onerror = (message) => seen.errors.push(message);
(async () => {
  await new Promise((done) => setTimeout(done, 100));
  const root = document.getElementById("life-viewer"), slider = root.querySelector("input");
  const shown = () => root.querySelector("output").textContent;
  seen.first = shown();
  slider.focus();
  seen.focused = document.activeElement === slider;
  slider.value = 250;
  slider.dispatchEvent(new Event("input"));
  seen.between = shown();
  seen.spoken = slider.getAttribute("aria-valuetext");
  root.querySelectorAll("button")[1].click();
  seen.next = shown();
  for (let i = 0; i < 5; i++) root.querySelectorAll("button")[1].click();
  slider.value = 1000;
  slider.dispatchEvent(new Event("input"));
  seen.last = shown();
  root.querySelectorAll("button")[0].click();
  seen.before = shown();
  const inked = (one) => one.getContext("2d").getImageData(0, 0, one.width, one.height).data.some((each) => each > 0);
  seen.drawn = [...root.querySelectorAll("canvas")].map(inked);
  seen.wide = document.documentElement.scrollWidth - document.documentElement.clientWidth;
  const heights = [...root.querySelectorAll("button, input")].map((one) => one.getBoundingClientRect().height);
  seen.controls = Math.min(...heights);
  document.title = JSON.stringify(seen);
})();
</script>"""


@pytest.fixture(scope="module")
def life():
    """A life with coverage by tooth and place, without a run."""
    scene = gd.preset("teodorescu2009_low_speed")
    shares = np.array([0.9, 0.8, 0.6])
    table = shares[:, None, None, None] + np.linspace(-0.05, 0.05, 19)[:, None] + np.linspace(-0.01, 0.01, 4)
    return xr.Dataset(
        {
            "coverage": (("passages", "side"), shares[:, None]),
            "verdict": ("passages", ["turns", "turns", "turns"]),
            "mean_gear_speed": ("passages", [1.5, 1.49, 1.45]),
            "min_gear_speed": ("passages", [1.4, 1.3, 1.1]),
            "characteristic_frequency": ("passages", [1000.0, 2000.0, 5000.0]),
            "coverage_by_place": (("passages", "side", "tooth", "place"), table),
        },
        coords={
            "passages": [0.0, 1e6, 2e6],
            "side": ["interface"],
            "tooth": np.arange(19),
            "place": [1e-6, 2e-6, 3e-6, 4e-6],
        },
        attrs={
            **provenance(scene, "made by hand"),
            "ending": "sticks",
            "passages_to_sticking": 2.1e6,
            "law": json.dumps({"name": "contacts", "area": 1e-18}),
            "law_source": "a <b>source</b>",
        },
    )


def test_the_page_stands_alone(life, tmp_path):
    path = tmp_path / "life.nc"
    save(life, path)
    assert main(["report", str(path), "-o", str(tmp_path / "life.html")]) == 0
    page = (tmp_path / "life.html").read_text(encoding="utf-8")
    assert not re.search(r"""(src|href)=["'](?!#|data:)""", page)
    assert "sticks between 2e+06 and 2.1e+06 passages" in page
    assert "a &lt;b&gt;source&lt;/b&gt;" in page
    data = json.loads(re.search(r'id="life-data">(.*?)</script>', page, re.DOTALL)[1])
    assert data["passages"] == [0.0, 1e6, 2e6]
    assert data["coverage"] == [[0.9, 0.8, 0.6]]
    assert (data["teeth"], len(data["tables"])) == (19, 1)


@pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")
@pytest.mark.parametrize("resolved", [True, False])
def test_a_slider_over_passages(life, resolved, tmp_path):
    ds = life if resolved else life.drop_vars(["coverage_by_place", "characteristic_frequency"])
    seen = looked_at(build_report(ds), LOOK, tmp_path, "--window-size=390,900")
    assert seen["errors"] == []
    assert seen["first"].startswith("0e+0 passages: coverage 90.0 %, turns, mean speed 1.500 rad/s")
    assert ("rings at 1 kHz" in seen["first"]) == resolved
    # a quarter of 2.1e6 passages, in the middle of the first step
    assert seen["between"].startswith("5.25e+5 passages: coverage 84.8 %")
    assert seen["spoken"] == seen["between"]
    assert seen["next"].startswith("1e+6 passages: coverage 80.0 %")
    assert "sticks" in seen["last"]
    assert seen["before"].startswith("2e+6 passages: coverage 60.0 %, turns")
    assert seen["drawn"] == [True] * (2 if resolved else 1)
    assert seen["focused"]
    assert seen["wide"] <= 0
    assert seen["controls"] >= 40.0  # large enough for a finger
