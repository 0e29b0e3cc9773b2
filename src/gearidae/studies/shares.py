"""Confidence interval of a share that has been counted."""

from __future__ import annotations

from gearidae.errors import SceneError


def check_confidence(confidence: float) -> None:
    """Refuse what is no confidence.

    Raises
    ------
    SceneError
    """
    if not 0.0 < confidence < 1.0:
        raise SceneError("confidence", confidence, "must be above 0 and below 1")


def wilson(hits: int, size: int, confidence: float) -> tuple[float, float]:
    """Confidence interval of a probability (Wilson 1927, doi:10.2307/2276774); 0 to 1 where nothing was counted.

    Parameters
    ----------
    hits, size : int
        How many of how many.
    confidence : float
        Above 0 and below 1.
    """
    from scipy.stats import binomtest  # which takes half a second to load, and pictures do without

    if not size:
        return 0.0, 1.0
    interval = binomtest(hits, size).proportion_ci(confidence_level=confidence, method="wilson")
    return float(interval.low), float(interval.high)
