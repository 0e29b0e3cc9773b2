"""Options that the commands of several studies have."""

from __future__ import annotations

from typing import Annotated

from gearidae.studies.study import Option

Vary = Annotated[
    list[str],
    Option(
        "Key and its distribution, key=normal(450 nm, 50 nm); truncnormal(mean, deviation, lowest, highest), "
        "uniform(lowest, highest), lognormal(median, geometric deviation); contact.seed=seeds numbers the seeds of a "
        "population; repeatable.",
        repeatable=True,
        completes="keys",
    ),
]
Design = Annotated[str, Option("sobol or random.")]
Seed = Annotated[int, Option("Seed of the design.")]
VARY_EXAMPLE = "drive.torque=normal(4.5e-18, 2e-19)"
"""What errors show of the option ``--vary``."""
