"""The commands that run a study: many runs that answer one question. `gearidae.cli.app` has the others.

Those on the life of a coating are in `gearidae.cli.life_commands`.
"""

from __future__ import annotations

from typing import Annotated

from cyclopts import Parameter

from gearidae.cli import completing
from gearidae.cli.app import Case, app
from gearidae.cli.request import Request

Vary = Annotated[
    list[str],
    Parameter(
        help="Key and its distribution, key=normal(450 nm, 50 nm); truncnormal(mean, deviation, lowest, highest), "
        "uniform(lowest, highest), lognormal(median, geometric deviation); contact.seed=seeds numbers the seeds of a "
        "population; repeatable.",
        consume_multiple=False,
        completer=completing.keys,
    ),
]
Design = Annotated[str, Parameter(help="sobol or random.")]
Seed = Annotated[int, Parameter(help="Seed of the design.")]
Usual = Annotated[Request, Parameter(name="*")]
USUAL = Request()


@app.command(name="starting-torque")
def starting_torque(
    case: Case,
    *,
    over: Annotated[
        str | None,
        Parameter(
            help="SAM fractions, coating.sam_fraction=1:0.4:-0.1. Default: the coating of the case as it is."
        ),
    ] = None,
    impacts: Annotated[int, Parameter(help="Pitches to be turned, each with its mesh exit.")] = 3,
    lowest: Annotated[
        float | None, Parameter(help="Lowest torque to try in N m. Default: 0.001 of the drive's own.")
    ] = None,
    tolerance: Annotated[float, Parameter(help="Relative width at which the search ends.")] = 0.1,
    seeds: Annotated[
        int | None, Parameter(help="Gears of a population, with seeds from contact.seed on. Default: 20.")
    ] = None,
    request: Usual = USUAL,
) -> int:
    """Search the smallest drive torque at which a gear at rest begins to turn against adhesion.

    Of a population (contact.model = population): the distribution over its gears, whose torque rises slowly until each
    has turned one pitch.
    """
    from gearidae.cli.studies import search_starting_torque

    return search_starting_torque(
        str(case), request, over, impacts=impacts, lowest=lowest, tolerance=tolerance, seeds=seeds
    )
