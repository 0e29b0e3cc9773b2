"""Lives of an ensemble: how long coatings last where the scene is known as distributions."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, Literal, Unpack

import numpy as np
import xarray as xr

from gearidae.archive import dimension_names
from gearidae.archive.provenance import provenance
from gearidae.arrays import Floats
from gearidae.engine import choose_backend
from gearidae.errors import SceneError, SolverError
from gearidae.progress import sweep_progress
from gearidae.runs.execution import RunOptions, origin_of, prepared, run_kept
from gearidae.runs.executors import side_by_side
from gearidae.runs.run_cache import circumstances, name_of
from gearidae.scene.group import did_you_mean
from gearidae.studies.design import check_design, plain_design
from gearidae.studies.distributions import Distribution, read_distributions
from gearidae.studies.members import member_plan, names_of
from gearidae.studies.products import open_lives
from gearidae.wear import LossLaw
from gearidae.wear.declared.lives import STUDY
from gearidae.wear.lives.law_draws import drawn_laws, parameter_units
from gearidae.wear.lives.life import life

if TYPE_CHECKING:
    from gearidae.scene import Scene

_LIFE: Final = re.compile(r"[0-9a-f]{64}\.nc(\.journal)?")
"""Names of files of lives, and of the journals of windows beside them."""


class _Options(RunOptions, total=False):
    """Arguments of `life` that hold for all members, and those of every study."""

    passages: float
    fraction: float
    resolved: str
    places: int
    cycles: int
    settle: int
    starts: int
    tolerance: float
    bracket: float


_SETTINGS: Final = tuple(name for name in _Options.__annotations__ if name not in RunOptions.__annotations__)


def lives(
    scene: Scene,
    law: LossLaw,
    vary: Mapping[str, Any],
    size: int,
    design: Literal["sobol", "random"] = "sobol",
    *,
    seed: int = 0,
    **options: Unpack[_Options],
) -> xr.Dataset:
    """Follow the coatings of gears whose keys are drawn from distributions, each until its gear sticks.

    Parameters
    ----------
    scene : Scene
        What the members have in common.
    law : LossLaw
        How coverage is lost, from `gearidae.wear`.
    vary : mapping of str to object
        Keys and their distributions, as for `gearidae.studies.ensemble`; ``law.`` and a name are a parameter of the
        law, ``{"law.energy": "lognormal(0.5 mJ/m^2, 3)"}``.
    size : int
        Number of members.
    design : {"sobol", "random"}, optional
        Scrambled Sobol' points, which cover the distributions more evenly, or pseudo-random ones.
    seed : int, optional
        Seed of the design; the same one draws the same members.
    **options
        ``executor``, ``jobs``, ``backend``, ``progress``, ``archive``, ``overwrite`` and ``resume``, as for
        `gearidae.sweep`; members are followed side by side. With ``archive``, the lives so far and their finished
        windows are kept beside it, in ``OUT.nc.lives``, until it is written. Also ``passages``, ``fraction``,
        ``resolved``, ``places``, ``cycles``, ``settle``, ``starts``, ``tolerance`` and
        ``bracket`` of `gearidae.studies.life`.

    Returns
    -------
    Dataset
        Along ``member``: the keys' values as coordinates (SI), ``ending``, ``passages_to_sticking`` (NaN if the life
        has another ending), ``passages_turning``, ``final_coverage``, ``windows``, ``sticks``, ``status``, ``message``.
        `gearidae.studies.surviving_share` says how many still turn after some passages.

    Raises
    ------
    SceneError
        If a key, a distribution or a setting is not allowed; nothing has been run then.
    Interrupted
        On Ctrl-C; the lives so far are kept beside `archive`.

    Examples
    --------
    >>> import gearidae as gd
    >>> scene = gd.preset("teodorescu2009_low_speed")
    >>> law = gd.wear.loss_law("adhesion_work", energy="10 J/m^2")
    >>> vary = {"drive.torque": "normal(4.5e-18, 2e-19)"}
    >>> found = gd.studies.lives(scene, law, vary, 16)  # doctest: +SKIP
    >>> gd.studies.surviving_share(found)  # doctest: +SKIP
    """
    chosen: Any = dict(options)
    settings = {name: chosen.pop(name) for name in options if name not in RunOptions.__annotations__}
    base, execution = prepared(scene, chosen, samples="off")
    check_design(size, design, seed, indices=False)
    _check_settings(law, settings)
    distributions = read_distributions(base, vary, parameter_units(law))
    texts = names_of(distributions)
    drawn = plain_design(distributions, int(size), design, int(seed)).values
    values = {distribution.key: drawn[:, number] for number, distribution in enumerate(distributions)}
    laws = drawn_laws(law, values, int(size), texts)
    members = list(zip(_scenes(base, values, int(size), texts), laws, strict=True))
    for scene_of_member, law_of_member in members:
        law_of_member.check(scene_of_member)
    about = {"design": design, "seed": int(seed), "size": int(size), "of": None, "distributions": texts}

    def work(kept: _LifeCache | None) -> xr.Dataset:
        common = _Common(settings, execution.backend, None if kept is None else kept.path)
        followed: list[_Member] = []
        with (
            nullcontext() if kept is None else kept,
            sweep_progress(execution.progress, len(members)) as report,
            execution.computing(len(members)) as computing,
        ):
            for member in side_by_side(computing, _follow, members, [common] * len(members)):
                followed.append(member)
                report(float(len(followed)), len(members))
        return _dataset(base, law, distributions, values, followed)

    depends = {"ensemble": json.dumps(about), "settings": json.dumps([law.describe(), settings])}
    return run_kept(execution, _LifeCache, work, {**origin_of(base), **depends}, read=open_lives)


class _LifeCache:
    """The lives of an unfinished ensemble, each in a file of its own beside the archive, in ``OUT.nc.lives``."""

    def __init__(self, archive: Path) -> None:
        self.path = archive.with_name(f"{archive.name}.lives")

    def __enter__(self) -> None:
        self.path.mkdir(exist_ok=True)

    def __exit__(self, *_: object) -> None:
        if not any(self.path.iterdir()):  # refused, or interrupted at once
            self.path.rmdir()

    def count(self) -> int:
        """Count the lives, those that are unfinished included."""
        return len({path.stem for path in self._files() if path.suffix == ".nc"})

    def remove(self, _scenes: Sequence[Scene] | None = None) -> None:
        """Delete the lives, and the folder if nothing else is in it."""
        for path in self._files():
            path.unlink()
        if self.path.is_dir():
            self.__exit__()

    def close(self) -> None:
        """Leave the lives as they are."""

    def _files(self) -> list[Path]:
        if not self.path.is_dir():
            return []
        return [path for path in self.path.iterdir() if _LIFE.fullmatch(path.name)]


@dataclass(frozen=True)
class _Common:
    """What the members have in common besides the keys that are not drawn."""

    settings: dict[str, Any]
    backend: str
    folder: Path | None

    def path(self, scene: Scene, law: LossLaw) -> Path | None:
        """Where the life of a member is kept: a hash of all that it depends on."""
        if self.folder is None:
            return None
        about = {
            **circumstances(scene, choose_backend(self.backend, scene.run.method)),
            "settings": self.settings,
        }
        return self.folder / f"{name_of(scene, {**about, 'law': law.describe()})}.nc"


@dataclass(frozen=True)
class _Member:
    """What has come of a member."""

    ending: str
    sticks_by: float
    turning: float
    coverage: float
    windows: int
    status: str = "finished"
    message: str = ""


def _follow(member: tuple[Scene, LossLaw], common: _Common) -> _Member:
    """Follow the life of a member, or read it where it is kept."""
    scene, law = member
    path = common.path(scene, law)
    try:
        ds = life(
            scene,
            law,
            **common.settings,
            frequency=False,
            jobs=1,
            backend=common.backend,
            archive=path,
            resume=path is not None,
        )
    except SolverError as error:
        return _Member("unfinished", np.nan, np.nan, np.nan, 0, "failed", str(error))
    return _member(ds)


def _member(ds: xr.Dataset) -> _Member:
    last = ds.isel(passages=-1)
    turning = 0.0 if str(last["verdict"].values) == "sticks" else float(last["passages"])
    return _Member(
        str(ds.attrs["ending"]),
        float(ds.attrs.get("passages_to_sticking", np.nan)),
        turning,
        float(last["coverage"].mean()),
        int(ds.attrs["windows"]),
    )


def _check_settings(law: LossLaw, settings: Mapping[str, Any]) -> None:
    if not isinstance(law, LossLaw):
        raise SceneError("law", type(law).__name__, "must be a loss law, see gearidae.wear.loss_law")
    for name, value in settings.items():
        if name not in _SETTINGS:
            meant = did_you_mean(name, _SETTINGS)
            allowed = f"must be one of {', '.join(_SETTINGS)}{'; ' if meant else ''}{meant}"
            raise SceneError(name, value, allowed)


def _scenes(base: Scene, values: Mapping[str, Floats], size: int, texts: Mapping[str, str]) -> list[Scene]:
    """Scenes of the members; all alike if nothing but parameters of the law are drawn."""
    drawn = {key: column for key, column in values.items() if not key.startswith("law.")}
    return list(member_plan(base, drawn, texts).scenes) if drawn else [base] * size


def _dataset(
    base: Scene,
    law: LossLaw,
    distributions: Sequence[Distribution],
    values: Mapping[str, Floats],
    members: Sequence[_Member],
) -> xr.Dataset:
    """Put the members along one dimension."""
    columns = {
        "passages_to_sticking": [member.sticks_by for member in members],
        "passages_turning": [member.turning for member in members],
        "final_coverage": [member.coverage for member in members],
        "windows": [member.windows for member in members],
        "sticks": [
            np.nan if member.status == "failed" else float(member.ending == "sticks") for member in members
        ],
    }
    values_of: dict[str, Any] = {name: np.array(column) for name, column in columns.items()}
    values_of |= {
        name: [getattr(member, name) for member in members] for name in ("ending", "status", "message")
    }
    names = dimension_names(values)
    coords: dict[str, Any] = {
        names[drawn.key]: ("member", values[drawn.key], {"units": drawn.unit, "long_name": drawn.key})
        for drawn in distributions
    }
    attributes = {
        **provenance(base, f"followed {len(members)} lives", swept=tuple(values)),
        "title": f"{base.name}: lives of {len(members)} coatings",
        "summary": "Passages until gears stick whose keys were drawn from distributions, by cycle jump.",
        "swept": json.dumps({key: column.tolist() for key, column in values.items()}, allow_nan=False),
        "law": json.dumps(law.describe()),
        "law_source": law.source,
    }
    return STUDY.dataset({"member": np.arange(len(members)), **values_of}, attributes).assign_coords(coords)
