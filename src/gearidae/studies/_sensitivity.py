r"""Derivative of a figure of a run in a key of its scene, by differences that know how far they may be out.

A run is a function of its scene only up to its own error: the solver takes other steps for every other input, so that a
figure f scatters by an amount :math:`\varepsilon` between neighbouring inputs. A central difference over a step h is
then out by

.. math::

    |D(h) - f'| \lesssim \tfrac{h^2}{6} |f'''| + \varepsilon / h .

The second term is the trap: with rtol 1e-6 the figures of a ringing contact scatter by some 1e-5, and over a relative
step of 1e-7 their difference is noise, of either sign. Here both terms are measured. The scatter comes from runs at
inputs so close to each other that the figure itself cannot differ, the first term from differences over steps in a
ratio of 2, whose errors are in a ratio of 4. The step with the least sum counts. At a corner, such as that of |x|, all
central differences may agree and be no derivative: there the differences to both sides differ by the same amount over
every step, where those of a smooth figure differ in proportion to it, and half that amount counts as well. What the
solver's error changes without scatter is seen at another tolerance only: all is done at two of them at least, and a
tenth of what both derivatives differ by counts too. If that is not good enough, the tolerance is made tighter still.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.runs.execution import interruptible
from gearidae.runs.executors import check_executor, side_by_side
from gearidae.runs.simulation import simulate
from gearidae.scene.keys import scene_value
from gearidae.scene.quantity import number

if TYPE_CHECKING:
    import xarray as xr

    from gearidae.scene import Scene

Figure = Callable[["xr.Dataset"], float]

_LARGEST_STEP: Final = 0.04
"""Largest step, over the size of the input."""
_STEPS: Final = 7
"""Steps, each half of the one before."""
_MOST_STEPS: Final = 16
"""Steps where the smallest of those still meet a corner."""
_NEIGHBOURS: Final = 1e-9
"""Over the size of the input: distance between the inputs whose figures give the scatter."""
_SCATTERED: Final = 5
"""How many of them."""
_TIGHTER: Final = (1.0, 1e-2, 1e-4)
"""Tolerances to try, over that of the scene."""
_TIGHTEST: Final = 1e-11
_REMAINING: Final = 0.1
"""Share of the difference to the looser tolerance, a hundred times as large, by which a derivative may still be out."""
_SMALLEST_SCATTER: Final = 8.0 * float(np.finfo(float).eps)
"""Of a figure: rounding."""


@dataclass(frozen=True, slots=True)
class Sensitivity:
    """A derivative and how far it may be out.

    Attributes
    ----------
    value : float
        df/dx, in the unit of the figure over the SI unit of the key.
    uncertainty : float
        Bound of the error of `value`, in the same unit: what differences over two steps differ by, and scatter over
        step. As large as the value, or infinite, where the figure has a jump or a corner at this input.
    figure : float
        f at the input itself.
    scatter : float
        By how much f scatters between neighbouring inputs.
    step : float
        h, in the SI unit of the key.
    rtol : float
        Relative tolerance of the runs that count.
    runs : int
        How many runs were made.
    """

    value: float
    uncertainty: float
    figure: float
    scatter: float
    step: float
    rtol: float
    runs: int


def sensitivity(
    scene: Scene,
    key: str,
    *,
    of: str | Figure,
    accuracy: float = 1e-2,
    scale: float | None = None,
    backend: str = "auto",
    executor: Executor | None = None,
) -> Sensitivity:
    r"""Differentiate a figure of a run by a key of its scene.

    Parameters
    ----------
    scene : Scene
    key : str
        Dotted name of a number, ``"drive.torque"``.
    of : str or callable
        Variable that a run has once (``"largest_mesh_force"``, ``"max_gear_speed"``, ``"stick_time"``), or a function
        of the run's dataset that returns a number.
    accuracy : float, optional
        Uncertainty over the derivative that is good enough; the tolerance is made tighter by a factor of 100 once to
        see what that changes, and once more if this is not reached.
    scale : float, optional
        Size of the input that steps are measured by, in its SI unit; by default the input itself.
    backend : {'auto', 'native', 'sksundae'}, optional
    executor : Executor, optional
        To run side by side, as that of `concurrent.futures.ThreadPoolExecutor`.

    Returns
    -------
    Sensitivity
        With the least uncertainty that was found.

    Raises
    ------
    SceneError
        If the key is no number, is zero without a `scale`, or the run has no such figure.
    Interrupted
        On Ctrl-C.

    Examples
    --------
    >>> import gearidae as gd
    >>> scene = gd.preset("teodorescu2009_low_speed")
    >>> found = gd.studies.sensitivity(scene, "drive.torque", of="max_gear_speed")  # doctest: +SKIP
    """
    check_executor(executor)
    middle = _number(scene, key)
    size = abs(middle) if scale is None else number("scale", scale)
    if not (accuracy := number("accuracy", accuracy)) > 0.0:
        raise SceneError("accuracy", accuracy, "must be above 0")
    if not (size > 0.0 and math.isfinite(size)):
        raise SceneError(key, middle, "is zero: say what size steps are measured by (scale=)")
    figure = _figure(of)
    best, before, runs = None, None, 0
    for rtol in _tolerances(scene.run.rtol):
        of_scene = _Runs(scene.replace({"run.rtol": rtol}), key, figure, backend, executor)
        with interruptible():
            derivative = _differentiate(of_scene, middle, size, rtol, accuracy)
        runs += derivative.runs
        if before is not None:
            more = _REMAINING * abs(derivative.value - before.value)
            derivative = replace(derivative, uncertainty=derivative.uncertainty + more)
            if best is None or derivative.uncertainty < best.uncertainty:
                best = derivative
            if best.uncertainty <= accuracy * abs(best.value):
                break
        before = derivative
    assert best is not None
    return replace(best, runs=runs)


def _tolerances(rtol: float) -> list[float]:
    """Tolerances to try, two at least."""
    tighter = sorted({max(rtol * share, _TIGHTEST) for share in _TIGHTER}, reverse=True)
    return tighter if len(tighter) > 1 else [100.0 * rtol, rtol]


class _Runs:
    """A figure of runs as a function of one number of their scene."""

    def __init__(
        self, scene: Scene, key: str, figure: Figure, backend: str, executor: Executor | None
    ) -> None:
        self._scene, self._key, self._figure = scene, key, figure
        self._backend, self._executor = backend, executor

    def __call__(self, inputs: Sequence[float]) -> list[float]:
        scenes = [self._scene.replace({self._key: value}) for value in inputs]  # refused before anything runs
        figures, backends = [self._figure] * len(scenes), [self._backend] * len(scenes)
        return list(side_by_side(self._executor, _run, scenes, figures, backends))


def _run(scene: Scene, figure: Figure, backend: str) -> float:
    return float(figure(simulate(scene, backend=backend)))


def _differentiate(runs: _Runs, middle: float, size: float, rtol: float, accuracy: float) -> Sensitivity:
    """Differentiate at one tolerance."""
    offsets = np.arange(_SCATTERED) - (_SCATTERED - 1) / 2.0
    near = np.array(runs([middle + _NEIGHBOURS * size * offset for offset in offsets]))
    figure = float(near[_SCATTERED // 2])
    scatter = max(float(np.ptp(near)), _SMALLEST_SCATTER * abs(figure))
    steps, values = np.empty(0), np.empty((0, 2))
    more = _STEPS
    while True:
        added = _LARGEST_STEP * size * 0.5 ** np.arange(steps.size, steps.size + more)
        inputs = [middle + sign * h for h in added for sign in (1.0, -1.0)]
        steps, values = np.concatenate([steps, added]), np.vstack([values, np.reshape(runs(inputs), (-1, 2))])
        differences = (values[:, 0] - values[:, 1]) / (2.0 * steps)
        smooth, noise = _truncation(differences, values, figure, steps), scatter / steps[1:]
        errors = smooth + noise
        k = int(np.argmin(errors))
        value = float(differences[k + 1])
        # a corner, and not scatter, limits the smallest step: the input may be beside it
        cornered = smooth[-1] > noise[-1] and errors[k] > accuracy * abs(value)
        if not cornered or steps.size >= _MOST_STEPS:
            break
        more = 2 if steps.size + 2 <= _MOST_STEPS else _MOST_STEPS - steps.size
    return Sensitivity(
        value=value,
        uncertainty=float(errors[k]),
        figure=figure,
        scatter=scatter,
        step=float(steps[k + 1]),
        rtol=rtol,
        runs=_SCATTERED + 2 * steps.size,
    )


def _truncation(differences: Floats, values: Floats, figure: float, steps: Floats) -> Floats:
    """Bound what central differences over all steps but the first are out by, scatter left out.

    Errors of two steps are in a ratio of 4: the finer one is out by a third of what both differ by; where that is not
    so the figure is not smooth, and the whole difference counts. So does half of the corner between both sides.
    """
    apart = np.abs(np.diff(differences))
    worse = np.maximum(apart, 0.25 * np.concatenate([apart[:1], apart[:-1]]))
    curvature = (values.sum(axis=1) - 2.0 * figure) / steps  # difference of the one-sided slopes
    corner = 0.5 * np.abs(2.0 * curvature[1:] - curvature[:-1])  # what is not in proportion to the step
    # beside a corner a single such value may vanish by chance, not two in a row
    corner = np.maximum(corner, 0.25 * np.concatenate([corner[:1], corner[:-1]]))
    worse = np.maximum(worse, corner)
    return np.where(np.isfinite(worse), worse, math.inf)


def _number(scene: Scene, key: str) -> float:
    """Return the number that a key holds."""
    value = scene_value(scene, key)
    scene.replace({key: value})  # names a key that there is not
    if isinstance(value, str):
        value = functools.reduce(getattr, key.split("."), scene)  # a gap in roughnesses is a length here
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise SceneError(key, str(value)[:40], "must hold a number to differentiate by")
    return float(value)


def _figure(of: str | Figure) -> Figure:
    """Return the function that reads a figure of a run."""
    if callable(of):
        return of

    def read(ds: xr.Dataset) -> float:
        if of not in ds.variables or ds[of].dims:
            once = sorted(str(name) for name, variable in ds.data_vars.items() if not variable.dims)
            raise SceneError("of", str(of)[:40], f"must be one of {', '.join(once)}, or a function")
        return float(ds[of])

    return read
