"""The report: a page that parses, loads nothing, says what is in the archive, and lets nothing in the scene run."""

from __future__ import annotations

import base64
import json
import re
from html.parser import HTMLParser

import numpy as np
import pytest

import gearidae as gd
from gearidae.analysis.verdict import outcomes
from gearidae.cli import main
from gearidae.cli.tables import show_summary
from gearidae.drawing.style import runs_of
from gearidae.records import EventKind
from gearidae.report import build_report, write_report
from gearidae.report import page as report_page
from gearidae.report import series as report_series
from gearidae.report.series import pack
from gearidae.scene.prefixes import with_prefix

VOID = {"meta", "img", "br", "hr", "link", "input"}
NASTY = '</script><script>alert(1)</script><b>"&'


class Page(HTMLParser):
    """Checks that elements are closed in order, and collects what a test asks for."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.open, self.attributes, self.texts, self.scripts = [], [], [], []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.attributes += [(tag, *pair) for pair in attrs]
        if tag == "script":
            self.scripts.append("")
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open and self.open[-1] == "script":
            self.scripts[-1] += data
        else:
            self.texts.append(data)

    @property
    def text(self):
        return " ".join(" ".join(self.texts).split())

    @property
    def data(self):
        return json.loads(next(script for script in self.scripts if script.startswith("{")))


@pytest.fixture(scope="module")
def single():
    scene = gd.preset("teodorescu2009_low_speed").replace({"coating.sam_fraction": 0.5, "name": NASTY})
    return gd.simulate(scene, t_end=0.03, samples=3001)


@pytest.fixture(scope="module")
def swept():
    scene = gd.preset("teodorescu2009_low_speed")
    return gd.sweep(scene, {"coating.sam_fraction": [1.0, 0.5]}, t_end=0.03, samples=3001)


@pytest.fixture(scope="module")
def roller():
    return gd.simulate(gd.preset("roller_slow"), samples=501)


@pytest.fixture(scope="module")
def texts(single, swept, roller):
    """Pages of the datasets, each made once."""
    return {name: build_report(ds) for name, ds in (("single", single), ("swept", swept), ("roller", roller))}


def decoded(text):
    return np.frombuffer(base64.b64decode(text), dtype="<f4")


@pytest.mark.parametrize("kind", ["single", "swept", "roller"])
def test_page_is_whole_and_loads_nothing(kind, texts):
    text = texts[kind]
    page = Page(text)
    for tag, name, value in page.attributes:
        if name in {"src", "href", "xlink:href", "action", "data", "poster", "srcset"}:
            assert value.startswith(("data:", "#")), (tag, name, value[:80])
    assert {tag for tag, *_ in page.attributes}.isdisjoint({"link", "iframe", "object", "embed", "base"})
    assert "@import" not in text
    assert set(re.findall(r"url\((.)", text)) <= {"#"}  # parts of the page itself
    for needed in ("fetch(", "XMLHttpRequest", "import(", "WebSocket", "sendBeacon"):
        assert needed not in text
    assert ("meta", "content", "width=device-width, initial-scale=1") in page.attributes
    policy = next(value for tag, name, value in page.attributes if value and "default-src" in value)
    assert "'none'" in policy
    assert not [value for tag, name, value in page.attributes if name.startswith("on")]
    for heading in ("Outcome", "Time series", "Pictures", "Events", "Parameters", "Provenance"):
        assert heading in page.text


def test_texts_of_the_scene_are_escaped(texts):
    text = texts["single"]
    page = Page(text)
    assert len(page.scripts) == 3  # the data, those of the teeth, and the viewers
    assert "<b>" not in text
    assert "alert(1)</script>" not in text
    assert "alert(1)" in page.text  # shown as what it is


def test_everything_from_a_file_is_escaped(tmp_path):
    """Each text that a page can show, in a file that somebody else has written."""
    path = tmp_path / "nasty.nc"
    words = (
        "title",
        "summary",
        "history",
        "source",
        "message",
        "backend",
        "references",
        "license",
        "product_version",
    )
    scene = gd.preset("teodorescu2009_low_speed").replace({"name": NASTY})
    ds = gd.sweep(scene, {"coating.sam_fraction": [1.0, 0.5]}, t_end=1e-3, samples=11)
    ds = ds.assign_attrs(dict.fromkeys((*words, "date_created", "zipped", "another"), NASTY))
    ds["message"] = ds["message"].copy(data=np.array([NASTY, "plain"], dtype=object))
    ds["status"] = ds["status"].copy(data=np.array([NASTY, "finished"], dtype=object))
    ds["gear_speed"].attrs["long_name"] = NASTY  # another unit is refused
    ds["sam_fraction"].attrs["long_name"] = NASTY
    ds.to_netcdf(path)
    text = build_report(gd.open_archive(path))
    page = Page(text)
    assert len(page.scripts) == 3
    assert "<b>" not in text
    assert "alert(1)</script>" not in text
    assert not [value for tag, name, value in page.attributes if name.startswith("on")]
    assert page.text.count("alert(1)") > len(words)


def test_page_says_what_the_archive_holds(swept, texts):
    page = Page(texts["swept"])
    assert "2 runs" in page.text
    assert "swept: 1, 0.5" in page.text
    assert swept.attrs["source"] in page.text
    assert "asperity_radius 450 nm tip radius" in page.text
    for fraction in (1.0, 0.5):
        of_run = swept.event_kind[swept.event_sam_fraction == fraction]
        turning = int((of_run == EventKind.TURNING_POINT).sum())
        assert f" {turning} " in page.text


def test_embedded_series_are_those_of_the_dataset(single, texts):
    data = Page(texts["single"]).data
    assert data["end"] == single.time[-1]
    assert data["reduced"] == 1
    by_name = {series["name"]: series for series in data["series"]}
    for name in ("gear_speed", "gear_contact_torque", "pairs_in_contact"):
        embedded = decoded(by_name[name]["runs"][0])
        # float32 keeps seven digits
        np.testing.assert_allclose(embedded, single[name].values, rtol=1e-7, atol=0.0)
    onsets = single.event_time.values[single.event_kind.values == EventKind.ONSET]
    np.testing.assert_allclose(data["runs"][0]["onsets"], onsets, rtol=1e-8)


def test_long_series_keep_their_extremes(swept):
    data = pack(swept, most_values=9 * 2 * 200)
    assert data["reduced"] > 1
    for series in data["series"]:
        for fraction, text in zip((0.5, 1.0), series["runs"], strict=True):
            embedded = decoded(text)
            samples = swept[series["name"]].sel(sam_fraction=fraction).values
            assert len(embedded) <= 202
            assert embedded.min() == np.float32(samples.min())
            assert embedded.max() == np.float32(samples.max())


@pytest.fixture(scope="module")
def grid():
    """More runs than a picture shows, and their keys in falling order."""
    over = {"coating.sam_fraction": [1.0, 0.7, 0.5], "mesh.backlash": [3e-7, 2e-7, 1e-7]}
    return gd.sweep(gd.preset("teodorescu2009_low_speed"), over, t_end=0.04, samples=2001, jobs=1)


def test_all_runs_of_a_large_sweep_are_in_the_page(grid):
    data = pack(grid, most_values=12 * 9 * 100)
    dims = data["outcomes"]["dims"]
    assert [dim["values"] for dim in dims] == [["0.5", "0.7", "1"], ["100 nm", "200 nm", "300 nm"]]
    by_name = {series["name"]: series["runs"] for series in data["series"]}
    places = [(fraction, backlash) for fraction in (0.5, 0.7, 1.0) for backlash in (1e-7, 2e-7, 3e-7)]
    for (fraction, backlash), text, run in zip(places, by_name["gear_speed"], data["runs"], strict=True):
        samples = grid.gear_speed.sel(sam_fraction=fraction, backlash=backlash).values
        assert decoded(text).min() == np.float32(samples.min())
        assert decoded(text).max() == np.float32(samples.max())
        assert run["label"] == f"SAM {100 * fraction:g} %, backlash {1e9 * backlash:g} nm"
        mine = (grid.event_sam_fraction == fraction) & (grid.event_backlash == backlash)
        onsets = grid.event_time.values[mine & (grid.event_kind == EventKind.ONSET)]
        np.testing.assert_allclose(run["onsets"], onsets, rtol=1e-8)
    # those of the pictures are drawn first, in their order, which gives them their colours
    shown = [run.label for run in runs_of(grid, "gear_speed")]
    assert [data["runs"][number]["label"] for number in data["chosen"]] == shown
    assert len(shown) == data["most"] == 7


def test_runs_of_a_large_sweep_share_the_numbers(grid, monkeypatch):
    monkeypatch.setattr(report_series, "MOST_OF_MANY", 20_000)
    assert max(len(run["separations"]) for run in pack(grid)["runs"]) >= 1
    monkeypatch.setattr(report_series, "_MOST_OF_ALL", 8)  # fewer than there are runs
    data = pack(grid)
    embedded = sum(decoded(text).size for each in data["series"] for text in each["runs"])
    assert embedded <= 20_000 + 2 * len(data["series"]) * 9  # the last interval of a run need not be full
    assert max(len(run["separations"]) for run in data["runs"]) == 0


def test_teeth_of_a_large_sweep_are_those_of_seven_runs(grid, monkeypatch):
    monkeypatch.setattr(report_page, "_SOON_OF_MANY", 0.0)
    assert "Not shown. For the teeth in mesh" in build_report(grid)
    monkeypatch.setattr(report_page, "_SOON_OF_MANY", 1e9)
    page = Page(build_report(grid))
    assert "7 of 9 runs: the first, the last, and those" in page.text
    teeth = json.loads(next(script for script in page.scripts if script.startswith('{"columns"')))
    labels = [run.label for run in runs_of(grid, "gear_speed")]
    assert [run["label"] for run in teeth["runs"]] == labels


def test_a_part_of_a_sweep_names_what_was_selected(grid, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    gd.save(grid, "grid.nc")
    assert "backlash selected: 200 nm" in Page(build_report(grid.sel(backlash=2e-7))).text
    assert main(["report", "grid.nc", "--select", "backlash=2e-7", "-o", "three.html"]) == 0
    three = Page((tmp_path / "three.html").read_text(encoding="utf-8"))
    assert "3 runs" in three.text
    assert "swept: 1, 0.7, 0.5" in three.text
    one = ["--select", "backlash=2e-7", "--select", "sam_fraction=0.5", "-o", "one.html"]
    assert main(["report", "grid.nc", *one]) == 0
    page = Page((tmp_path / "one.html").read_text(encoding="utf-8"))
    assert "swept:" not in page.text
    assert "coating.sam_fraction 0.5" in page.text
    run = grid.sel(backlash=2e-7, sam_fraction=0.5)
    assert outcomes(run)[0].words in page.text
    by_name = {each["name"]: each["runs"] for each in page.data["series"]}
    np.testing.assert_allclose(decoded(by_name["gear_speed"][0]), run.gear_speed, rtol=1e-7)
    capsys.readouterr()
    assert main(["report", "grid.nc", "--select", "tooth=1", "-o", "no.html"]) == 2
    assert "must be one of sam_fraction, backlash" in capsys.readouterr().err


def test_run_that_ended_early(single):
    cut = single.copy(deep=True)
    cut["gear_speed"][2000:] = np.nan
    data = Page(build_report(cut)).data
    embedded = decoded(data["series"][0]["runs"][0])
    assert np.isnan(embedded[2000:]).all()
    assert np.isfinite(embedded[:2000]).all()


def test_run_summary_in_the_words_of_the_terminal(single, texts, capsys):
    page = Page(texts["single"]).text
    drive_work = single.gearidae.account.drive_work
    assert f"drive work {with_prefix(drive_work, 'J', 5)} input" in page
    show_summary(single)
    printed = [line.strip() for line in capsys.readouterr().out.splitlines()]
    assert {"Run summary", "Energy balance"} <= set(printed)
    for line in printed:
        assert " ".join(line.split()) in page
    assert "Run summary" not in Page(texts["swept"]).text


@pytest.mark.parametrize(
    ("keep", "sections"),
    [
        ([], set()),
        (["samples"], {"series", "teeth"}),
        (["gear_speed", "events"], {"series", "events"}),
        (["events"], {"events"}),
    ],
)
def test_sweep_that_has_not_kept_everything(keep, sections):
    """What is there is shown: outcomes in any case."""
    scene = gd.preset("teodorescu2009_low_speed")
    over = {"coating.sam_fraction": [1.0, 0.5]}
    ds = gd.sweep(scene, over, t_end=2e-3, samples=51, keep=keep)
    page = Page(build_report(ds))
    shown = {value for tag, name, value in page.attributes if tag == "section" and name == "id"}
    assert shown == {"outcome", "pictures", "parameters", "provenance"} | sections
    for outcome in outcomes(ds):
        assert outcome.words in page.text


@pytest.mark.parametrize("preset", ["teodorescu2009_low_speed", "roller_slow"])
def test_run_without_samples(preset):
    ds = gd.simulate(gd.preset(preset).replace({"run.samples": "off"}), t_end=1e-5)
    page = Page(build_report(ds))
    assert outcomes(gd.simulate(gd.preset(preset), t_end=1e-5))[0].words in page.text
    assert "Time series" not in page.text
    assert "Parameters" in page.text


def test_pictures_are_in_the_page(texts):
    page = Page(texts["roller"])
    alternatives = [value for tag, name, value in page.attributes if (tag, name) == ("svg", "aria-label")]
    assert alternatives == ["Contact force and gap of the roller"]
    drawn = re.findall(r"<svg.*?</svg>", texts["roller"], flags=re.DOTALL)
    # every colour is one that both schemes define, and there is no other
    for text in drawn:
        assert not re.search(r"#[0-9a-f]{6}", text)
    used = set(re.findall(r"var\(--c-([0-9a-f]{6})\)", "".join(drawn)))
    assert {"000000", "0072b2"} <= used
    light, dark = re.findall(r":root \{ (--c-.*?) \}", texts["roller"])
    for rules in (light, dark):
        assert used <= set(re.findall(r"--c-([0-9a-f]{6}): #[0-9a-f]{6}", rules))
    assert light != dark


def test_a_page_says_what_a_direct_call_warns_of(single, texts):
    """2 kHz are below twice the frequency of the loaded contact, some 1.8 kHz."""
    coarse = single.isel(time=slice(None, None, 50))
    with pytest.warns(UserWarning, match=r"below twice the frequency .* \(aliasing\)"):
        gd.analysis.power_spectrum(coarse)
    note = "Power spectrum of the gear's speed. Sampling at 2000 Hz is below twice"
    assert note in Page(build_report(coarse)).text
    assert note not in Page(texts["single"]).text


def test_spectra_say_which_lines_may_be_aliases(grid):
    """At 2.5 kHz contacts ring faster than is seen; at 50 kHz none of them does."""
    coarse = grid.isel(time=slice(None, None, 20))
    run = coarse.isel(sam_fraction=0, backlash=0)
    note = gd.analysis.impact_frequencies(run).attrs["note"]
    page = Page(build_report(run, teeth=False)).text
    assert f"Spectrum of the ringing after mesh impacts: not drawn, {note}." in page
    text = build_report(coarse, teeth=False)
    drawn = re.search(r'data-name="power_spectrum".*?</figure>', text, flags=re.DOTALL)[0]
    words = " ".join(re.sub("<[^>]*>", " ", drawn).split())
    assert re.search(r"SAM \d+ %, backlash \d+ nm \(and \d more of the 7 runs shown\): contacts ring", words)
    assert "may be aliases" in words
    assert "may be aliases" not in Page(build_report(grid, teeth=False)).text


def test_parts_of_drawings_are_named_apart(texts):
    """Names hold for the whole page: of two drawings with the same one, one would lose its clipping or its marks."""
    page = Page(texts["swept"])
    names = [value for tag, name, value in page.attributes if name == "id"]
    assert len(names) == len(set(names))
    for _, name, value in page.attributes:
        if name == "xlink:href" and value.startswith("#"):
            assert value[1:] in names
        if name == "clip-path":
            assert value.removeprefix("url(#").removesuffix(")") in names
    figures = [value for tag, name, value in page.attributes if (tag, name) == ("figure", "data-name")]
    assert figures[:2] == ["outcome", "overview"]


def test_numbers_carry_units_with_prefixes(roller, texts):
    page = Page(texts["single"])
    assert "drive.torque 4.5 aN m" in page.text
    assert "gears.pressure_angle 20 deg" in page.text
    assert "surface.asperity_density 169 1/um^2" in page.text
    first = roller.event_time.values[roller.event_kind.values == EventKind.ONSET][0]
    assert f" {with_prefix(first, 's', 6)} " in Page(texts["roller"]).text
    assert not re.search(r"\de-(0\d|1\d|2[0-3]) (N|m|s|J|Hz)\b", page.text)


def test_command(roller, tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    assert main(["run", "roller_slow", "--set", "run.samples=101", "-o", "r.nc"]) == 0
    capfd.readouterr()
    assert main(["report", "r.nc"]) == 0
    assert capfd.readouterr().out == "Report: r.html\n"
    assert main(["report", "r.nc"]) == 0  # a page of its own
    (tmp_path / "r.html").write_text("mine")
    capfd.readouterr()
    assert main(["report", "r.nc"]) == 2
    assert re.search(r"gearidae: report = r.html: exists already", capfd.readouterr().err)
    assert main(["report", "r.nc", "-o", "r.html", "--overwrite"]) == 0
    assert main(["report", "r.nc", "-o", "nowhere/r.html"]) == 2
    assert sorted(path.name for path in tmp_path.iterdir()) == ["r.html", "r.nc"]


def test_nothing_is_replaced_unasked(roller, tmp_path):
    target = tmp_path / "page.html"
    target.write_text("mine")
    with pytest.raises(gd.SceneError, match="exists already"):
        write_report(roller, target)
    assert target.read_text() == "mine"
    assert write_report(roller, target, overwrite=True) == target
    assert "rebounds" in target.read_text(encoding="utf-8")


def test_a_running_mean_has_a_report_without_the_teeth(single, texts):
    """Its first samples are missing; where another one is, it is not compared with the run that is repeated."""
    assert '<div id="teeth-viewer">' in texts["single"]
    assert '<div id="teeth-viewer">' not in build_report(single.rolling(time=5).mean())
    ds = single.copy(deep=True)
    ds["gear_angle"][2000:2020] = np.nan
    assert "cannot be repeated here" in build_report(ds)
