"""The library of named surfaces as a table."""

from __future__ import annotations

import pandas as pd

from gearidae.scene.surface_library import COATINGS, SOLIDS, LibraryValue


def library() -> pd.DataFrame:
    """List the surfaces that a scene may name, each number with its source.

    ``surface = "polysilicon, OTS"`` in a case file, or ``scene.replace({"surface": "polysilicon, OTS"})``, takes a
    solid and a monolayer from here. Coefficients of friction are listed: a named surface sets none.

    Returns
    -------
    pandas.DataFrame
        A row a number, indexed by ``name`` (of a solid or a monolayer) and ``key`` (of a scene, or the friction that it
        is). Columns: ``value`` (SI), ``unit``, ``assumed`` (no measurement of it is known) and ``source``.

    Examples
    --------
    >>> from gearidae import surfaces
    >>> surfaces.library().loc[("FOTS", "coating.thickness"), "value"]
    1e-09
    """
    rows = {
        (name, key): entry
        for part in (SOLIDS, COATINGS)
        for name, values in part.items()
        for key, entry in values.items()
    }
    index = pd.MultiIndex.from_tuples(rows, names=("name", "key"))
    table = pd.DataFrame(rows.values(), index=index, columns=LibraryValue._fields)
    return table[["value", "unit", "assumed", "source"]]
