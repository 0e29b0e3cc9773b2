"""The teeth in the report: what is embedded is what the record says, and a browser shows it."""

from __future__ import annotations

import base64
import json

import numpy as np
import pytest

import gearidae as gd
from gearidae.archive.select import run_scene
from gearidae.plot.teeth_view import MOST_PLAY, enlarged
from gearidae.plot.tooth_shape import tooth_outline
from gearidae.populations.met_flank import contact_arc, met_flank
from gearidae.records import Flank
from gearidae.report import build_report
from gearidae.report.teeth import FRAME, PAIR, pack_teeth
from gearidae.studies._tooth_contacts import tooth_contacts
from reference.browser import CHROMIUM, looked_at

SCENE = gd.preset("teodorescu2009_low_speed")

# Looks at the page as a reader would, and leaves what it saw in the title.
LOOK = """<script>
const seen = [];
window.onerror = (message) => seen.push("error: " + message);
const note = (name) => seen.push(name + ": " + document.querySelector("#teeth-viewer output").textContent
  + " | " + [...document.querySelectorAll("#teeth-viewer figcaption")].map((one) => one.textContent).join(" | "));
const frames = (count) => new Promise((done) => {
  const next = () => count-- > 0 ? requestAnimationFrame(next) : done();
  next();
});
(async () => {
  const slider = document.querySelector("#teeth-viewer input"), plot = document.querySelector("#viewer canvas");
  await frames(3);
  note("first");
  slider.value = SLIDER;
  slider.dispatchEvent(new Event("input"));
  await frames(3);
  note("slider");
  const box = plot.getBoundingClientRect();
  plot.dispatchEvent(new PointerEvent("pointermove", { clientX: box.right - 4, clientY: box.top + 20 }));
  await frames(3);
  note("cursor");
  const choice = document.querySelector("#teeth-viewer select");
  if (choice) { choice.value = 1; choice.dispatchEvent(new Event("change")); await frames(3); note("other run"); }
  slider.value = 0;
  slider.dispatchEvent(new Event("input"));
  const play = document.querySelector("#teeth-viewer button");
  play.click();
  await frames(12);
  seen.push("playing: " + play.textContent + " " + (slider.value > 0));
  play.click();
  seen.push("stopped: " + play.textContent);
  const mesh = document.querySelector(".mesh"), image = mesh.getContext("2d").getImageData(0, 0, mesh.width,
  mesh.height).data; const colours = new Set();
  for (let i = 0; i < image.length; i += 4) colours.add(image[i] + "," + image[i + 1] + "," + image[i + 2]);
  for (const name of ["--pinion", "--gear"]) {
    const hex = getComputedStyle(document.documentElement).getPropertyValue(name).trim().slice(1);
    seen.push(name + ": " + colours.has([0, 2, 4].map((at) => parseInt(hex.slice(at, at + 2), 16)).join(",")));
  }
  seen.push("wide: " + (document.documentElement.scrollWidth - document.documentElement.clientWidth));
  document.title = JSON.stringify(seen);
})();
</script>"""


@pytest.fixture(scope="module")
def single():
    return gd.simulate(SCENE.replace({"coating.sam_fraction": 0.5}), t_end=0.03, samples=3001)


@pytest.fixture(scope="module")
def swept():
    return gd.sweep(SCENE, {"coating.sam_fraction": [1.0, 0.5]}, t_end=0.004, samples=401)


@pytest.fixture(scope="module")
def specimen():
    scene = gd.preset("teodorescu2009").replace(
        {"contact.roughness": "discrete", "coating.sam_fraction": 0.5}
    )
    return gd.simulate(scene, t_end=4e-5, samples=401)


def rows(run):
    numbers = np.frombuffer(base64.b64decode(run["states"]), dtype="<f4")
    return numbers.reshape(-1, len(FRAME) + run["places"] * len(PAIR))


def test_embedded_states_are_samples_of_the_record(single):
    data = pack_teeth(single, most_states=100)
    (run,) = data["runs"]
    states = rows(run)
    assert run["every"] == 31
    assert 90 < len(states) <= 100
    for at in range(0, len(states), 7):
        time, travelled, u, speed, force = states[at, :5]
        sample = single.isel(time=31 * at)
        # float32 keeps seven digits
        assert time == pytest.approx(sample.time.item(), rel=1e-6, abs=0.0)
        assert (u, speed, force) == pytest.approx(
            (sample.transmission_error.item(), sample.gear_speed.item(), sample.mesh_force.item()),
            rel=1e-6,
            abs=0.0,
        )
        turned = sample.gear_angle.item() * SCENE.geometry.base_radius_gear / SCENE.geometry.base_pitch
        travel = SCENE.initial.mesh_phase + turned
        assert travelled == pytest.approx(
            travel, abs=1e-6
        )  # less than the 76 pitches that bring both gears back
        (state,) = tooth_contacts(single, sample.time.item())
        by_pair = {(contact.pair, contact.flank): contact for contact in state.contacts}
        pairs = states[at, 5:].reshape(run["places"], len(PAIR))
        nearest = pairs[np.isfinite(pairs[:, 0])]
        assert len(nearest)
        assert nearest[:, PAIR.index("gap")].min() == pytest.approx(
            sample.drive_gap.item(), rel=1e-6, abs=0.0
        )
        for pair in nearest:
            contact = by_pair[int(pair[0]), Flank(int(pair[1]))]
            assert pair[PAIR.index("force")] == pytest.approx(contact.force, rel=1e-6, abs=1e-30)
            assert pair[PAIR.index("coated")] == contact.states["coated"]


def test_a_page_holds_no_more_states_than_it_may(swept):
    data = pack_teeth(swept, most_states=120)
    assert [run["label"] for run in data["runs"]] == ["SAM 100 %", "SAM 50 %"]
    assert all(len(rows(run)) <= 60 for run in data["runs"])
    assert np.isnan(rows(data["runs"][0])[:, 5 + PAIR.index("bare")]).all()  # nothing is bare


def test_asperities_of_a_population_are_its_own(specimen):
    """Joined ones are those that the events determine; the tallest of each flank are there, and no flank twice."""
    (run,) = pack_teeth(specimen, most_states=100)["runs"]
    scene = run_scene(specimen)
    joined = np.frombuffer(base64.b64decode(run["joined"]), dtype="<f4").reshape(-1, 2)
    flanks = [
        np.frombuffer(base64.b64decode(row), dtype="<f4").reshape(4, -1).astype(float)
        for row in run["asperities"]
    ]
    assert run["population"]
    assert len({arc.tobytes() for arc, *_ in flanks}) == len(flanks)
    assert len(joined) > 0
    shown = 0
    for state in rows(run):
        (truth,) = tooth_contacts(specimen, float(state[0]))
        contacts = {(contact.pair, contact.flank): contact for contact in truth.contacts}
        for pair in state[len(FRAME) :].reshape(-1, len(PAIR)):
            if np.isnan(pair[0]):
                continue
            numbers = dict(zip(PAIR, pair, strict=True))
            contact = contacts[int(pair[0]), Flank(int(pair[1]))]
            flank = met_flank(scene, contact.pair, contact.flank)
            which = list(contact.asperities)
            mine = joined[int(numbers["joined_from"]) : int(numbers["joined_to"])]
            np.testing.assert_allclose(
                mine, np.stack([flank.arc[which], flank.height[which]], axis=1), rtol=1e-6
            )
            arc, height, radius, material = flanks[int(numbers["row"])]
            tallest = np.argsort(-flank.height)[: arc.size]
            np.testing.assert_allclose([arc, radius], [flank.arc[tallest], flank.radius[tallest]], rtol=1e-6)
            np.testing.assert_array_equal(material, flank.material[tallest])
            assert np.isin(mine[:, 1], height).all()  # what is joined is among what is drawn
            assert numbers["arc"] == pytest.approx(contact_arc(scene, contact.place), rel=1e-6)
            shown += len(which)
    assert shown == len(joined)


def test_a_page_says_why_the_teeth_are_not_shown(single, swept):
    long = single.assign_attrs(wall_time=3600.0)
    assert "the scene must run again, which takes about 60 min" in build_report(long)
    assert 'id="teeth-viewer"' in build_report(long, teeth=True)
    page = build_report(single, teeth=False)
    assert "Teeth in mesh" not in page
    changes = {"coating.sam_fraction": 0.5, "drive.torque": 5e-18}
    other = single.assign_attrs(scene=json.dumps(SCENE.replace(changes).to_dict()))
    page = build_report(other)
    assert 'id="teeth-viewer"' not in page
    assert "cannot be repeated here" in page


def test_rollers_have_no_teeth():
    roller = gd.simulate(gd.preset("roller_slow"), samples=101)
    assert pack_teeth(roller) == {}
    page = build_report(roller)
    assert 'id="teeth-viewer"' not in page
    assert "Teeth in mesh" not in page


def shown_in_browser(page, slider, tmp_path, *options):
    seen = looked_at(page, LOOK.replace("SLIDER", str(slider)), tmp_path, *options)
    return dict(entry.split(": ", 1) for entry in seen)


@pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")
@pytest.mark.parametrize(
    ("kind", "options"),
    [
        ("single", ["--window-size=1200,900"]),
        ("swept", ["--window-size=500,800", "--blink-settings=preferredColorScheme=0"]),
        ("specimen", ["--window-size=500,800"]),
    ],
)
def test_browser_shows_the_teeth(kind, options, request, tmp_path):
    ds = request.getfixturevalue(kind)
    seen = shown_in_browser(build_report(ds), 100, tmp_path, *options)
    assert "error" not in seen
    every = pack_teeth(ds)["runs"][0]["every"]
    run = ds.sel(sam_fraction=1.0) if kind == "swept" else ds
    assert seen["first"].startswith("t = 0 s")
    last = float(ds.time[(ds.sizes["time"] - 1) // every * every])  # the last picture
    for name, time in (("slider", float(ds.time[100 * every])), ("cursor", last)):
        (state,) = tooth_contacts(run, time)
        shown = f"{time * 1e6:#.6g} \N{MICRO SIGN}s" if kind == "specimen" else f"{time * 1e3:#.6g} ms"
        assert seen[name].startswith(f"t = {shown}")
        for contact in state.contacts:
            if contact.flank == Flank.DRIVE and 0 < contact.place < SCENE.geometry.path_length:
                words = f"Pair {contact.pair}, drive flank: gap {contact.gap * 1e9:.4g} nm"
                assert words in seen[name]
    counted = "joined asperities: " if kind == "specimen" else "expected asperities in contact "
    assert counted in seen["slider"]
    if kind == "swept":
        assert "monolayer" not in seen["cursor"]  # one material only
        assert seen["other run"].startswith(seen["cursor"][:16])
    assert seen["playing"] == "Pause true"
    assert seen["stopped"] == "Play"
    assert seen["--pinion"] == seen["--gear"] == "true"
    assert int(seen["wide"]) <= 0  # nothing sticks out to the side


# The first path that is drawn after a move of the slider, which is the pinion, in modules; see `drawNear` of mesh.js.
TRACE = """<script>
const points = [];
let paths = 0;
(async () => {
  const pen = CanvasRenderingContext2D.prototype, begin = pen.beginPath, line = pen.lineTo;
  const mesh = document.querySelector(".mesh");
  pen.beginPath = function () { if (this.canvas === mesh) paths++; begin.call(this); };
  pen.lineTo = function (a, b) {
    if (this.canvas === mesh && paths <= 2) points.push([paths, a, b]);
    line.call(this, a, b);
  };
  const slider = document.querySelector("#teeth-viewer input");
  slider.value = FRAME;
  slider.dispatchEvent(new Event("input"));
  await new Promise((done) => setTimeout(done, 200));
  const size = Math.min(mesh.clientWidth / 9.2, mesh.clientHeight / 3.9);
  const hint = [...document.querySelectorAll("#teeth-viewer .hint")].map((one) => one.textContent).join(" ");
  document.title = JSON.stringify({ hint, points: points.map(
    ([path, a, b]) => [path, (a - mesh.clientWidth / 2) / size, 0.05 - (b - mesh.clientHeight / 2) / size]) });
})();
</script>"""


@pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")
def test_browser_draws_teeth_with_their_errors(tmp_path):
    """Each gear as the picture of `gd.plot.teeth` has it, whose teeth a test of its own compares with their gaps."""
    scene = gd.preset("teodorescu2009").replace({"mesh.pitch_error_rms": "20 nm", "run.samples": 101})
    run = gd.simulate(scene, t_end=1e-4)
    seen = looked_at(build_report(run), TRACE.replace("FRAME", "60"), tmp_path, "--window-size=1200,900")
    factor = enlarged(scene)
    assert factor > 1.0
    assert f"Gaps, and errors of single teeth, \N{MULTIPLICATION SIGN} {factor:g}." in seen["hint"]
    (state,) = tooth_contacts(run, run.time[60].item())
    picture = tooth_outline(scene, gaps=factor, most_play=MOST_PLAY)
    flank = min(state.contacts, key=lambda contact: contact.gap).flank
    angles = picture.turned(state.travel, state.transmission_error, flank)
    for path, (wheel, angle) in enumerate(zip((picture.pinion, picture.gear), angles, strict=True), 1):
        drawn = np.array([point for number, *point in seen["points"] if number == path])
        expected = wheel.outline(angle, 5) / scene.geometry.module
        teeth = 11 * len(wheel.tooth)
        # four digits of a tooth's outline, and float32 of the travel; the largest error is drawn as 0.12 modules
        np.testing.assert_allclose(drawn[:teeth], expected[:teeth], rtol=0.0, atol=2e-4)
