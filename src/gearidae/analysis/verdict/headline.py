"""What the runs of a dataset did, in one sentence for the terminal and the report."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import xarray as xr

from gearidae.analysis.verdict.codes import STUCK
from gearidae.analysis.verdict.outcome import GearOutcome, RollerOutcome, outcomes
from gearidae.archive.select import swept_dims
from gearidae.archive.value_text import label_cells


def headline(ds: xr.Dataset) -> str:
    """Say what the runs did: of one its verdict, of several the number of each verdict.

    Of a sweep over one number, also below or above which value the gears stick, if there is one such value.

    Parameters
    ----------
    ds : xarray.Dataset
        A single run or a sweep.
    """
    judged = outcomes(ds)
    subject = "roller" if isinstance(judged[0], RollerOutcome) else "gear"
    if len(judged) == 1:
        name = judged[0].shaft if isinstance(judged[0], GearOutcome) else ""
        return f"{name or f'The {subject}'} {judged[0].words}."
    counts = Counter(outcome.verdict for outcome in judged)
    counted = ", ".join(f"{verdict} {count}" for verdict, count in counts.most_common())
    return f"{len(judged)} runs: {counted}.{_limit(ds, subject, judged)}"


def _limit(ds: xr.Dataset, subject: str, judged: Sequence[GearOutcome | RollerOutcome]) -> str:
    """Name the two values between which the verdict changes to sticking, if there are two and no more."""
    dims = swept_dims(ds)
    values = ds[dims[0]].values if len(dims) == 1 else np.empty(0, dtype=object)
    if values.dtype.kind not in "fiu" or any(outcome.verdict == "unfinished" for outcome in judged):
        return ""
    order = np.argsort(values)
    stuck = [judged[index].verdict in STUCK for index in order]
    changes = [k for k, (before, after) in enumerate(pairwise(stuck)) if before != after]
    if len(changes) != 1:
        return ""
    low, high = (label_cells(ds, judged[order[k]].label)[0] for k in (changes[0], changes[0] + 1))
    at, beyond = (
        (f"{low} and below", f"{high} and above") if stuck[0] else (f"{high} and above", f"{low} and below")
    )
    return f" The {subject} sticks at {dims[0]} = {at}, and not at {beyond}."
