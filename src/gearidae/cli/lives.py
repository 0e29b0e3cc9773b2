"""``gearidae lives``."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import numpy as np

import gearidae as gd
from gearidae.archive import check_target
from gearidae.cli.case import read_scene
from gearidae.cli.codes import DONE, UNFINISHED
from gearidae.cli.life import read_law
from gearidae.cli.output import is_quiet, say
from gearidae.cli.tables import name_failures, show_rows
from gearidae.cli.values import default_output, texts

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["follow_lives"]

_SHARES: Final = (0.9, 0.5, 0.1)
"""Of the gears that still turn, for which the passages are shown."""


def follow_lives(
    case: str,
    law: tuple[str, Sequence[str], Sequence[str]],
    vary: Sequence[str],
    options: Mapping[str, Any],
    output: Path | None,
    settings: Sequence[str],
) -> int:
    """Follow the coatings of an ensemble of gears, keep their lives, show how long they last.

    Parameters
    ----------
    case : str
        Case file or preset.
    law : tuple
        Name of a loss law, its ``name=value`` pairs and those of Arrhenius' factor.
    vary : sequence of str
        ``key=distribution`` pairs.
    options : mapping
        Further arguments of `gearidae.studies.lives`.
    output : Path or None
        File to write; None for the case's name with ``_lives.nc``.
    settings : sequence of str
        ``key=value`` pairs.

    Returns
    -------
    int
        Exit code; `UNFINISHED` if any life could not be followed to its end.
    """
    target = output or default_output(case, "_lives.nc")
    check_target(target, overwrite=options["overwrite"] or options["resume"])
    distributions = texts(vary, "--vary", "drive.torque=normal(4.5e-18, 2e-19)")
    ds = gd.studies.lives(
        read_scene(case, settings),
        read_law(*law, distributions),
        distributions,
        progress=not is_quiet(),
        archive=target,
        **options,
    )
    show_rows(_rows(ds))
    say(f"Lives: {target}")
    return UNFINISHED if name_failures(ds) else DONE


def _rows(ds: xr.Dataset) -> Iterator[tuple[str, str, str]]:
    """How the lives end, and after how many passages shares of the gears still turn."""
    members = ds.sizes["member"]
    yield str(ds.attrs["title"]), "", ""
    for word, count in Counter(ds["ending"].values.tolist()).most_common():
        yield str(word), str(count), f"{100.0 * count / members:.3g} % of the members"
    if (ds["sticks"] > 0.0).any():
        yield from _surviving_rows(ds)
    if np.isfinite(ds["final_coverage"]).any():
        low, middle, high = np.nanquantile(ds["final_coverage"].values, (0.05, 0.5, 0.95))
        spread = f"90 % between {100.0 * low:.4g} % and {100.0 * high:.4g} %"
        yield "coverage at the end", f"{100.0 * middle:.4g} %", spread
    yield "windows", str(int(np.nansum(ds["windows"].values))), "simulated"


def _surviving_rows(ds: xr.Dataset) -> Iterator[tuple[str, str, str]]:
    found = gd.studies.surviving_share(ds)
    passages, shares = found["passages"].values, found["share"].values
    followed = max(passages[-1], np.nanmax(ds["passages_turning"].values))
    for share in _SHARES:
        fallen = np.flatnonzero(shares <= share)
        value = f"{passages[fallen[0]]:.4g}" if fallen.size else f"above {followed:.4g}"
        yield f"passages until {100.0 * share:.0f} % still turn", value, "of each tooth of the pinion"
