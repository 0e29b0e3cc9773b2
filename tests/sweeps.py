"""What the tests of sweeps share."""

from __future__ import annotations


def without_times(ds):
    """Drop what depends on the moment and the machine's load, and what a file alone has (test_kept_validity)."""
    ds = ds.copy()
    ds["wall_time"] = 0.0 * ds["wall_time"]
    ds.attrs = {
        name: value
        for name, value in ds.attrs.items()
        if name not in ("history", "date_created", "wall_time", "validity")
    }
    return ds
