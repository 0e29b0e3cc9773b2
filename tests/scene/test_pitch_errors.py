"""Errors of single teeth in a scene: lists, files, draws, and what is refused."""

import json

import numpy as np
import pytest

import gearidae as gd
from gearidae.errors import SceneError
from gearidae.scene import Scene, dump_case, load_case

SCENE = gd.preset("teodorescu2009")
PINION = [float(k) * 1e-9 for k in range(-9, 10)]


def test_drawn_errors_are_those_of_the_seed():
    scene = SCENE.replace({"mesh.pitch_error_rms": "10 nm", "mesh.pitch_error_seed": 7})
    drawn = gd.pitch_errors(scene)
    for side, (name, teeth) in enumerate((("pinion", 19), ("gear", 76))):
        expected = np.random.default_rng([7, side]).standard_normal(teeth) * 10e-9 / np.sqrt(2.0)
        np.testing.assert_allclose(drawn[f"{name}_pitch_error"], expected, rtol=1e-15)
        assert drawn[f"{name}_pitch_error"].attrs["units"] == "m"
    assert drawn.attrs["meshes_to_meet"] == 76


def test_drawn_errors_have_the_rms_of_the_sum():
    scene = SCENE.replace({"mesh.pitch_error_rms": "10 nm"})
    sums = []
    for seed in range(200):
        drawn = gd.pitch_errors(scene.replace({"mesh.pitch_error_seed": seed}))
        sums.append(drawn.pinion_pitch_error.values[:, None] + drawn.gear_pitch_error.values)
    assert np.std(sums) == pytest.approx(10e-9, rel=0.03)  # of 19,000 independent numbers


def test_errors_that_are_not_given_are_zero():
    listed = gd.pitch_errors(SCENE.replace({"mesh.pinion_pitch_error": PINION}))
    np.testing.assert_array_equal(listed.pinion_pitch_error, PINION)
    assert not listed.gear_pitch_error.any()
    assert not gd.pitch_errors(SCENE).pinion_pitch_error.any()


@pytest.mark.parametrize(
    "text",
    [
        "error [nm]\n" + "\n".join(f"{e * 1e9:g}" for e in PINION) + "\n",
        "tooth,error [nm],remark\n" + "\n".join(f"{k},{e * 1e9:g},0" for k, e in enumerate(PINION)) + "\n",
        "step (um)\n" + "\n".join(f"{e * 1e6:g}" for e in PINION) + "\n",
    ],
)
def test_a_file_beside_the_case(tmp_path, monkeypatch, text):
    (tmp_path / "teeth.csv").write_text(text)
    case = dump_case(SCENE).replace("[mesh]", '[mesh]\npinion_pitch_error = { file = "teeth.csv" }', 1)
    (tmp_path / "case.toml").write_text(case)
    monkeypatch.chdir("/")
    assert load_case(tmp_path / "case.toml").mesh.pinion_pitch_error == pytest.approx(PINION, rel=1e-12)


def test_numbers_with_units():
    texts = [f"{e * 1e9:g} nm" for e in PINION]
    assert SCENE.replace({"mesh.pinion_pitch_error": texts}).mesh.pinion_pitch_error == pytest.approx(PINION)
    array = np.array(PINION)
    assert SCENE.replace({"mesh.pinion_pitch_error": array}).mesh.pinion_pitch_error == tuple(PINION)


def test_errors_travel_with_their_scene(tmp_path):
    scene = SCENE.replace(
        {
            "mesh.pinion_pitch_error": PINION,
            "mesh.pinion_runout": {"amplitude": "50 nm", "phase": 0.5},
            "mesh.gear_runout": {"amplitude": "60 nm"},
        }
    )
    assert Scene.from_dict(json.loads(json.dumps(scene.to_dict()))) == scene
    (tmp_path / "case.toml").write_text(dump_case(scene))
    assert load_case(tmp_path / "case.toml") == scene
    assert "19 teeth, -9 nm to 9 nm" in repr(scene)
    gone = {"mesh.pinion_pitch_error": [], "mesh.pinion_runout": None, "mesh.gear_runout": None}
    assert scene.replace(gone) == SCENE
    assert scene.replace({"mesh.gear_runout.phase": 1.0}).mesh.gear_runout.phase == 1.0


@pytest.mark.parametrize(
    ("changes", "key", "message"),
    [
        (
            {"mesh.pinion_pitch_error": [1e-9] * 18},
            "mesh.pinion_pitch_error",
            "must have 19, one for each tooth",
        ),
        ({"mesh.gear_pitch_error": [1e-9] * 19}, "mesh.gear_pitch_error", "must have 76"),
        ({"mesh.gear_pitch_error": [0.3e-6] * 76}, "mesh.gear_pitch_error", "at most the backlash, 2e-07 m"),
        ({"mesh.pinion_pitch_error": 3.0}, "mesh.pinion_pitch_error", "must be a list of errors"),
        ({"mesh.pinion_pitch_error": {"data": 3}}, "mesh.pinion_pitch_error", "must be a list of errors"),
        ({"mesh.pinion_pitch_error": ["1 s"] * 19}, "mesh.pinion_pitch_error[0]", "unit"),
        ({"mesh.pinion_pitch_error": {"file": "none.csv"}}, "mesh.pinion_pitch_error", "none.csv"),
        (
            {"mesh.pinion_pitch_error": PINION, "mesh.pitch_error_rms": 1e-9},
            "mesh.pitch_error_rms",
            "cannot be given beside pinion_pitch_error",
        ),
        (
            {"mesh.pitch_error_rms": 1e-7, "mesh.pitch_error_seed": 1},
            "mesh.pitch_error_rms",
            "backlash, 2e-07 m",
        ),
        ({"mesh.pitch_error_rms": -1e-9}, "mesh.pitch_error_rms", "0..1"),
        ({"mesh.pinion_runout": {"phase": 1.0}}, "mesh.pinion_runout.amplitude", "required"),
        ({"mesh.gear_runout": {"amplitude": 2e-4}}, "mesh.gear_runout.amplitude", "must be below R2"),
        ({"mesh.pinion_runout": {"amplitude": -4e-5}}, "mesh.pinion_runout.amplitude", "must be below R1"),
    ],
)
def test_errors_that_are_refused(changes, key, message):
    with pytest.raises(SceneError) as refused:
        SCENE.replace(changes)
    assert refused.value.key == key
    assert message in str(refused.value)


def test_teeth_that_jam_are_refused_with_both_numbers():
    """The largest sum of two teeth that meet less the smallest leaves no play: 2b is 200 nm."""
    pinion, gear = [95e-9, -60e-9, *[0.0] * 17], [50e-9, *[0.0] * 75]
    with pytest.raises(SceneError, match=r"2.05e-07 m.*jam.*2e-07 m") as refused:
        SCENE.replace({"mesh.pinion_pitch_error": pinion, "mesh.gear_pitch_error": gear})
    assert refused.value.key == "mesh.pinion_pitch_error"
    # tooth 0 of the pinion never meets tooth 1 of the gear, of four times as many teeth, nor its back tooth 3
    SCENE.replace(
        {"mesh.pinion_pitch_error": pinion, "mesh.gear_pitch_error": [0.0, 0.0, 0.0, 50e-9, *[0.0] * 72]}
    )


def test_a_file_needs_its_unit_and_its_column(tmp_path):
    (tmp_path / "bare.csv").write_text("error\n" + "1\n" * 19)
    with pytest.raises(SceneError, match=r"the file bare.csv: .*unit"):
        SCENE.replace({"mesh.pinion_pitch_error": {"file": str(tmp_path / "bare.csv")}})
    (tmp_path / "two.csv").write_text("a [nm],b [nm]\n" + "1,2\n" * 19)
    with pytest.raises(SceneError, match="column 'error'"):
        SCENE.replace({"mesh.pinion_pitch_error": {"file": str(tmp_path / "two.csv")}})


def test_errors_need_gears():
    with pytest.raises(SceneError, match="must be a scene with gears"):
        gd.pitch_errors(gd.preset("roller_slow"))
