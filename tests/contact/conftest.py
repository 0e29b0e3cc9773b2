import pytest

from reference.surface import PlainSurface


@pytest.fixture(scope="session")
def silicon() -> PlainSurface:
    return PlainSurface()


@pytest.fixture(scope="session")
def coated() -> PlainSurface:
    return PlainSurface(energy=0.1)
