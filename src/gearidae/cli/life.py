"""``gearidae life``, and the loss law of the commands that follow lives."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import gearidae as gd
from gearidae.archive import check_target
from gearidae.cli.case import read_scene
from gearidae.cli.codes import DONE
from gearidae.cli.output import is_quiet, say
from gearidae.cli.tables import show_rows
from gearidae.cli.values import assignments, default_output
from gearidae.errors import SceneError
from gearidae.studies.law_draws import law_of_medians

if TYPE_CHECKING:
    import xarray as xr

    from gearidae.wear import LossLaw

__all__ = ["follow_life", "read_law"]


def follow_life(
    case: str,
    law: str,
    parameters: Sequence[str],
    arrhenius: Sequence[str],
    options: dict[str, Any],
    output: Path | None,
    settings: Sequence[str],
) -> int:
    """Follow the life of a case's coating, keep it, show it.

    Parameters
    ----------
    case : str
        Case file or preset.
    law : str
        Name of a loss law.
    parameters, arrhenius : sequence of str
        ``name=value`` pairs of the law, and of Arrhenius' factor if there is one.
    options : dict
        Further arguments of `gearidae.studies.life`.
    output : Path or None
        File to write; None for the case's name with ``_life.nc``.
    settings : sequence of str
        ``key=value`` pairs.

    Returns
    -------
    int
        Exit code.
    """
    target = output or default_output(case, "_life.nc")
    check_target(target, overwrite=options["overwrite"] or options["resume"])
    found = gd.studies.life(
        read_scene(case, settings),
        read_law(law, parameters, arrhenius),
        progress=not is_quiet(),
        archive=target,
        **options,
    )
    show_rows(_rows(found))
    say(f"Life: {target}")
    return DONE


def read_law(
    name: str, parameters: Sequence[str], arrhenius: Sequence[str], vary: Mapping[str, Any] | None = None
) -> LossLaw:
    """Make the loss law of a command.

    Parameters
    ----------
    name : str
    parameters, arrhenius : sequence of str
        ``name=value`` pairs of the law, and of Arrhenius' factor if there is one.
    vary : mapping of str to object, optional
        Distributions, whose medians stand in for parameters that are not given.

    Returns
    -------
    LossLaw

    Raises
    ------
    SceneError
        If there is no such law, or its parameters are others.
    """
    law = law_of_medians(name, assignments(parameters, "--parameter", "energy=2 J/m^2"), vary or {})
    if not arrhenius:
        return law
    example = "activation_energy=1 eV"
    given = assignments(arrhenius, "--arrhenius", example)
    known = ("activation_energy", "activation_volume", "temperature")
    if sorted(given) != sorted(known):
        raise SceneError("--arrhenius", ", ".join(given), "needs " + ", ".join(known))
    return gd.wear.Arrhenius(law, **given)


def _rows(found: xr.Dataset) -> Iterator[tuple[str, str, str]]:
    """Coverage, speed and frequency at the steps of the life."""
    yield "Passages of each tooth", "coverage", "mean speed, smallest speed, characteristic frequency"
    for number in range(found.sizes["passages"]):
        one = found.isel(passages=number)
        shares = ", ".join(f"{round(100.0 * share, 6):.4g} %" for share in one["coverage"].values)
        speed = f"{float(one['mean_gear_speed']):.4g} rad/s, {float(one['min_gear_speed']):.4g} rad/s"
        rings = float(one["characteristic_frequency"]) if "characteristic_frequency" in one else math.nan
        more = "" if math.isnan(rings) else f", {rings:.4g} Hz"
        yield f"{float(one['passages']):.4g}", shares, f"{one['verdict'].values!s}, {speed}{more}"
    ending = found.attrs["ending"]
    if ending == "sticks":
        low, high = float(found["passages"][-1]), float(found.attrs["passages_to_sticking"])
        yield "The gear sticks", f"{high:.4g}", f"not yet after {low:.4g} passages of each tooth"
    else:
        yield "Ended", ending, ""
    jumped, simulated = (float(found.attrs[f"mesh_cycles_{name}"]) for name in ("jumped", "simulated"))
    yield (
        "mesh cycles simulated",
        f"{simulated:.4g}",
        f"{jumped:.4g} jumped, {found.attrs['windows']} windows",
    )
