"""Where a dataset that was joined from others comes from."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime

import xarray as xr

import gearidae

_MOST_LINES = 100
"""Lines of history taken over from the parts."""


def history_of(parts: Sequence[xr.Dataset], action: str) -> str:
    """Return the histories of the parts, each line once, and what has been done with them."""
    lines = list(dict.fromkeys(line for part in parts for line in part.attrs.get("history", "").splitlines()))
    if len(lines) > _MOST_LINES:
        lines = [*lines[: _MOST_LINES - 1], f"and {len(lines) - _MOST_LINES + 1} lines more"]
    now = datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    return "\n".join([*lines, f"{now} gearidae {gearidae.__version__}: {action}"])


def software_of(parts: Sequence[xr.Dataset]) -> dict[str, str]:
    """Return the software that computed the parts, as the attribute ``source``."""
    return {
        "source": "; ".join(dict.fromkeys(part.attrs["source"] for part in parts if "source" in part.attrs))
    }


def part_name(number: int) -> str:
    """Name one of the datasets in a message."""
    return f"dataset {number + 1}"
