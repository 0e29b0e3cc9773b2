"""What a speed sensor would show along a life: signals of its states, and what they say about the coating."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final

import numpy as np
import xarray as xr

from gearidae.archive.select import scene_of
from gearidae.errors import SceneError
from gearidae.runs.execution import interruptible
from gearidae.scene import Scene
from gearidae.studies.declared.life import STUDY

if TYPE_CHECKING:
    from collections.abc import Mapping

SAMPLES: Final = 30_001
"""Of a signal, where the scene has none."""
_ASSESSED: Final = {
    "assessed_coverage": "most likely coverage by the signal",
    "assessed_low": "lower end of its 95 % interval",
    "assessed_high": "upper end of its 95 % interval",
}


def assess_life(ds: xr.Dataset, chart: xr.Dataset, *, noise: float = 0.0, seed: int = 0) -> xr.Dataset:
    """Assess a signal of each state of a life, as a speed sensor would give it.

    Parameters
    ----------
    ds : Dataset
        From `gearidae.studies.life`.
    chart : Dataset
        From `gearidae.studies.coating_map`, of the same scene.
    noise : float, optional
        Standard deviation of white noise on the speed [rad/s].
    seed : int, optional
        Of the noise.

    Returns
    -------
    Dataset
        The life, and along ``passages`` ``assessed_coverage`` with its 95 % interval ``assessed_low`` and
        ``assessed_high`` [1], NaN where a signal does not decide, and ``assessed_verdict``.

    Raises
    ------
    SceneError
        If the dataset is no life or the chart no coating map, or a number is not allowed.
    Interrupted
        On Ctrl-C.
    """
    from gearidae.analysis import assess

    STUDY.require(ds)
    if not 0.0 <= noise < np.inf:
        raise SceneError("noise", noise, "must be a speed in rad/s, 0 or more")
    random = np.random.default_rng(seed)
    found = []
    with interruptible():
        for number in range(ds.sizes["passages"]):
            signal = life_signal(ds, number)
            found.append(assess(signal + noise * random.standard_normal(signal.size), chart))
    columns = [(each.sam_fraction, each.low, each.high) for each in found]
    values = np.where([[each.conclusive] for each in found], np.array(columns), np.nan)
    made: dict[str, Any] = {
        name: ("passages", values[:, number], {"units": "1", "long_name": words})
        for number, (name, words) in enumerate(_ASSESSED.items())
    }
    words = {"units": "1", "long_name": "verdict on the signal"}
    made["assessed_verdict"] = ("passages", [each.verdict for each in found], words)
    return ds.assign(made).assign_attrs(assessed_noise=float(noise))


def life_signal(ds: xr.Dataset, number: int) -> xr.DataArray:
    """Simulate the gear's speed at a state of a life.

    Parameters
    ----------
    ds : Dataset
        From `gearidae.studies.life`.
    number : int
        Of the state, along ``passages``.

    Returns
    -------
    DataArray
        Speed [rad/s] along ``time``, from the start of the life's scene.
    """
    scene = Scene.from_dict(scene_of(ds))
    return signal_of(scene, _changes(ds.isel(passages=number)))["gear_speed"]


def signal_of(scene: Scene, changes: Mapping[str, Any]) -> xr.Dataset:
    """Simulate what a sensor records, with a coverage of the life."""
    from gearidae.runs.simulation import simulate

    own = scene.replace({**changes, "run.stop": "time", "run.exposures": 0})
    return simulate(own, samples=own.run.samples if own.run.sample_count else SAMPLES)


def _changes(state: xr.Dataset) -> dict[str, Any]:
    """What a state of a life changes in its scene."""
    if "coverage_by_place" in state:
        names = {"interface": "pinion", "pinion": "pinion", "gear": "gear"}
        found: dict[str, Any] = {"coating.pinion_fraction": None, "coating.gear_fraction": None}
        for side in state["side"].values.tolist():
            table = state["coverage_by_place"].sel(side=side).values
            # the rows of the pinion's teeth hold what all teeth of the gear have alike
            found[f"coating.{names[side]}_table"] = (table[:1] if side == "gear" else table).tolist()
        return found
    shares = {side: float(state["coverage"].sel(side=side)) for side in state["side"].values.tolist()}
    if "interface" in shares:
        return {"coating.sam_fraction": shares["interface"]}
    return {f"coating.{side}_fraction": share for side, share in shares.items()}
