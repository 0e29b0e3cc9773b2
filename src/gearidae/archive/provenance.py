"""Global attributes: where a dataset comes from and what the scene's surfaces are (ACDD-1.3)."""

from __future__ import annotations

import hashlib
import json
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING, Any

import gearidae
from gearidae.asperities.tip import tabor_parameter, tabor_regime
from gearidae.scene.scene import is_long_train

if TYPE_CHECKING:
    from gearidae.scene import Scene

SCHEMA_VERSION = 1
"""Version of the layout; raised whenever an older reader could misread a newer file."""

SCENE_DIGEST = "scene_sha256"
"""Attribute that tells whether the scene is still the one that was run."""

_REFERENCES = (
    "M. Teodorescu, S. Theodossiades, H. Rahnejat, Impact dynamics of rough and surface protected MEMS "
    "gears, Tribology International 42 (2009) 197-205, https://doi.org/10.1016/j.triboint.2008.05.019"
)


def provenance(scene: Scene, action: str, *, swept: tuple[str, ...] = ()) -> dict[str, Any]:
    """Global attributes that say what was computed, when, and with which software.

    Parameters
    ----------
    scene : Scene
        The scene that was run; of a sweep, the one its runs were derived from.
    action : str
        What was done, for the history.
    swept : tuple of str, optional
        Keys in which the runs differ.

    Returns
    -------
    dict
        Attributes that netCDF can hold: strings and numbers. Only ``history`` and ``date_created`` depend on
        the moment of the call.
    """
    text = json.dumps(scene.to_dict(), allow_nan=False)
    now = datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")
    return {
        "Conventions": "CF-1.11, ACDD-1.3",
        "title": f"{scene.name}: {_subject(scene)}" + (f", swept over {', '.join(swept)}" if swept else ""),
        "summary": _summary(scene, swept),
        "keywords": "MEMS, gears, adhesion, self-assembled monolayer, rough contact, impact dynamics",
        "history": f"{now} gearidae {gearidae.__version__}: {action}",
        "source": _software(),
        "references": _REFERENCES,
        "license": "The data belong to the person who ran the simulation; gearidae itself is BSD-3-Clause.",
        "date_created": now,
        "product_version": gearidae.__version__,
        "schema_version": SCHEMA_VERSION,
        "scene": text,
        SCENE_DIGEST: digest_of(text),
        "rtol": scene.run.rtol,
        "t_end": scene.run.duration,
    }


def digest_of(scene: str) -> str:
    """SHA-256 of a scene as text."""
    return hashlib.sha256(scene.encode()).hexdigest()


def surface_regimes(scene: Scene) -> dict[str, float | str]:
    """Tabor parameter and adhesion regime of every material of the interface.

    JKR asperities presume a Tabor parameter of about 5 or more; this is a note on how well the scene meets
    that.

    Returns
    -------
    dict
        ``tabor_parameter_<surface>`` [1] and ``tabor_regime_<surface>`` (``jkr``, ``transition``, ``dmt``)
        for the materials ``bare``, ``coated`` and, with independent sides, ``mixed``.
    """
    regimes: dict[str, float | str] = {}
    for surface, _, _, name in scene.materials():
        parameter = tabor_parameter(surface)
        regimes[f"tabor_parameter_{name}"] = parameter
        regimes[f"tabor_regime_{name}"] = tabor_regime(parameter)
    return regimes


def _subject(scene: Scene) -> str:
    if is_long_train(scene):
        return "train of rough gears"
    return "rough gear pair" if scene.roller is None else "rough roller on a plane"


def _summary(scene: Scene, swept: tuple[str, ...]) -> str:
    """Say in two or three sentences what the numbers are."""
    if is_long_train(scene):
        what = (
            "Simulated motion of a train of micro gears whose rough teeth adhere to each other and are partly covered "
            "by a self-assembled monolayer: speeds of the shafts, forces, gaps and transmission errors of the meshes "
            "and loads of the hubs at uniform times, and every contact event."
        )
    elif scene.roller is None:
        what = (
            "Simulated motion of a pair of micro gears whose rough teeth adhere to each other and are partly "
            "covered by a self-assembled monolayer: speeds, transmission error, gaps and contact torque at "
            "uniform times, and every contact event."
        )
    else:
        what = (
            "Simulated impact of a rough roller, partly covered by a self-assembled monolayer, on a plane: "
            "height, speed and contact force at uniform times, and every contact event."
        )
    sweep = f" One run for each combination of {', '.join(swept)}." if swept else ""
    return f"{what}{sweep} The attribute 'scene' holds the complete input in SI units."


@cache
def _software() -> str:
    """Name what computed the numbers, with versions; to look them up takes milliseconds."""
    parts = [f"gearidae {gearidae.__version__}"]
    for package in ("scikit-sundae", "numba", "numpy"):
        try:
            parts.append(f"{package} {version(package)}")
        except (
            PackageNotFoundError
        ):  # vendored or run from a bare tree: the version is not known, the run is fine
            continue
    try:
        from sksundae import SUNDIALS_VERSION
    except (
        ImportError
    ):  # archives are also made where no solver is installed, for instance in tests of readers
        pass
    else:
        parts.insert(1, f"SUNDIALS {SUNDIALS_VERSION}")
    return ", ".join(parts)
