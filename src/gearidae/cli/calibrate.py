"""``gearidae calibrate`` and ``gearidae predict``."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import gearidae as gd
from gearidae.archive import check_target
from gearidae.cli.case import check_dask, read_scene
from gearidae.cli.codes import DONE
from gearidae.cli.ensemble import executor_for, show_ensemble
from gearidae.cli.output import is_quiet, say
from gearidae.cli.tables import show_rows
from gearidae.cli.values import default_output, texts
from gearidae.errors import SceneError
from gearidae.runs.executors import check_jobs
from gearidae.scene import describe_key
from gearidae.scene.literal import literal
from gearidae.studies.observation_files import observation_of
from gearidae.studies.posterior import STEPS_WANTED
from gearidae.studies.posterior_file import calibrated_keys

if TYPE_CHECKING:
    import xarray as xr

    from gearidae.studies import Observation

__all__ = ["calibrate_case", "predict_case"]

_EXAMPLE: Final = "'sticks=true; drive.torque=4.2e-18' or 'ring_frequency=5.2 kHz +- 0.1 kHz'"


def calibrate_case(
    case: str,
    vary: Sequence[str],
    seen: Sequence[str],
    observations: Path | None,
    options: Mapping[str, Any],
    output: Path | None,
    settings: Sequence[str],
    dask: str | None,
) -> int:
    """Calibrate keys of a case by observations, keep the posterior, show it.

    Parameters
    ----------
    case : str
        Case file or preset.
    vary : sequence of str
        ``key=distribution`` pairs: what was known before.
    seen : sequence of str
        Observations, ``figure=value +- uncertainty; key=value; ...``.
    observations : Path or None
        File with more of them.
    options : mapping
        Further arguments of `gearidae.studies.calibrate`.
    output : Path or None
        File to write; None for the case's name with ``_posterior.nc``.
    settings : sequence of str
        ``key=value`` pairs.
    dask : str or None
        Address of a Dask scheduler.

    Returns
    -------
    int
        Exit code.
    """
    target = output or default_output(case, "_posterior.nc")
    priors = texts(vary, "--vary", "coating.sam_fraction=uniform(0.4, 0.7)")
    check_dask(dask, options["jobs"])
    workers = check_jobs(options["jobs"])
    listed = [_observation(text) for text in seen]
    listed += [] if observations is None else gd.studies.read_observations(observations)
    if not listed:
        raise SceneError("--seen", "(missing)", f"give what was observed, {_EXAMPLE}, or --observations FILE")
    check_target(target, overwrite=options["overwrite"] or options["resume"])
    scene = read_scene(case, settings)
    runs = len(listed) * int(options["points"])
    with executor_for(priors, runs, workers, dask) as executor:
        found = gd.studies.calibrate(
            scene,
            priors,
            listed,
            **{**options, "jobs": workers},
            executor=executor,
            progress=not is_quiet(),
            archive=target,
        )
    show_rows(_rows(found, len(listed)))
    say(f"Posterior: {target}")
    return DONE


def predict_case(
    case: str,
    posterior: Path,
    options: Mapping[str, Any],
    output: Path | None,
    settings: Sequence[str],
    dask: str | None,
) -> int:
    """Run a case with the keys that were calibrated drawn from their posterior.

    Parameters
    ----------
    case : str
        Case file or preset.
    posterior : Path
        File that `calibrate_case` wrote.
    options : mapping
        Further arguments of `gearidae.studies.predict`.
    output : Path or None
        File to write; None for the case's name with ``_predicted.nc``.
    settings : sequence of str
        ``key=value`` pairs.
    dask : str or None
        Address of a Dask scheduler.

    Returns
    -------
    int
        Exit code; 3 if any run did not reach its end.
    """
    target = output or default_output(case, "_predicted.nc")
    check_dask(dask, options["jobs"])
    workers = check_jobs(options["jobs"])
    known = gd.studies.open_posterior(posterior)
    scene = read_scene(case, settings)
    with executor_for(calibrated_keys(known), options["size"], workers, dask) as executor:
        ds = gd.studies.predict(
            scene,
            known,
            **{**options, "jobs": workers},
            executor=executor,
            progress=not is_quiet(),
            archive=target,
        )
    return show_ensemble(ds, "Prediction", target)


def _observation(text: str) -> Observation:
    """Read ``figure=value +- uncertainty; key=value; misjudged=share``."""
    given: dict[str, Any] = {}
    for place, pair in enumerate(text.split(";")):
        name, equals, value = (part.strip() for part in pair.partition("="))
        if not (name and equals and value) or name in given:
            raise SceneError("--seen", text, f"must read figure=value and conditions, such as {_EXAMPLE}")
        if place == 0:
            measured, _, uncertainty = (
                part.strip() for part in value.replace("\u00b1", "+-").partition("+-")
            )
            given = {"of": name, "value": literal(measured)}
            given |= {"uncertainty": literal(uncertainty)} if uncertainty else {}
        else:
            given[name] = literal(value)
    try:
        return observation_of(given)
    except SceneError as error:
        raise SceneError(f"--seen {error.key}", error.value, f"{error.allowed}; in {text!r}") from None


def _rows(found: xr.Dataset, observations: int) -> Iterator[tuple[str, str, str]]:
    """Mean, deviation and quantiles of each key; of draws, how many are independent."""
    yield str(found.attrs["title"]), "", f"{observations} observation{'s' if observations > 1 else ''}"
    for key in found["parameter"].values.tolist():
        one = found.sel(parameter=key)
        low, inner_low, middle, inner_high, high = (
            _text(value, key) for value in one["quantiles"].values.tolist()
        )
        spread = f"{_text(float(one['mean']), key)} +- {_text(float(one['standard_deviation']), key)}"
        yield key, spread, f"median {middle}, 68 % in {inner_low} .. {inner_high}, 95 % in {low} .. {high}"
    if "autocorrelation_time" in found.attrs:
        time, draws = float(found.attrs["autocorrelation_time"]), found.sizes["draw"]
        many = f"{draws / max(time, 1.0):.2g}"
        if found.attrs.get("steps_kept", math.inf) < STEPS_WANTED * time:
            independent = f"fewer than {many} independent: few --steps"
        else:
            independent = f"some {many} of them independent"
        yield "draws", str(draws), independent


def _text(value: float, key: str) -> str:
    unit = describe_key(key).unit
    return f"{value:.4g}" if unit == "1" else f"{value:.4g} {unit}"
