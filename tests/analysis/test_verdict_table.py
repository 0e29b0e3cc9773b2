"""Verdicts as a table in a notebook."""

from __future__ import annotations

import math
from dataclasses import replace

from gearidae.analysis.verdict import GearOutcome, RollerOutcome
from gearidae.analysis.verdict.table import Outcomes

STUCK = GearOutcome({"sam_fraction": 0.47}, "finished", "sticks", -1.0, 1.5, 4, 0.1, 0.258, 5, 0.3)
TURNED = GearOutcome({"sam_fraction": 1.0}, "finished", "turns smoothly", 1.4, 1.5, 5, 0.01, math.nan, 6, 0.3)


def test_one_row_a_run_with_units_and_words():
    shown = Outcomes([TURNED, STUCK])._repr_html_()
    assert shown.count("<tr>") == 3
    for text in (
        "<th>sam_fraction</th>",
        "<td>0.47</td>",
        "sticks at 0.258 s (5 mesh exits)",
        "<td>258 ms</td>",
    ):
        assert text in shown
    assert "<td>-</td>" in shown  # has not come to stand
    assert "nan" not in shown


def test_a_single_outcome_and_a_roller():
    roller = RollerOutcome({}, "finished", "rebounds", 16.68e-6, 1.257e-6, 0.4249, 1, 0.04)
    assert "<td>16.68 uN</td><td>1.257 uN</td><td>0.4249</td>" in roller._repr_html_()
    assert Outcomes([])._repr_html_() == "<table></table>"


def test_what_stands_in_a_label_is_escaped():
    odd = GearOutcome({"<b>": "<i>"}, "finished", "sticks", -1.0, 1.5, 4, 0.1, 0.258, 5, 0.3)
    assert "<b>" not in odd._repr_html_()
    assert "<i>" not in odd._repr_html_()


def test_an_energy_balance_that_does_not_close_is_said_beside_the_verdict():
    sound, wrong = replace(STUCK, imbalance=0.99), replace(STUCK, imbalance=101.3)
    assert sound.words == STUCK.words == "sticks at 0.258 s (5 mesh exits)"
    assert wrong.words == f"{STUCK.words}, energy balance out by 1e+02 times its bound"
    roller = RollerOutcome({}, "finished", "rebounds", 1e-6, 1e-6, 0.4, 1, 0.04, imbalance=3.0)
    assert roller.words == "rebounds, energy balance out by 3 times its bound"
