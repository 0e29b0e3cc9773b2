"""Options that the commands of several studies have."""

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
Design = Annotated[str, Option("sobol or random.")]
Seed = Annotated[int, Option("Seed of the design.")]
VARY_EXAMPLE = "drive.torque=normal(4.5e-18, 2e-19)"
"""What errors show of the option ``--vary``."""

Law = Annotated[str, Option("Loss law: contacts, adhesion_work, sliding_work or friction_work.")]
_PARAMETER = Option("Parameter of the law, such as energy='2 J/m^2'; repeatable.", repeatable=True)
LawParameters = Annotated[list[str], _PARAMETER]
OtherParameters = Annotated[list[str] | None, _PARAMETER]
Arrhenius = Annotated[
    list[str] | None,
    Option(
        "Factor of Arrhenius: activation_energy, activation_volume and temperature; repeatable.",
        repeatable=True,
    ),
]
Passages = Annotated[float, Option("Passages of each tooth of the pinion at most.")]
Fraction = Annotated[float, Option("Mean coverage at which the life ends.")]
Resolved = Annotated[str, Option("Coverage: uniform, by place, or by tooth and place.")]
Tolerance = Annotated[float, Option("Relative tolerance of each jump, and of the rates.")]
