from pathlib import Path

import pytest

from gearidae.scene import Scene, preset


@pytest.fixture(scope="session")
def cases() -> Path:
    return Path(__file__).parents[2] / "cases"


@pytest.fixture
def gears() -> Scene:
    return preset("teodorescu2009")


@pytest.fixture
def roller() -> Scene:
    return preset("roller_slow")
