"""The search of the documentation: a word of the index leads to its page before all others.

Sphinx gives a page 100 points for an entry of the index that is the query, if it is a main one, and at most 16 for
titles, objects and words of the text. So the pages with that entry come first, in any order: of three, each is among
the first three.
"""

from __future__ import annotations

import re
from collections import defaultdict
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"


def main_entries():
    """Pages by the main entries of their index; each term of the glossary is one."""
    pages = defaultdict(set)
    for page in DOCS.glob("*.md"):
        for line in re.findall(r"^```\{index\} (.+)$", page.read_text(encoding="utf-8"), flags=re.MULTILINE):
            for entry in line.split(","):
                assert entry.strip().startswith("! "), f"{page.name}: {entry}"
                pages[entry.strip().removeprefix("! ").lower()].add(page.stem)
    glossary = (DOCS / "glossary.md").read_text(encoding="utf-8")
    for block in re.findall(r"```\{glossary\}\n(.*?)```", glossary, flags=re.DOTALL):
        for term in re.findall(r"^(\S.*)$", block, flags=re.MULTILINE):
            pages[term.lower()].add("glossary")
    return pages


@pytest.mark.parametrize(
    ("words", "page"),
    [
        ("stiction", "howto_friction"),
        ("stiction", "verdicts"),
        ("lifetime", "howto_life"),
        ("wear", "howto_life"),
        ("gear life", "howto_life"),
        ("reliability", "howto_life"),
        ("windows", "support"),
        ("csv export", "howto_results"),
        ("colormap", "howto_report"),
        ("backlash", "howto_geometry"),
        ("mesh exit", "verdicts"),
        ("verdict", "verdicts"),
        ("humidity", "howto_humid_air"),
    ],
)
def test_a_search_finds_the_page_among_the_first_three(words, page):
    found = main_entries()[words]
    assert page in found
    assert len(found) <= 3, found


def test_the_index_has_its_place_below_the_title():
    for page in DOCS.glob("*.md"):
        text = page.read_text(encoding="utf-8")
        if "```{index}" in text:
            assert re.match(r"# .+\n\n```\{index\} .+\n```\n\n", text), page.name
