"""Assertions on runs for the tests of a user."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

import xarray as xr

from gearidae.archive.select import scene_of
from gearidae.errors import SceneError
from gearidae.records import ROWS
from gearidae.scene.differences import first_difference
from gearidae.scene.group import did_you_mean, shorten
from gearidae.testing.comparison import compare

_SHOWN = 12
"""Differences that a message lists."""


def assert_runs_close(
    a: xr.Dataset,
    b: xr.Dataset,
    *,
    rtol: float = 1e-6,
    per: Mapping[str, float] | None = None,
    ignore: Sequence[str] = (),
) -> None:
    """Require that a run, or a sweep, agrees with a reference and has all that the reference has.

    Parameters
    ----------
    a, b : xarray.Dataset
        The run and the reference, as for `gearidae.compare`.
    rtol : float, optional
        Largest allowed difference of each variable over its scale [1]; that of events is over the duration. Events must
        be the same in the same order.
    per : mapping of str to float, optional
        Tolerances of single variables in place of `rtol`; infinite for one that may differ, also ``events``.
    ignore : sequence of str, optional
        Variables of the reference that the run may lack, also ``events``, ``passages`` and ``impacts``.

    Raises
    ------
    AssertionError
        Names each variable that the run lacks or has in another unit, each that differs by more, by how much, and
        where; and the first key in which the scenes differ.
    SceneError
        If the datasets cannot be compared, a tolerance is negative or NaN, `per` names a variable that they do not
        have, or `ignore` one that the reference does not have.
    """
    per = dict(per or {})
    for name, tolerance in {"rtol": rtol, **per}.items():
        if not tolerance >= 0.0:
            raise SceneError(
                "rtol" if name == "rtol" else f"per[{name!r}]", tolerance, "must be a number from 0 on"
            )
    _check_ignored(b, ignore)
    lines = list(_lacking(a, b, set(ignore)))
    try:
        table = compare(a, b)
    except SceneError as error:
        if not lines:
            raise
        raise AssertionError("\n".join(["runs cannot be compared:", *lines[:_SHOWN], f"  {error}"])) from None
    if unknown := [name for name in per if name not in table.index]:
        raise SceneError("per", unknown[0], f"must be one of {', '.join(sorted(table.index))}")
    for name, row in table.iterrows():
        allowed = per.get(str(name), rtol)
        if not row["relative"] <= allowed:
            lines.append(_line(str(name), row["difference"], row["relative"], row["where"], allowed))
    if not lines:
        return
    more = [f"  and {len(lines) - _SHOWN} more"] if len(lines) > _SHOWN else []
    raise AssertionError("\n".join([_heading(a, b, len(lines), len(table)), *lines[:_SHOWN], *more]))


def _check_ignored(reference: xr.Dataset, ignore: Sequence[str]) -> None:
    known = [*map(str, reference.variables), *(rows.field for rows in ROWS)]
    for name in [ignore] if isinstance(ignore, str) else ignore:
        if name not in known:
            meant = did_you_mean(str(name), known)
            allowed = "is nothing that the reference has" + (f"; {meant}" if meant else "")
            raise SceneError("ignore", shorten(name), allowed)


def _lacking(run: xr.Dataset, reference: xr.Dataset, ignore: set[str]) -> Iterator[str]:
    """Say what of a reference a run lacks, or has in another unit."""
    left_out = set()
    for dim, many in ((rows.dim, rows.field) for rows in ROWS):
        there = reference.sizes.get(dim, 0)
        if there and not run.sizes.get(dim, 0) and many not in ignore:
            yield f"  {many}: the run has none, the reference has {there}"
        if not there or not run.sizes.get(dim, 0) or many in ignore:
            left_out.add(dim)
    for name, variable in reference.variables.items():
        if name in ignore or left_out & set(variable.dims):
            continue
        if name not in run.variables:
            yield f"  {name}: the run lacks it"
        elif (units := run[name].attrs.get("units")) != (expected := variable.attrs.get("units")):
            yield f"  {name}: is in {units}, and in {expected} in the reference"


def _heading(a: xr.Dataset, b: xr.Dataset, apart: int, total: int) -> str:
    different = first_difference(scene_of(a), scene_of(b))
    scenes = "their scenes are the same" if different is None else f"their scenes differ in {different[0]}"
    return f"runs differ in {apart} of {total} quantities ({scenes}):"


def _line(name: str, difference: float, relative: float, where: str, allowed: float) -> str:
    if math.isinf(relative):
        return f"  {name}: {where or 'only one has a value'}"
    at = f" at {where}" if where else ""
    return f"  {name}: {relative:.3g} of its scale ({difference:.3g}){at}; allowed {allowed:.3g}"
