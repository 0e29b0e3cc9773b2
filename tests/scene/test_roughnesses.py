"""Gaps given in roughnesses: they follow the roughness, and come back as they were given."""

import copy
import pickle

import pytest

from gearidae.errors import SceneError
from gearidae.scene import Scene, dump_case, load_case, preset

LOW = preset("teodorescu2009_low_speed")


def gap(scene: Scene) -> float:
    assert scene.initial is not None
    return float(scene.initial.gap)


def test_six_roughnesses_are_the_float_of_36_nm() -> None:
    assert gap(LOW) == 36e-9
    assert LOW.to_dict()["initial"]["gap"] == "6 sigma"


def test_gap_follows_the_roughness() -> None:
    rough = LOW.replace({"surface.roughness": "4.5 nm"})
    assert gap(rough) == 27e-9
    assert gap(LOW) == 36e-9  # the table of the other scene is not touched
    assert gap(rough.replace({"surface.roughness": 6e-9})) == 36e-9
    both = LOW.replace({"surface.roughness": 7e-9, "initial.gap": "5.5 sigma"})
    assert gap(both) == 38.5e-9
    assert gap(both.replace({"initial.gap": 3e-8}).replace({"surface.roughness": 6e-9})) == 3e-8


@pytest.mark.parametrize("text", ["6 sigma", "6.25sigma", "-1.5 sigma", "1e1 sigma", "0 sigma"])
def test_it_comes_back_as_it_was_given(text: str, tmp_path: pytest.TempPathFactory) -> None:
    scene = LOW.replace({"initial.gap": text, "surface.roughness": 7.3e-9})
    path = tmp_path / "case.toml"  # type: ignore[operator]
    path.write_text(dump_case(scene))
    copies = (
        Scene.from_dict(scene.to_dict()),
        load_case(path),
        pickle.loads(pickle.dumps(scene)),
        copy.deepcopy(scene),
    )
    for again in copies:
        assert again == scene
        assert again.to_dict() == scene.to_dict()
        assert gap(again.replace({"surface.roughness": 1e-9})) == gap(
            scene.replace({"surface.roughness": 1e-9})
        )


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("six sigma", "must be a number in m or a text with a unit, or in roughnesses"),
        ("nan sigma", "must be a finite number"),
        ("1e999 sigma", "must be a finite number"),
        ("100 sigma", "flanks would overlap"),
        ("6 sigma um", "does not fit"),
    ],
)
def test_what_is_none_is_refused(text: str, words: str) -> None:
    with pytest.raises(SceneError, match=words) as refused:
        LOW.replace({"initial.gap": text})
    assert refused.value.key == "initial.gap"


def test_other_lengths_are_no_numbers_of_roughnesses() -> None:
    with pytest.raises(SceneError):
        LOW.replace({"mesh.backlash": "6 sigma"})
