"""The same words of a run, however it is sampled and however tightly it is solved.

The long table, with all cases and up to 0.6 s, is `gearidae_pages.verdict_table`.
"""

from __future__ import annotations

import pytest

import gearidae as gd
from gearidae.analysis.verdict import outcomes

LOW = gd.preset("teodorescu2009_low_speed")
HIGH = gd.preset("teodorescu2009").replace({"run.duration": 2e-4})

SCENES = {
    **{
        f"low {fraction}": LOW.replace({"coating.sam_fraction": fraction})
        for fraction in (1.0, 0.6, 0.5, 0.47, 0.45)
    },
    "high": HIGH,
    "high, bare": HIGH.replace({"coating.sam_fraction": 0.0}),
    "roller": gd.preset("roller_fast").replace({"contact.bodies": "rigid"}),
}


def words_of(scene, **changes):
    (outcome,) = outcomes(gd.simulate(scene.replace({f"run.{key}": value for key, value in changes.items()})))
    return outcome.words, getattr(outcome, "mesh_exits", None), getattr(outcome, "stick_time", None)


@pytest.mark.parametrize("name", SCENES)
def test_samples_have_no_part_in_the_words(name):
    first, *others = (words_of(SCENES[name], samples=samples) for samples in ("off", 5, 301, 30_001))
    for other in others:
        assert repr(other) == repr(first)  # to the last bit; NaN where it has not stuck


@pytest.mark.parametrize("name", SCENES)
def test_the_tolerance_has_no_part_in_the_words(name):
    """A gear sticks within a millisecond of where it does so at 1e-9: the words carry no digit beyond that."""
    loose, usual, tight = (words_of(SCENES[name], samples="off", rtol=rtol) for rtol in (1e-5, 1e-6, 1e-9))
    assert loose[:2] == usual[:2] == tight[:2]
    for other in (loose, usual):
        assert other[2] == pytest.approx(tight[2], abs=5e-4, nan_ok=True)
