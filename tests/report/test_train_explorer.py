"""The page to look through runs of trains: what it holds is what was recorded, and a browser shows it."""

from __future__ import annotations

import base64
import math

import numpy as np
import pytest
from tests.reference.trains import chain, compound
from tests.report.test_explorer import LOOK

import gearidae as gd
from gearidae.analysis.verdict import outcomes
from gearidae.archive.select import run_scene
from gearidae.cli import main
from gearidae.plot.train_view import placed_gears
from gearidae.report import build_explorer
from gearidae.report.explorer import pack_explorer
from gearidae.scene import Scene
from reference.browser import CHROMIUM, looked_at

OF_SHAFTS = ("shaft_angle", "shaft_speed", "hub_load", "hub_load_angle")

# What the browser draws of each gear, as paths about its own centre that are turned and moved: their transforms.
DRAWN = """<script>
const fill = CanvasRenderingContext2D.prototype.fill, drawn = [];
let looking = false;
CanvasRenderingContext2D.prototype.fill = function (path) {
  const at = this.getTransform();
  if (looking && path instanceof Path2D) drawn.push([at.a, at.b, at.c, at.d, at.e, at.f]);
  return path ? fill.call(this, path) : fill.call(this);
};
setTimeout(() => {
  const slider = document.querySelector("#explorer .controls input");
  const select = document.querySelector("#explorer select");
  slider.value = FRAME;
  slider.dispatchEvent(new Event("input"));
  select.selectedIndex = MESH;
  looking = true;
  select.dispatchEvent(new Event("change"));
  setTimeout(() => {
    const canvas = document.querySelector("#explorer .train canvas"), pen = canvas.getContext("2d");
    const rows = [...document.querySelectorAll("#explorer .values tbody tr")].map((row) => row.textContent);
    document.title = JSON.stringify({ drawn, rows, width: canvas.clientWidth, height: canvas.clientHeight });
  }, 300);
}, 300);
</script>"""


@pytest.fixture(scope="module")
def swept():
    scene = Scene.from_dict(chain(hubs=0.3))
    return gd.sweep(scene, {"mesh.backlash": [3e-7, 2e-7]}, t_end=60e-6, samples=601, jobs=1)


@pytest.fixture(scope="module")
def three():
    return gd.simulate(Scene.from_dict(compound()), t_end=60e-6, samples=601)


def decoded(text):
    return np.frombuffer(base64.b64decode(text), dtype="<f4")


def test_pictures_are_samples_of_the_record(swept):
    shafts, meshes = swept.sizes["shaft"], swept.sizes["mesh"]
    columns = 4 * shafts + 2 * meshes
    data = pack_explorer(swept, most_values=2 * 100 * (columns + 2 * (2 * shafts + meshes)))
    assert (data["every"], data["frames"]) == (7, 86)
    assert data["dims"][0]["values"] == ["200 nm", "300 nm"]
    for number, backlash in enumerate((2e-7, 3e-7)):
        run = swept.sel(backlash=backlash)
        seen = run.isel(time=slice(None, None, 7))
        frames = decoded(data["runs"][number]["frames"]).reshape(-1, columns)
        for place, name in enumerate(OF_SHAFTS):
            shown = frames[:, place * shafts : (place + 1) * shafts]
            recorded = seen[name].transpose("time", "shaft").values
            if name == "shaft_angle":  # of one turn
                shown, recorded = np.exp(1j * shown), np.exp(1j * recorded)
            np.testing.assert_allclose(shown, recorded, rtol=3e-7)  # float32 keeps seven digits
        forces, pairs = frames[:, -2 * meshes : -meshes], frames[:, -meshes:]
        np.testing.assert_allclose(forces, seen["mesh_force"].T, rtol=1.2e-7)
        np.testing.assert_array_equal(pairs, seen["pairs_in_contact"].T)
        loads = [decoded(text) for text in data["runs"][number]["curves"][-shafts:]]
        # curves keep the extremes of what lies between
        assert [load.max() for load in loads] == [np.float32(load.max()) for load in run["hub_load"].values]
    assert data["largest"] <= float(swept["hub_load"].max()) * (1.0 + 1e-12)
    assert [look["word"] for look in data["looks"]] == list(
        dict.fromkeys(one.verdict for one in outcomes(swept))
    )


def test_speeds_are_comparable_by_their_ratios(three):
    """Shafts that turn by their ratios have one curve."""
    data = pack_explorer(three)
    speeds = [decoded(text) for text in data["runs"][0]["curves"][: three.sizes["shaft"]]]
    for speed, own, ratio in zip(
        speeds, three["shaft_speed"].values, three["shaft_ratio"].values, strict=True
    ):
        np.testing.assert_allclose(speed, own / ratio, rtol=1e-6)
    assert data["ranges"][0][1] == pytest.approx(
        float((three["shaft_speed"] / three["shaft_ratio"]).max()), rel=1e-6
    )


def in_words(speed):
    """A speed as a script writes it, to four digits."""
    return f"{float(f'{float(speed):.4g}'):g} rad/s"


def outline_of(wheel):
    """The whole gear about its centre, as train.js puts it together from one tooth [um]."""
    tooth = np.reshape(wheel["tooth"], (-1, 2)) @ np.array([1.0, 1.0j])
    return np.concatenate([tooth * np.exp(1j * wheel["step"] * k) for k in range(wheel["teeth"])])


def test_gears_are_those_of_the_picture(three):
    (gears,) = pack_explorer(three)["gears"]
    placed = placed_gears(three)
    assert len(gears["wheels"]) == len(placed) == 6
    for wheel, gear in zip(gears["wheels"], placed, strict=True):
        whole = outline_of(wheel) + complex(*wheel["centre"])
        picture = 1e6 * gear.outline(0.0) @ np.array([1.0, 1.0j])
        # lengths are given to 0.1 nm
        np.testing.assert_allclose(whole, picture, atol=3e-4)
    for pitch, mesh in zip(gears["pitches"], run_scene(three).train.meshes, strict=True):
        assert [placed[number].name for number in pitch["wheels"]] == [mesh.driver, mesh.driven]


def test_a_part_of_the_time_has_the_same_gears(three):
    """Teeth stand where the angles say, whatever sample is the first."""
    whole, part = pack_explorer(three), pack_explorer(three.isel(time=slice(300, None)))
    assert part["gears"] == whole["gears"]
    assert part["start"] == float(three["time"][300])


def test_what_trains_do_not_have_is_refused(three, tmp_path):
    with pytest.raises(gd.SceneError, match="none of single pairs of teeth"):
        gd.explore(three, tmp_path / "teeth.html", teeth=True)
    with pytest.raises(gd.SceneError, match="hub_load"):
        gd.explore(three.drop_vars("hub_load"), tmp_path / "loads.html")
    with pytest.raises(gd.SceneError, match="no run has samples"):
        gd.explore(three.sel(time=slice(1.0, 2.0)), tmp_path / "later.html")
    assert not list(tmp_path.iterdir())


def test_command(three, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    gd.save(three, "three.nc")
    assert main(["explore", "three.nc", "--from", "20 us"]) == 0
    assert "Page: three_explore.html" in capsys.readouterr().out
    assert main(["explore", "three.nc", "--teeth", "-o", "teeth.html"]) == 2


@pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")
@pytest.mark.parametrize(
    "options", [["--window-size=1200,900"], ["--window-size=500,800"]], ids=["desktop", "phone"]
)
def test_browser_goes_through_runs_and_time(swept, options, tmp_path):
    seen = looked_at(build_explorer(swept), LOOK, tmp_path, *options)
    assert seen["errors"] == []
    judged = swept.attrs["judged_shaft"]
    for name, backlash, time in (
        ("first", 2e-7, 0),
        ("end", 2e-7, -1),
        ("last", 3e-7, -1),
        ("clicked", 2e-7, -1),
    ):
        sample = swept.sel(backlash=backlash).isel(time=time)
        assert f"{judged} {in_words(sample.gear_speed)}" in seen[name]["words"]
        assert seen[name]["values"] == [f"{backlash * 1e9:.3g} nm"]
    assert seen["first"]["picture"] != seen["end"]["picture"]
    assert seen["half"] == pytest.approx(300, abs=2)  # a pixel of some 400
    assert seen["playing"] == "Pause true"
    assert seen["wide"] <= 0


@pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")
@pytest.mark.parametrize("mesh", [0, 2], ids=["whole", "mesh"])
def test_browser_turns_and_places_gears_as_recorded(three, mesh, tmp_path):
    page = build_explorer(three)
    script = DRAWN.replace("FRAME", "400").replace("MESH", str(mesh))
    seen = looked_at(page, script, tmp_path, "--window-size=1200,900")
    state = three.isel(time=400)
    placed = placed_gears(three)
    pitch = pack_explorer(three)["gears"][0]["pitches"][1]
    shown = [placed[number] for number in sorted(pitch["wheels"])] if mesh else list(placed)
    drawn = seen["drawn"][-2 * len(shown) :: 2]  # each is filled twice
    size = math.hypot(drawn[0][0], drawn[0][1])
    centres = np.array([complex(*transform[4:]) for transform in drawn])
    for gear, transform, centre in zip(shown, drawn, centres, strict=True):
        # y points down on the screen
        turned = math.atan2(-transform[1], transform[0])
        angle = gear.sense * float(state["shaft_angle"][gear.shaft])
        assert math.remainder(turned - angle, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-5), gear.name
        apart = 1e6 * (gear.centre - shown[0].centre)
        assert centre - centres[0] == pytest.approx(size * complex(apart[0], -apart[1]), abs=1e-2)
    if mesh:
        middle = centres[0] + size * complex(*(np.array([1, -1]) * (pitch["at"] - 1e6 * shown[0].centre)))
        assert middle == pytest.approx(0.5 * complex(seen["width"], seen["height"]), abs=0.5)
    for row, name in zip(seen["rows"], three["shaft"].values, strict=False):
        assert row.startswith(name + in_words(state["shaft_speed"].sel(shaft=name)))
