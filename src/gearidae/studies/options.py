"""The option of keys that are drawn from distributions, which several commands have."""

from __future__ import annotations

from typing import Annotated

from gearidae.studies.study import Option

Vary = Annotated[
    list[str],
    Option(
        "Key and its distribution, key=normal(450 nm, 50 nm); truncnormal(mean, deviation, lowest, highest), "
        "uniform(lowest, highest), lognormal(median, geometric deviation); contact.seed=seeds numbers the seeds of a "
        "population, mesh.pitch_error_seed=seeds those of errors of teeth; repeatable.",
        repeatable=True,
        completes="keys",
    ),
]
VARY_EXAMPLE = "drive.torque=normal(4.5e-18, 2e-19)"
"""What errors show of the option ``--vary``."""
