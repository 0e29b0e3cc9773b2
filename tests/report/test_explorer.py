"""The page to look through runs: what is embedded is what was recorded, and a browser shows it."""

from __future__ import annotations

import base64
import json

import numpy as np
import pytest

import gearidae as gd
from gearidae.analysis.verdict import outcomes
from gearidae.cli import main
from gearidae.report import build_explorer
from gearidae.report.explorer import FRAME, pack_explorer
from reference.browser import CHROMIUM, looked_at

SCENE = gd.preset("teodorescu2009_low_speed")
GEOMETRY = SCENE.geometry

# Uses the page as a reader would, and leaves what it saw in the title.
LOOK = """<script>
const seen = { errors: [] };
window.onerror = (message) => seen.errors.push(message);
const frames = (count) => new Promise((done) => {
  const next = () => count-- > 0 ? requestAnimationFrame(next) : done();
  next();
});
const all = (words) => [...document.querySelectorAll("#explorer " + words)];
const note = (name) => {
  const pressed = all(".fields button").filter((field) => field.getAttribute("aria-pressed") === "true");
  seen[name] = {
    words: all("output").at(-1).textContent,
    verdict: all(".verdict")[0].textContent,
    edge: getComputedStyle(all(".stage")[0]).borderLeftColor,
    values: all(".sliders output").map((one) => one.textContent),
    pressed: pressed.map((field) => field.title),
    picture: all("canvas")[0].toDataURL(),
  };
};
const move = (slider, value) => { slider.value = value; slider.dispatchEvent(new Event("input")); };
(async () => {
  const [over, time] = [all(".sliders input"), all(".controls input")[0]];
  await frames(3);
  note("first");
  move(time, time.max);
  await frames(3);
  note("end");
  over.forEach((slider) => move(slider, slider.max));
  await frames(3);
  note("last");
  const field = all(".fields button")[0];
  if (field) { field.click(); await frames(3); note("clicked"); }
  const curve = all(".curve canvas")[0], box = curve.getBoundingClientRect();
  const pointer = { clientX: box.left + 62 + (box.width - 72) / 2, clientY: box.top + 40, pointerId: 1 };
  curve.setPointerCapture = () => {};
  curve.dispatchEvent(new PointerEvent("pointerdown", pointer));
  await frames(3);
  seen.half = Number(time.value);
  move(time, 0);
  const play = all(".controls button")[0];
  play.click();
  await frames(12);
  seen.playing = play.textContent + " " + (time.value > 0);
  play.click();
  seen.stopped = play.textContent;
  const mesh = all("canvas")[0], colours = new Set();
  const image = mesh.getContext("2d").getImageData(0, 0, mesh.width, mesh.height).data;
  for (let i = 0; i < image.length; i += 4) colours.add(image[i] + "," + image[i + 1] + "," + image[i + 2]);
  seen.gears = ["--pinion", "--gear"].map((name) => {
    const hex = getComputedStyle(document.documentElement).getPropertyValue(name).trim().slice(1);
    return colours.has([0, 2, 4].map((at) => parseInt(hex.slice(at, at + 2), 16)).join(","));
  });
  const teeth = document.querySelector("#teeth-viewer output");
  if (teeth) {
    move(time, time.max);
    await frames(3);
    seen.teeth = teeth.textContent;
  }
  seen.wide = document.documentElement.scrollWidth - document.documentElement.clientWidth;
  document.title = JSON.stringify(seen);
})();
</script>"""


@pytest.fixture(scope="module")
def swept():
    over = {"coating.sam_fraction": [1.0, 0.3], "mesh.backlash": [2e-7, 3e-7, 1e-7]}
    return gd.sweep(SCENE, over, t_end=0.03, samples=1001, jobs=1)


def decoded(text):
    return np.frombuffer(base64.b64decode(text), dtype="<f4")


def frames_of(data, number):
    return decoded(data["runs"][number]["frames"]).reshape(-1, len(FRAME))


def test_pictures_are_samples_of_the_record(swept):
    data = pack_explorer(swept, most_values=6 * 12 * 100)
    assert [dim["name"] for dim in data["dims"]] == ["sam fraction", "backlash"]
    # from small to large, whatever the order of the sweep
    assert data["dims"][0]["values"] == ["0.3", "1"]
    assert data["dims"][1]["values"] == ["100 nm", "200 nm", "300 nm"]
    assert data["every"] == 11
    for number, (sam, backlash) in enumerate((s, b) for s in (0.3, 1.0) for b in (1e-7, 2e-7, 3e-7)):
        run = swept.sel(sam_fraction=sam, backlash=backlash).isel(time=slice(None, None, 11))
        frames = frames_of(data, number)
        assert len(frames) == run.sizes["time"] == data["frames"]
        for place, name in enumerate(FRAME[1:], 1):
            # float32 keeps seven digits
            np.testing.assert_allclose(frames[:, place], run[name], rtol=1.2e-7)
        turned = run.gear_angle * GEOMETRY.base_radius_gear / GEOMETRY.base_pitch
        travel = (SCENE.initial.mesh_phase + turned) % (GEOMETRY.pinion_teeth * GEOMETRY.gear_teeth)
        np.testing.assert_allclose(frames[:, 0], travel, rtol=1.2e-7)


def test_curves_keep_the_extremes(swept):
    data = pack_explorer(swept, most_values=6 * 12 * 50)
    low, high = data["ranges"][0]
    assert low == pytest.approx(float(swept.gear_speed.min()), rel=1e-6)
    assert high == pytest.approx(float(swept.gear_speed.max()), rel=1e-6)
    for number, sam in ((0, 0.3), (3, 1.0)):
        run = swept.sel(sam_fraction=sam, backlash=1e-7)
        for name, text in zip(
            ("gear_speed", "gear_contact_torque"), data["runs"][number]["curves"], strict=True
        ):
            curve = decoded(text)
            assert len(curve) <= 100
            assert curve.min() == np.float32(run[name].min())
            assert curve.max() == np.float32(run[name].max())


def test_each_run_has_its_verdict_and_its_gears(swept):
    data = pack_explorer(swept)
    for judged in outcomes(swept):
        at = [0.3, 1.0].index(judged.label["sam_fraction"]) * 3
        at += [1e-7, 2e-7, 3e-7].index(judged.label["backlash"])
        assert data["looks"][data["verdicts"][at]]["word"] == judged.verdict
        assert data["words"][at] == judged.words
    # one pair of gears for each backlash, and one factor for all: 0.4 modules over the largest backlash, rounded down
    assert [run["gears"] for run in data["runs"]] == [0, 1, 2, 0, 1, 2]
    assert data["gaps"] == 0.4 * GEOMETRY.module // 3e-7
    assert [2 * gears["halfBacklash"] for gears in data["gears"]] == pytest.approx(
        [data["gaps"] * backlash for backlash in (1e-7, 2e-7, 3e-7)], rel=1e-12
    )


def test_fifty_runs_are_less_than_three_megabytes():
    shares = np.linspace(0.55, 1.0, 50).tolist()
    ds = gd.sweep(SCENE, {"coating.sam_fraction": shares}, t_end=0.001, samples=6001, jobs=1)
    page = build_explorer(ds)
    assert len(page.encode()) < 3_000_000
    # as many pictures as they may have: twelve numbers each with its curves
    assert pack_explorer(ds)["frames"] > 0.8 * 400_000 / (12 * 50)


def test_a_run_that_ends_early_has_its_own_pictures():
    scene = SCENE.replace({"run.stop": "sticks"})
    ds = gd.sweep(scene, {"coating.sam_fraction": [0.3, 1.0]}, t_end=0.1, samples=301, jobs=1)
    stuck = int(np.isfinite(ds.gear_angle.sel(sam_fraction=0.3)).sum())
    assert stuck < 301
    data = pack_explorer(ds)
    assert [len(frames_of(data, number)) for number in (0, 1)] == [stuck, 301]
    # time that no run has reached is not on the page
    alone = pack_explorer(ds.sel(sam_fraction=[0.3]))
    assert alone["frames"] == stuck
    assert alone["end"] == float(ds.time[stuck - 1])


def test_walked_keys_share_a_slider():
    ds = gd.sweep(
        SCENE,
        {"coating.sam_fraction": [0.5, 1.0], "mesh.backlash": [1e-7, 2e-7]},
        zipped=True,
        t_end=0.001,
        samples=11,
        jobs=1,
    )
    (dim,) = pack_explorer(ds)["dims"]
    assert dim["values"] == ["0.5, backlash 100 nm", "1, backlash 200 nm"]


def test_what_cannot_be_looked_through_is_refused(tmp_path):
    with pytest.raises(gd.SceneError, match="a roller"):
        gd.explore(gd.simulate(gd.preset("roller_slow"), samples=11), tmp_path / "roller.html")
    kept = gd.sweep(SCENE, {"coating.sam_fraction": [0.5, 1.0]}, t_end=0.001, keep=["verdict"], jobs=1)
    with pytest.raises(gd.SceneError, match="no samples"):
        gd.explore(kept, tmp_path / "kept.html")
    run = gd.simulate(SCENE, t_end=0.001, samples=11)
    with pytest.raises(gd.SceneError, match="no run has samples"):
        gd.explore(run.sel(time=slice(1.0, 2.0)), tmp_path / "later.html")
    gd.explore(run, tmp_path / "page.html")
    with pytest.raises(gd.SceneError, match=r"page\.html"):
        gd.explore(run, tmp_path / "page.html")
    assert list(tmp_path.iterdir()) == [tmp_path / "page.html"]


def test_command(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    ds = gd.sweep(SCENE, {"coating.sam_fraction": [0.5, 1.0]}, t_end=0.004, samples=401, jobs=1)
    gd.save(ds, "two.nc")
    assert main(["explore", "two.nc"]) == 0
    assert "Page: two_explore.html" in capsys.readouterr().out
    chosen = ["--select", "sam_fraction=0.5", "--from", "1 ms", "--to", "2 ms", "-o", "part.html"]
    assert main(["explore", "two.nc", *chosen]) == 0
    text = (tmp_path / "part.html").read_text()
    data = json.loads(text.partition('id="explorer-data">')[2].partition("</script>")[0])
    assert data["dims"] == []
    assert (data["start"], data["end"]) == pytest.approx((1e-3, 2e-3), rel=1e-12)
    assert len(frames_of(data, 0)) == 101
    assert main(["explore", "two.nc"]) == 0  # in place of its own page
    assert main(["explore", "two.nc", "-o", "part.html"]) == 2
    (tmp_path / "two_explore.html").write_text("notes")
    assert main(["explore", "two.nc"]) == 2
    assert main(["explore", "two.nc", "--select", "backlash=1", "-o", "no.html"]) == 2


@pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")
@pytest.mark.parametrize(
    "options",
    [["--window-size=1200,900"], ["--window-size=500,800", "--blink-settings=preferredColorScheme=0"]],
    ids=["desktop", "phone"],
)
def test_browser_goes_through_runs_and_time(swept, options, tmp_path):
    # one picture for 3 samples of 1001: the last picture is not the last sample
    seen = looked_at(build_explorer(swept, most_values=6 * 12 * 400), LOOK, tmp_path, *options)
    assert seen["errors"] == []
    last = swept.isel(time=999)
    by_label = {tuple(judged.label.values()): judged for judged in outcomes(swept)}
    end = f"{float(last.time) * 1e3:#.6g} ms"
    for name, place, time in (
        ("first", (0.3, 1e-7), "0 s"),
        ("end", (0.3, 1e-7), end),
        ("last", (1.0, 3e-7), end),
        ("clicked", (1.0, 1e-7), end),  # the map's upper left corner
    ):
        shown, ds = seen[name], swept.isel(time=0) if time == "0 s" else last
        sample = ds.sel(sam_fraction=place[0], backlash=place[1])
        assert shown["words"].startswith(f"t = {time}")
        assert f"gear {float(sample.gear_speed):#.4g} rad/s" in shown["words"]
        assert f"{int(sample.pairs_in_contact)} pair" in shown["words"]
        assert shown["verdict"].endswith(by_label[place].words)
        nanometres = f"{place[1] * 1e9:.3g} nm"
        assert shown["values"] == [f"{place[0]:g}", nanometres]
        assert shown["pressed"] == [
            f"sam fraction {place[0]:g}, backlash {nanometres}: {by_label[place].words}"
        ]
    assert seen["first"]["picture"] != seen["end"]["picture"]
    assert seen["first"]["edge"] != seen["last"]["edge"]  # one sticks, the other turns
    assert seen["half"] == pytest.approx(500 / 3, abs=2)  # a pixel of some 400
    assert seen["playing"] == "Pause true"
    assert seen["stopped"] == "Play"
    assert seen["gears"] == [True, True]
    assert seen["wide"] <= 0


@pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")
def test_browser_shows_a_single_run_with_its_teeth(tmp_path):
    run = gd.simulate(SCENE, t_end=0.004, samples=401)
    seen = looked_at(build_explorer(run, teeth=True), LOOK, tmp_path, "--window-size=1200,900")
    assert seen["errors"] == []
    assert seen["first"]["values"] == []
    assert seen["end"]["words"].startswith("t = 4.00000 ms")
    assert seen["teeth"].startswith("t = 4.00000 ms")  # they follow the slider
