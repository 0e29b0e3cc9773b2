"""The catalogue of faults still fits the code, and faults are caught; ``run.py`` tries them all."""

import pytest

from mutants.catalogue import MUTANTS, SHORT
from mutants.run import ROOT, catch, page


@pytest.mark.parametrize("mutant", MUTANTS, ids=lambda mutant: mutant.what)
def test_a_mutant_changes_what_is_there(mutant):
    assert (ROOT / "src" / "gearidae" / mutant.file).read_text().count(mutant.old) == 1
    assert mutant.new != mutant.old
    for test in mutant.tests:
        assert (ROOT / "tests" / test.partition("::")[0]).exists()


@pytest.mark.parametrize("mutant", SHORT, ids=lambda mutant: mutant.what)
def test_a_fault_is_caught(mutant):
    assert catch(mutant, compiled=False).startswith(mutant.tests[0])


def test_the_page_lists_the_faults_of_the_catalogue():
    text = (ROOT / "docs" / "mutants.md").read_text(encoding="utf-8")
    rows = [line.split(" | ") for line in text.splitlines() if line.startswith("| ")][1:]
    assert [row[0].removeprefix("| ") for row in rows] == [mutant.what for mutant in MUTANTS]
    assert f"**{len(MUTANTS)} faults, 0 not caught.**" in text


def test_a_fault_that_nothing_tests_is_listed():
    text = page({"a": "contact/test_jkr.py::test_x", "b": "not caught"})
    assert "2 faults, 1 not caught" in text
    assert "| b | `not caught` |" in text
