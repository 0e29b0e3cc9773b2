"""Which tooth of the pinion an event of a population belongs to."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearidae.records import Flank


def tooth_of(teeth: int, pair: NDArray[Any], flank: NDArray[Any]) -> NDArray[np.int64]:
    """Tooth of events by their pairs and flanks.

    Parameters
    ----------
    teeth : int
        Of the pinion; 1 for a roller.
    pair, flank : ndarray, shape (n,)

    Returns
    -------
    ndarray of int64, shape (n,)
        Counted from 0; -1 for an event of no flank.
    """
    return np.where(np.asarray(flank) != Flank.NONE, np.asarray(pair, np.int64) % teeth, -1)


def teeth_in(attributes: Mapping[str, Any]) -> int:
    """Teeth of the pinion in a dataset's scene, as its attributes have it; 1 for a roller."""
    return int(json.loads(attributes["scene"]).get("gears", {}).get("pinion_teeth", 1))
