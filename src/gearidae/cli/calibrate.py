"""``gearidae calibrate`` and ``gearidae predict``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import gearidae as gd
from gearidae.cli.request import Request
from gearidae.cli.studies import conduct
from gearidae.errors import SceneError
from gearidae.scene.literal import literal
from gearidae.scene.pairs import texts
from gearidae.studies.observation_files import observation_of

if TYPE_CHECKING:
    from gearidae.studies import Observation

_EXAMPLE: Final = "'sticks=true; drive.torque=4.2e-18' or 'ring_frequency=5.2 kHz +- 0.1 kHz'"


def calibrate_case(
    case: str,
    request: Request,
    vary: Sequence[str],
    seen: Sequence[str],
    observations: Path | None,
    **options: Any,
) -> int:
    """Calibrate keys of a case by observations.

    Parameters
    ----------
    vary : sequence of str
        Keys and their priors, ``key=normal(mean, standard deviation)``.
    seen : sequence of str
        Observations, ``figure=value +- uncertainty; key=value``.
    observations : Path or None
        File with more of them.
    **options
        Of `gearidae.studies.calibrate`.

    Returns
    -------
    int
        Exit code.

    Raises
    ------
    SceneError
        If nothing was observed, or an observation cannot be read.
    """
    priors = texts(vary, "--vary", "coating.sam_fraction=uniform(0.4, 0.7)")
    listed = [_observation(text) for text in seen]
    listed += [] if observations is None else gd.studies.read_observations(observations)
    if not listed:
        raise SceneError("--seen", "(missing)", f"give what was observed, {_EXAMPLE}, or --observations FILE")
    options |= {"keys": priors, "members": len(listed) * int(options["points"])}
    outset = f"{' and '.join(priors)} from {len(listed)} observation{'s' if len(listed) > 1 else ''}"
    return conduct(
        case,
        request,
        "Posterior",
        gd.studies.calibrate,
        priors,
        listed,
        outset=outset,
        **options,
    )


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
