"""Verdicts of all shipped cases and of the README's fractions at several tolerances and numbers of samples.

``python -m gearidae_pages.verdict_table`` prints a table in Markdown, some minutes' work. Exit code 1 if the words of a
scene differ. ``docs/verdicts.md`` has its result.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from pathlib import Path

import gearidae as gd
from gearidae.analysis.verdict import outcomes
from gearidae.scene import Scene, is_long_train

__all__ = ["main", "scenes", "verdicts"]

CASES = Path(__file__).parents[3] / "cases"
FRACTIONS = (1.0, 0.8, 0.6, 0.55, 0.5, 0.47, 0.45)
TOLERANCES = (1e-5, 1e-6, 1e-7, 1e-8, 1e-9)
SAMPLES = ("off", 5, 301, 30_001)


def scenes() -> Iterator[tuple[str, Scene]]:
    """Name the scenes: every case, the high-speed one without coating, and the README's fractions for 0.3 and 0.6 s."""
    for path in sorted(CASES.glob("*.toml")):
        scene = gd.load_case(path)
        if path.stem != "low_speed" and not is_long_train(scene):  # whose verdicts rest on samples
            yield path.stem, scene
    yield "high_speed, bare", gd.load_case(CASES / "high_speed.toml").replace({"coating.sam_fraction": 0.0})
    low = gd.load_case(CASES / "low_speed.toml")
    for duration in (0.3, 0.6):
        for fraction in FRACTIONS:
            changes = {"coating.sam_fraction": fraction, "run.duration": duration}
            yield f"low_speed, SAM {100 * fraction:g} %, {duration:g} s", low.replace(changes)


def verdicts(scene: Scene) -> tuple[set[str], list[float]]:
    """Words said of a scene at all tolerances and samplings, and the times of sticking at all tolerances [s]."""
    words, times = set(), []
    for rtol in TOLERANCES:
        for samples in SAMPLES if rtol == scene.run.rtol else SAMPLES[:1]:
            (outcome,) = outcomes(gd.simulate(scene.replace({"run.rtol": rtol, "run.samples": samples})))
            words.add(outcome.words)
        times.append(getattr(outcome, "stick_time", math.nan))
    return words, times


def main() -> int:
    """Print the table."""
    differ = False
    print("| scene | words | spread of the time |\n|---|---|---|")  # noqa: T201
    for name, scene in scenes():
        words, times = verdicts(scene)
        spread = f"{max(times) - min(times):.1e} s" if not math.isnan(sum(times)) else ""
        print(f"| {name} | {' / '.join(sorted(words))} | {spread} |", flush=True)  # noqa: T201
        differ |= len(words) > 1
    return int(differ)


if __name__ == "__main__":
    sys.exit(main())
