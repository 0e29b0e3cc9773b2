"""The viewer of the time series in a browser: boxes to zoom into, downloads, and a page that fits its window."""

from __future__ import annotations

import csv
import io
import re

import numpy as np
import pytest

import gearidae as gd
from gearidae.report import build_report
from gearidae.report.series import pack
from reference.browser import CHROMIUM, looked_at

# Uses the page as a reader would, and leaves what it saw in the title.
LOOK = """<script>
const seen = { errors: [], files: [] };
window.onerror = (message) => seen.errors.push(message);
const frames = (count) => new Promise((done) => {
  const next = () => count-- > 0 ? requestAnimationFrame(next) : done();
  next();
});
// Files are made on other threads, for which the virtual clock does not wait: here they are made at once.
const made = [];
window.Blob = class extends Blob {
  constructor(parts, options) { super(parts, options); this.words = parts.join(""); }
};
HTMLCanvasElement.prototype.toBlob = function (done) { done(new Blob([this.toDataURL()], { type: "image/png" })); };
URL.createObjectURL = (blob) => { made.push(blob); return "blob:none"; };
HTMLAnchorElement.prototype.click = function () { seen.files.push(this.download); };
const pointer = (canvas, kind, x, y, more) => {
  const box = canvas.getBoundingClientRect();
  canvas.dispatchEvent(new PointerEvent(kind, { clientX: box.left + x, clientY: box.top + y, pointerId: 1, ...more }));
};
const drag = (canvas, from, to, more) => {
  pointer(canvas, "pointerdown", ...from, more);
  pointer(canvas, "pointermove", ...to, more);
  const shown = document.querySelectorAll("#viewer .box").length;
  pointer(canvas, "pointerup", ...to, more);
  return shown;
};
const readout = () => document.querySelector("#viewer output").textContent;
const button = (words) => [...document.querySelectorAll("button")].find((one) => one.textContent === words);
(async () => {
  await frames(3);
  const views = [];
  document.addEventListener("gearidae:view", (event) => views.push([event.detail.from, event.detail.to]));
  const canvas = document.querySelector("#viewer canvas"), wide = canvas.clientWidth - 72;
  seen.boxes = drag(canvas, [62 + 0.25 * wide, 40], [62 + 0.5 * wide, 120], { shiftKey: true });
  await frames(3);
  seen.left = document.querySelectorAll("#viewer .box").length;
  button("all").click();
  button("box zoom").click();
  seen.pressed = button("box zoom").getAttribute("aria-pressed");
  drag(canvas, [62 + 0.9 * wide, 50], [62 + 0.6 * wide, 52]);  // backwards, and flat: time alone
  await frames(3);
  button("CSV").click();
  for (const one of document.querySelector("figcaption .save").querySelectorAll("button")) one.click(); // SVG, PNG
  document.querySelector("#viewer .plot .save button").click();
  for (let i = 0; i < 200 && made.length < 4; i++) await frames(3);
  seen.views = views;
  seen.kinds = made.map((blob) => blob.type + " " + (blob.size > 500));
  seen.table = made[0].words;
  seen.drawing = made.find((blob) => blob.type === "image/svg+xml").words;
  seen.wide = document.documentElement.scrollWidth - document.documentElement.clientWidth;
  seen.ink = getComputedStyle(document.querySelector(".picture svg")).fill;
  seen.line = getComputedStyle(document.documentElement).getPropertyValue("--c-0072b2").trim();
  const heights = [...document.querySelectorAll(".picture svg text")].map((one) => one.getBoundingClientRect().height);
  seen.smallest = Math.min(...heights.filter((height) => height > 0));
  document.title = JSON.stringify(seen);
})();
</script>"""


@pytest.fixture(scope="module")
def swept():
    scene = gd.preset("teodorescu2009_low_speed")
    return gd.sweep(scene, {"coating.sam_fraction": [1.0, 0.5]}, t_end=0.03, samples=601, jobs=1)


@pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_boxes_downloads_and_colours(swept, scheme, tmp_path):
    options = ["--blink-settings=preferredColorScheme=0"] if scheme == "dark" else []
    seen = looked_at(build_report(swept), LOOK, tmp_path, "--window-size=500,900", *options)
    assert seen["errors"] == []
    end = float(swept.time[-1])
    assert (seen["boxes"], seen["left"], seen["pressed"]) == (1, 0, "true")
    first, everything, second = seen["views"]
    # a pixel of some 400 across the plot
    assert first == pytest.approx([0.25 * end, 0.5 * end], abs=end / 200)
    assert everything == [0.0, end]
    assert second == pytest.approx([0.6 * end, 0.9 * end], abs=end / 200)
    assert seen["wide"] <= 0
    assert seen["smallest"] >= 8.0  # readable on a phone
    dark = scheme == "dark"
    assert seen["ink"] == ("rgb(230, 232, 234)" if dark else "rgb(0, 0, 0)")
    assert seen["line"] == ("#4da6e0" if dark else "#0072b2")
    assert sorted(seen["kinds"]) == [
        "image/png true",
        "image/png true",
        "image/svg+xml true",
        "text/csv true",
    ]
    assert sorted(name.rpartition(".")[2] for name in seen["files"]) == ["csv", "png", "png", "svg"]
    # the file stands alone, in the light colours whatever the page has
    assert "var(" not in seen["drawing"]
    assert "#0072b2" in seen["drawing"]
    assert re.match(r"<svg[^>]* xmlns=", seen["drawing"])


@pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")
def test_the_table_is_what_is_shown(swept, tmp_path):
    seen = looked_at(build_report(swept), LOOK, tmp_path, "--window-size=1280,900")
    rows = list(csv.reader(io.StringIO(seen["table"])))
    assert rows[0][:3] == ["time [s]", "gear_speed [rad s-1] SAM 100 %", "gear_speed [rad s-1] SAM 50 %"]
    numbers = np.array(rows[1:], dtype=float)
    from_here, to_here = seen["views"][-1]
    inside = swept.sel(time=slice(from_here, to_here))
    assert len(numbers) == pytest.approx(inside.sizes["time"], abs=2)
    shown = swept.sel(time=numbers[:, 0], method="nearest")
    np.testing.assert_allclose(shown.time, numbers[:, 0], rtol=1e-8)
    for column, fraction in ((1, 1.0), (2, 0.5)):
        # float32 in the page, eight digits in the file
        np.testing.assert_allclose(
            numbers[:, column], shown.gear_speed.sel(sam_fraction=fraction), rtol=1.2e-7
        )


# Chooses runs on the map of a large sweep, and leaves what is drawn in the title.
CHOOSE = """<script>
const seen = { errors: [], steps: [] };
window.onerror = (message) => seen.errors.push(message);
const made = [];
window.Blob = class extends Blob {
  constructor(parts, options) { super(parts, options); made.push(parts.join("")); }
};
HTMLAnchorElement.prototype.click = () => {};
const frames = (count) => new Promise((done) => {
  const next = () => count-- > 0 ? requestAnimationFrame(next) : done();
  next();
});
const fields = () => [...document.querySelectorAll("#choice .fields button")];
const all = (words) => [...document.querySelectorAll(words)];
const legend = () => all("#viewer .controls button").filter((one) => one.querySelector("svg"));
const taken = () => fields().filter((one) => one.getAttribute("aria-pressed") === "true");
const pixels = () => document.querySelector("#viewer canvas").toDataURL();
const button = (words) => [...document.querySelectorAll("button")].find((one) => one.textContent === words);
const note = () => {
  button("CSV").click();
  seen.steps.push({
    legend: legend().map((one) => one.textContent),
    pressed: taken().map((one) => one.title),
    edges: taken().map((one) => one.style.borderBottomColor),
    dashes: legend().map((one) => one.querySelector("path").getAttribute("stroke-dasharray")),
    heading: made.at(-1).split("\\n").find((line) => line.startsWith('"time')),
    picture: pixels(),
  });
};
(async () => {
  await frames(3);
  const list = document.querySelector("#choice select"), isFree = (one) => one.getAttribute("aria-pressed") === "false";
  seen.parts = [];
  for (const option of list.options) {
    list.value = option.value;
    list.dispatchEvent(new Event("change"));
    seen.parts.push(fields().map((one) => one.title));
    if (fields().some(isFree)) break;
  }
  note();
  const free = fields().find(isFree);
  seen.clicked = free.title;
  free.click();
  await frames(3);
  note();
  free.click();
  await frames(3);
  note();
  seen.wide = document.documentElement.scrollWidth - document.documentElement.clientWidth;
  document.title = JSON.stringify(seen);
})();
</script>"""


@pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")
@pytest.mark.parametrize("size", ["1200,900", "500,900"], ids=["desktop", "phone"])
def test_runs_of_a_large_sweep_are_chosen_on_the_map(size, tmp_path):
    over = {
        "drive.torque": [4.5e-18, 9e-18],
        "coating.sam_fraction": [1.0, 0.6],
        "mesh.backlash": [2e-7, 1e-7],
    }
    scene = gd.preset("teodorescu2009_low_speed")
    ds = gd.sweep(scene, over, t_end=0.004, samples=101, jobs=1)
    seen = looked_at(build_report(ds, teeth=False), CHOOSE, tmp_path, f"--window-size={size}")
    assert seen["errors"] == []
    first, taken, left = seen["steps"]
    # seven of eight at first; the other takes the place of the first and with it its line
    assert len(first["legend"]) == 7
    assert len(first["pressed"]) == 3
    (new,) = {run["label"] for run in pack(ds)["runs"]} - {*first["legend"]}
    assert taken["legend"] == [new, *first["legend"][1:]]
    assert taken["dashes"] == first["dashes"]
    assert seen["clicked"] in taken["pressed"]
    assert len({*taken["pressed"]} - {*first["pressed"]}) == 1
    # a second click takes it out, and the others keep their lines
    assert left["legend"] == first["legend"][1:]
    assert left["dashes"] == first["dashes"][1:]
    assert seen["clicked"] not in left["pressed"]
    for step in seen["steps"]:
        columns = next(csv.reader([step["heading"]]))
        speeds = [
            name.removeprefix("gear_speed [rad s-1] ") for name in columns if name.startswith("gear_speed")
        ]
        assert speeds == step["legend"]
        assert len({*step["edges"]}) == len(step["pressed"])  # a colour each
    assert len({step["picture"] for step in seen["steps"]}) == 3
    # three keys: the map shows the last two, a list the other
    for part, torque in zip(seen["parts"], ("4.5", "9"), strict=False):
        assert len(part) == 4
        assert all(title.startswith(f"torque {torque} aN m, ") for title in part)
    assert seen["wide"] <= 0
