"""An assessment of the coating as a table in a notebook."""

from __future__ import annotations

import html
import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from gearidae.scene.prefixes import with_prefix

if TYPE_CHECKING:
    from gearidae.analysis.assessment import Assessment


def assessment_table(found: Assessment) -> str:
    """Write an assessment as HTML, without colours of its own, so that it can be read on any background.

    Returns
    -------
    str
        Verdict and explanation, then what is known of fraction, interval, torque, speed and frequencies.
    """
    rows = "".join(
        f"<tr><th style='text-align: left'>{html.escape(name)}</th>"
        f"<td style='text-align: left'>{html.escape(text)}</td></tr>"
        for name, text in _rows(found)
    )
    caption = f"<b>{html.escape(found.verdict)}</b>: {html.escape(found.explanation)}"
    return f"<table><caption style='text-align: left'>{caption}</caption>{rows}</table>"


def _rows(found: Assessment) -> Iterator[tuple[str, str]]:
    if not math.isnan(found.sam_fraction):
        yield "SAM fraction", f"{found.sam_fraction:.4g}"
    if not math.isnan(found.low):
        yield "95 % interval", f"{found.low:.4g} to {found.high:.4g}"
    yield (
        "record begins",
        {"start": "with the start of the map's runs"}.get(found.history, "at a time not known"),
    )
    if not math.isnan(found.gear_speed):
        yield "median gear speed", f"{found.gear_speed:.4g} rad/s"
    if not math.isnan(found.torque):
        yield "estimated drive torque", with_prefix(found.torque, "N m", 4)
    frequencies = [with_prefix(each, "Hz", 4) for each in found.frequencies]  # "-" where nothing stands out
    if found.reading:
        yield "record read with", found.reading
    yield "impact responses", ", ".join(frequencies) or "none"
