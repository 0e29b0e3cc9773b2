"""The page of the Python API names nothing that is not there."""

from __future__ import annotations

import re
from functools import reduce
from pathlib import Path

import pytest

import gearidae as gd

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "api.md"
NAMES = re.findall(r"^ {3}gearidae\.([\w.]+)$", PAGE.read_text(encoding="utf-8"), flags=re.MULTILINE)


@pytest.mark.parametrize("name", NAMES)
def test_every_name_is_reachable_and_has_words(name):
    member = reduce(getattr, name.split("."), gd)
    assert member.__doc__


def test_the_page_lists_all_that_is_public():
    packages = {
        "analysis",
        "contact",
        "plot",
        "report",
        "scene",
        "studies",
        "surfaces",
        "testing",
        "torques",
        "wear",
    }
    assert packages <= set(gd.__all__)
    assert set(gd.__all__) - packages - {"__version__"} <= set(NAMES)
    for package in ("plot", "studies", "surfaces"):
        listed = {name.rpartition(".")[2] for name in NAMES}
        assert set(getattr(gd, package).__all__) <= listed


def test_all_public_names_load():
    for name in gd.__all__:
        assert getattr(gd, name) is not None
        assert name in dir(gd)
