"""What gearidae raises when it cannot go on: bad input, or a solver in trouble."""

from __future__ import annotations

import signal
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    import xarray as xr

STOPS: Final = tuple(
    signal.Signals[name] for name in ("SIGINT", "SIGTERM", "SIGHUP") if name in signal.Signals.__members__
)
"""Signals that end a program, which its command line turns into a `KeyboardInterrupt`."""


class GearidaeError(Exception):
    """Base of every error that gearidae raises on purpose."""


class SceneError(GearidaeError, ValueError):
    """Bad input: says which key, what it held and what is allowed, in one line.

    Parameters
    ----------
    key : str
        Dotted key of the scene (``coating.sam_fraction``), a file name or a command-line option.
    value : object
        The offending value.
    allowed : str
        What may stand there instead.
    """

    def __init__(self, key: str, value: object, allowed: str) -> None:
        self.key = key
        self.value = value
        self.allowed = allowed
        super().__init__(" ".join(f"{key} = {value}: {allowed}".split()))

    def __reduce__(self) -> tuple[type[SceneError], tuple[str, object, str]]:
        """Survive the trip between processes, which rebuilds an exception from its arguments."""
        return type(self), (self.key, self.value, self.allowed)


class DiskFullError(SceneError):
    """A file could not be written, for want of room; nothing is wrong with the input."""


class SolverError(GearidaeError, RuntimeError):
    """The integration could not go on; what had been computed until then is kept.

    Parameters
    ----------
    message : str
        What happened.
    time : float
        Simulated time reached [s].
    state : dict of str to float
        The last state that is known, SI units.
    last_event : str
        The last recorded event, in words; empty where none is known.
    advice : str
        What to try next.
    dataset : xarray.Dataset, optional
        The samples and events recorded up to `time`.
    state_time : float, optional
        When `state` was [s]; `time` if not given.
    """

    def __init__(
        self,
        message: str,
        *,
        time: float,
        state: dict[str, float],
        last_event: str,
        advice: str,
        dataset: xr.Dataset | None = None,
        state_time: float | None = None,
    ) -> None:
        self.message = message
        self.time = time
        self.state = state
        self.last_event = last_event
        self.advice = advice
        self.dataset = dataset
        self.state_time = time if state_time is None else state_time
        where = ", ".join(f"{name} = {value:.6g}" for name, value in state.items())
        if where and state_time is not None and state_time != time:
            where = f"last sample, {state_time:.9g} s: {where}"
        where = f" ({where})" if where else ""
        last = f"last event: {last_event}; " if last_event else ""
        super().__init__(f"{message} at t = {time:.9g} s{where}; {last}{advice}")

    def __reduce__(self) -> tuple[Any, ...]:
        """Survive the trip between processes with every field in place."""
        return _rebuild_solver_error, (
            self.message,
            self.time,
            self.state,
            self.last_event,
            self.advice,
            self.dataset,
            self.state_time,
        )


def _rebuild_solver_error(
    message: str,
    time: float,
    state: dict[str, float],
    last_event: str,
    advice: str,
    dataset: xr.Dataset | None,
    state_time: float,
) -> SolverError:
    return SolverError(
        message,
        time=time,
        state=state,
        last_event=last_event,
        advice=advice,
        dataset=dataset,
        state_time=state_time,
    )


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a run; what had been computed until then is kept.

    Parameters
    ----------
    message : str
        The progress of the run, and the file of its data.
    dataset : xarray.Dataset
        The samples and events recorded so far.
    """

    def __init__(self, message: str, dataset: xr.Dataset) -> None:
        self.dataset = dataset
        super().__init__(message)
