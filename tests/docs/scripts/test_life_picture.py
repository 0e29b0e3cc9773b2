"""The picture of a life on its page is that of the life that its text describes."""

import numpy as np
import pytest

import gearidae as gd
from gearidae_pages.life_picture import follow, shown


@pytest.mark.by_hand  # scripts of pages change hardly ever
def test_a_short_life_is_followed_assessed_and_told():
    scene = gd.preset("teodorescu2009_low_speed").replace({"coating.sam_fraction": 0.7})
    seen = follow(scene, np.linspace(0.66, 0.74, 5), fraction=0.69)
    answer = shown(seen)
    assert "ends: coverage" in answer
    assert f"assessments: {seen.sizes['passages']}, clear: " in answer
    late = seen.isel(passages=-1)
    assert float(late.assessed_low) <= float(late.coverage.mean()) <= float(late.assessed_high)
