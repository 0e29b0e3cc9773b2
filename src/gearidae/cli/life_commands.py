"""The commands on the life of a coating."""

from __future__ import annotations

from typing import Annotated

from cyclopts import Parameter

from gearidae.cli.app import Case, app
from gearidae.cli.study_commands import USUAL, Design, Seed, Usual, Vary

Law = Annotated[str, Parameter(help="Loss law: contacts, adhesion_work, sliding_work or friction_work.")]
_PARAMETER = Parameter(
    name="--parameter",
    help="Parameter of the law, such as energy='2 J/m^2'; repeatable.",
    consume_multiple=False,
)
LawParameters = Annotated[list[str], _PARAMETER]
OtherParameters = Annotated[list[str] | None, _PARAMETER]
Arrhenius = Annotated[
    list[str] | None,
    Parameter(
        help="Factor of Arrhenius: activation_energy, activation_volume and temperature; repeatable.",
        consume_multiple=False,
    ),
]
Passages = Annotated[float, Parameter(help="Passages of each tooth of the pinion at most.")]
Fraction = Annotated[float, Parameter(help="Mean coverage at which the life ends.")]
Resolved = Annotated[str, Parameter(help="Coverage: uniform, by place, or by tooth and place.")]
Tolerance = Annotated[float, Parameter(help="Relative tolerance of each jump, and of the rates.")]


@app.command
def life(
    case: Case,
    *,
    law: Law,
    parameter: LawParameters,
    arrhenius: Arrhenius = None,
    passages: Passages = 1e12,
    fraction: Fraction = 0.0,
    resolved: Resolved = "uniform",
    tolerance: Tolerance = 3e-3,
    request: Usual = USUAL,
) -> int:
    """Follow the coverage over the passages of the teeth until the gear sticks."""
    from gearidae.cli.studies import follow_life

    return follow_life(
        str(case),
        request,
        law,
        parameter,
        arrhenius or [],
        passages=passages,
        fraction=fraction,
        resolved=resolved,
        tolerance=tolerance,
    )


@app.command
def lives(
    case: Case,
    *,
    law: Law,
    vary: Vary,
    size: Annotated[int, Parameter(help="Number of members.")],
    parameter: OtherParameters = None,
    arrhenius: Arrhenius = None,
    passages: Passages = 1e12,
    fraction: Fraction = 0.0,
    resolved: Resolved = "uniform",
    tolerance: Tolerance = 3e-3,
    design: Design = "sobol",
    seed: Seed = 0,
    request: Usual = USUAL,
) -> int:
    """Follow the coatings of gears with keys drawn from distributions: how long they last.

    Parameters of the law are drawn as law.NAME, such as --vary "law.energy=lognormal(0.5 mJ/m^2, 3)"; --parameter gives
    those that are not drawn. Lives so far are kept beside the archive, in OUT.nc.lives, until the archive is written.
    """
    from gearidae.cli.studies import follow_lives

    return follow_lives(
        str(case),
        request,
        law,
        parameter or [],
        arrhenius or [],
        vary,
        size=size,
        design=design,
        seed=seed,
        passages=passages,
        fraction=fraction,
        resolved=resolved,
        tolerance=tolerance,
    )
