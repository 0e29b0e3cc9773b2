"""The probability of sticking within more and more mesh exits, from surfaces that were drawn."""

from __future__ import annotations

import numpy as np
import xarray as xr

import gearidae as gd
from gearidae_pages.scan_probability import asperities_of_scans, probability_table, waiting


def test_a_gear_counts_from_the_exits_at_which_it_stuck():
    """Four members of one ensemble: stuck at 5 and at 50 exits, and two that turn."""
    ds = gd.studies.ensemble(waiting(1), {"coating.sam_fraction": "uniform(0.9, 1.0)"}, 4)
    assert (ds.sticks == 0.0).all()
    ds = ds.assign(
        sticks=("member", np.array([1.0, 0.0, 1.0, 0.0])), stick_exits=("member", np.array([5, 0, 50, 0]))
    )
    table = probability_table(ds, [4, 5, 100]).splitlines()[2:]
    assert [row.split("|")[2].strip() for row in table] == ["0 of 4", "1 of 4", "2 of 4"]
    band = gd.studies.sticking_probability(ds)
    assert isinstance(band, xr.Dataset)
    assert f"| 0.50 | {float(band.low):.2f} and {float(band.high):.2f} |" in table[-1]


def test_scans_of_one_spectrum_agree_within_their_scatter():
    for key, text in asperities_of_scans().items():
        mean, deviation = (float(part) for part in text.removeprefix("normal(").removesuffix(")").split(","))
        assert 0.0 < deviation < 0.1 * mean, key
