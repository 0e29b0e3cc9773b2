"""A scene with changed keys is the one that is made of all its keys anew; tables that stay are shared."""

from __future__ import annotations

from typing import Any

import pytest

import gearidae as gd
from gearidae.scene import PRESETS, Scene

CHANGES: tuple[dict[str, Any], ...] = (
    {"name": "another"},
    {"run.duration": "2 ms"},
    {"surface.energy": "0.2 J/m^2", "coating.sam_fraction": 0.3},
    {"contact": {"bodies": "rigid"}},
    {},
)
OF_GEARS: tuple[dict[str, Any], ...] = (
    {"drive.harmonic": {"amplitude": 1e-19, "frequency": "1 kHz"}},
    {"load": None},
    {"mesh.static_error": [{"order": 1, "amplitude": 1e-9, "phase": 0.0}], "drive.torque": 1e-17},
)


def tables(scene: Scene) -> dict[str, Any]:
    return dict(scene)


@pytest.mark.parametrize("name", list(PRESETS))
def test_what_is_replaced_is_as_if_all_were_read_anew(name: str) -> None:
    scene = gd.preset(name)
    for changes in CHANGES + (OF_GEARS if scene.roller is None else ()):
        changed = scene.replace(changes)
        again = Scene.from_dict(changed.to_dict())
        assert changed == again
        assert changed.to_dict() == again.to_dict()
        assert hash(changed) == hash(again)
        touched = {key.partition(".")[0] for key in changes}
        for table, content in tables(scene).items():
            if table not in touched:
                assert dict(changed)[table] is content


def test_a_table_that_stays_is_still_held_against_those_that_change() -> None:
    """The start lies within the backlash; a smaller backlash makes it one that does not."""
    scene = gd.preset("teodorescu2009_low_speed").replace({"initial.gap": 36e-9})
    with pytest.raises(gd.SceneError) as refused:
        scene.replace({"mesh.backlash": 1e-9, "surface.roughness": 1e-11})
    assert refused.value.key == "initial.gap"
