"""States of every pair of teeth at chosen times, as far as a record allows.

The gap of every pair follows from the recorded motion, the history of its asperities from the gaps it went through, and
from both the force of every pair and whether its asperities stretch. What is not recorded is how far the bodies gave
way. Where they did (the elastic model), or where samples lie too far apart, the forces of the pairs do not add up to
the recorded one; then only gaps are given, and neither forces nor states.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from gearidae.archive.pieces import pieces
from gearidae.archive.select import is_roller, motion_samples, run_scene, runs, swept_dims
from gearidae.arrays import Floats
from gearidae.contact.kernels.law import H_STRETCH, law_value
from gearidae.engine.setup.build import make_problem
from gearidae.errors import SceneError
from gearidae.mesh.involute import curvature_radii
from gearidae.records import Flank
from gearidae.scene import GearScene, require_gears
from gearidae.scene.carried import numbers_of
from gearidae.scene.coating import interface_shares
from gearidae.scene.coating_table import fraction_at, met_teeth
from gearidae.studies.equilibrium import MaterialLaw, material_laws
from gearidae.studies.joined_asperities import JoinedAsperities
from gearidae.studies.tooth_record import ToothRecord, joined_heights
from gearidae.studies.tooth_states import ContactState, MeshState, ToothContact

Integers = NDArray[np.int64]

AGREEMENT = 0.1
"""Forces and states of pairs are given if the sum of the forces misses the recorded one by no more than this part of
their magnitudes, or of the load that the scene is about."""
_LONGEST_STRETCH = 400_000
"""Samples looked at together, or looked back upon, at most; forces of pairs that came near earlier will not add up."""
_JUST = 1e-6  # of the stretch limit: nearer to either end of the stretch is at that end


@dataclass(frozen=True, slots=True)
class _Limits:
    """Limits that separate contact from separation, in SI units."""

    cutoff: float
    engage: float
    reach: float
    load: float


@dataclass(frozen=True, slots=True)
class _Near:
    """One pair at those of the wanted samples at which it counts."""

    pair: int
    flank: Flank
    wanted: Integers
    sample: Integers
    place: Floats
    radius: Floats
    gap: Floats


@dataclass(frozen=True, slots=True)
class _Followed:
    """The same with its history."""

    near: _Near
    joined: dict[str, Floats]
    force: Floats


def tooth_contacts(ds: xr.Dataset, times: ArrayLike) -> list[MeshState]:
    """Find the states of the pairs of teeth at some times of a run.

    Parameters
    ----------
    ds : xarray.Dataset
        One run of a gear pair; from a sweep, one selected with ``sel``.
    times : array_like
        Times [s]; the nearest samples are taken. Infinite: the last one.

    Returns
    -------
    list of MeshState
        One for each time, in the order given.

    Raises
    ------
    SceneError
        If the dataset is of a roller, of several runs, or has no samples, or a time lies outside of them.

    Notes
    -----
    The force of a pair is found from its own history since it came near. The recorded force of all pairs has no part
    in it and serves as the check. A turning point of a gap between two samples is known where an event gives its
    time; the gap there is interpolated with the recorded rates.
    """
    run = _one_run(ds)
    scene = require_gears(run_scene(run))
    limits = _limits(scene)
    wanted = _nearest(run, np.atleast_1d(numbers_of(times, "s")))
    order = np.argsort(wanted, kind="stable")
    states: dict[int, MeshState] = {}
    real = JoinedAsperities(run, scene) if scene.contact.is_discrete else None
    stretches = _stretches(run, scene, wanted[order], limits.reach)
    for (samples, events), mine in stretches:
        record = ToothRecord(run, scene, samples, events)
        found = _states(record, scene, limits, wanted[order[mine]] - samples.start, real)
        states |= dict(zip(order[mine].tolist(), found, strict=True))
    return [states[k] for k in range(len(wanted))]


def _one_run(ds: xr.Dataset) -> xr.Dataset:
    """Return the dataset as a single run with its own events."""
    if is_roller(ds):
        raise SceneError("dataset", "a roller", "must be of a gear pair: a roller has no teeth")
    if dims := swept_dims(ds):
        raise SceneError(
            "dataset",
            f"{ds.sizes[dims[0]]} runs",
            f"must be a single run: select one, as ds.isel({dims[0]}=0) or --select {dims[0]}=... do",
        )
    if not motion_samples(ds):
        raise SceneError("dataset", "transmission_error", "the dataset has no samples of it")
    return next(run for _, run in runs(ds))


def _nearest(run: xr.Dataset, wanted: Floats) -> Integers:
    """Return which samples are nearest to some times; samples are evenly spaced."""
    last = motion_samples(run) - 1
    end = float(run["time"][last])
    step = end / last if last > 0 else 1.0
    wanted = np.where(wanted == math.inf, end, wanted)
    for one in wanted:
        if not -step <= one <= end + step:
            raise SceneError("time", float(one), f"must lie in the record, 0..{end:g} s")
    return np.clip(np.rint(wanted / step).astype(np.int64), 0, last)


def _stretches(
    run: xr.Dataset, scene: GearScene, at: Integers, reach: float
) -> list[tuple[tuple[slice, slice], slice]]:
    """Divide samples, in increasing order, into stretches that begin before any of their pairs came near.

    Returns
    -------
    list of tuple
        Slice of the samples and slice of the events to read, and which of `at` they serve.
    """
    geometry = scene.geometry
    # the gear has gone so far since a pair came within reach that it is out of reach again
    travel = (geometry.path_length + 2.0 * reach + geometry.base_pitch) / geometry.base_radius_gear
    firsts: list[int] = []
    counts: list[int] = []
    for k, sample in enumerate(at.tolist()):
        if firsts:
            first, before = firsts[-1], int(at[k - 1])
            if sample - before <= before - first and sample - first <= _LONGEST_STRETCH:
                counts[-1] += 1
                continue
        firsts.append(_look_back(run["gear_angle"], sample, travel))
        counts.append(1)
    ends = np.cumsum(counts)
    samples = [slice(first, int(at[end - 1]) + 1) for first, end in zip(firsts, ends, strict=True)]
    bounds = [float(run["time"][place]) for cut in samples for place in (cut.start, cut.stop - 1)]
    passed = np.zeros(len(bounds), dtype=np.int64)
    for _, part in pieces(run["event_time"]):
        passed += np.searchsorted(part, bounds, side="right")
    events = [slice(int(a), int(b)) for a, b in passed.reshape(-1, 2)]
    mine = [slice(int(end) - count, int(end)) for end, count in zip(ends, counts, strict=True)]
    return list(zip(zip(samples, events, strict=True), mine, strict=True))


def _look_back(angle: xr.DataArray, sample: int, travel: float) -> int:
    """Return the last sample at which the gear stood further than `travel` from where it stands, or the first."""
    here = float(angle[sample])
    step, end = 4096, sample
    while end > 0 and sample - end < _LONGEST_STRETCH:
        start = max(end - step, 0)
        far = np.flatnonzero(np.abs(angle.variable[start:end].values - here) > travel)
        if far.size:
            return start + int(far[-1])
        end, step = start, 2 * step
    return end


def _states(
    record: ToothRecord, scene: GearScene, limits: _Limits, wanted: Integers, real: JoinedAsperities | None
) -> list[MeshState]:
    """Return the states at some samples of a stretch, counted from its first."""
    contacts: list[list[ToothContact]] = [[] for _ in wanted]
    if real is not None:
        for near in _near(record, scene, limits, wanted):
            pull = _attraction(scene, near)
            for k, place in enumerate(near.wanted):
                contacts[place].append(_real_contact(record, near, k, real, limits.cutoff, float(pull[k])))
    else:
        stretches = {name: _stretch_limit(law, scene) for name, law in material_laws(scene).items()}
        for pair in _followed(record, scene, limits, wanted):
            for k, place in enumerate(pair.near.wanted):
                contacts[place].append(_contact(pair, k, limits, stretches))
    states = []
    for at, found in zip(wanted, contacts, strict=True):
        total = float(record.mesh_force[at])
        mismatch = sum(one.force * (1 if one.flank == Flank.DRIVE else -1) for one in found) - total
        recovered = real is None or real.recovered
        recovered &= abs(mismatch) <= AGREEMENT * max(sum(abs(one.force) for one in found), limits.load)
        states.append(
            MeshState(
                time=float(record.time[at]),
                travel=float(record.travel[at]),
                transmission_error=float(record.u[at]),
                gear_speed=float(record.gear_speed[at]),
                mesh_force=total,
                mismatch=mismatch,
                recovered=recovered,
                contacts=tuple(found if recovered else map(_unrecoverable, found)),
            )
        )
    return states


def _limits(scene: GearScene) -> _Limits:
    """Take from the engine what it takes for contact."""
    constants, sigma = make_problem(scene).model.scene, scene.surface.roughness
    return _Limits(
        cutoff=float(constants.cutoff) * sigma,
        engage=float(constants.contact_gap) * sigma,
        reach=float(constants.reach) * scene.geometry.base_pitch,
        load=float(constants.force_unit),
    )


def _near(record: ToothRecord, scene: GearScene, limits: _Limits, wanted: Integers) -> Iterator[_Near]:
    """Find every pair that is on its path, or near enough for a force, at one of the wanted samples."""
    order = np.argsort(wanted, kind="stable")
    at = wanted[order]
    geometry = scene.geometry
    for flank in (Flank.DRIVE, Flank.COAST):
        # the place of pair n is that of pair 0, less (drive) or more (coast) n pitches
        pitches = record.place(flank, 0, record.travel[at]) / geometry.base_pitch
        sign = 1 if flank == Flank.DRIVE else -1
        low, high = (
            -limits.reach / geometry.base_pitch,
            geometry.contact_ratio + limits.reach / geometry.base_pitch,
        )
        ends = np.sort(np.stack([sign * (pitches - high), sign * (pitches - low)]), axis=0).T
        for pair in sorted({n for a, b in ends for n in range(math.ceil(a), math.floor(b) + 1)}):
            place = record.place(flank, pair, record.travel[at])
            gap = record.gap(flank, place, record.u[at])
            counts = ((place >= 0.0) & (place <= geometry.path_length)) | (gap < limits.cutoff)
            if not counts.any():
                continue
            place, gap, here = place[counts], gap[counts], at[counts]
            yield _Near(pair, flank, order[counts], here, place, curvature_radii(geometry, place)[2], gap)


def _followed(
    record: ToothRecord, scene: GearScene, limits: _Limits, wanted: Integers
) -> Iterator[_Followed]:
    """Follow every pair that counts at one of the wanted samples."""
    laws = material_laws(scene)
    for near in _near(record, scene, limits, wanted):
        ends = int(near.sample[0]), int(near.sample[-1])
        start, gaps, places = record.path_to(near.flank, near.pair, ends, limits.reach)
        joined = {
            name: joined_heights(gaps, places[near.sample - start], _stretch_limit(law, scene))
            for name, law in laws.items()
        }
        ratios = _share_ratios(scene, near.flank, near.pair, near.place)
        force = _force(scene, laws, near.gap, joined, near.radius, ratios) + _attraction(scene, near)
        force[near.gap >= limits.cutoff] = 0.0
        yield _Followed(near, joined, force)


def _attraction(scene: GearScene, near: _Near) -> Floats:
    """Attraction of a pair across its gap [N], apart from its asperities."""
    total = np.zeros_like(near.gap)
    if scene.attracts:
        ratios = _share_ratios(scene, near.flank, near.pair, near.place)
        for name, law in material_laws(scene).items():
            total += ratios[name] * law.attraction(near.gap, near.radius, scene)
    return total


def _real_contact(
    record: ToothRecord, near: _Near, k: int, real: JoinedAsperities, cutoff: float, pull: float
) -> ToothContact:
    """Contact of a pair with real asperities at the k-th of its samples, which is pulled across its gap besides."""
    pair, flank, place, gap = near.pair, near.flank, float(near.place[k]), float(near.gap[k])
    travel, error = (np.array([number]) for number in real.first_motion)
    first = record.place(flank, pair, travel)
    opened = float(record.gap(flank, first, error)[0])
    joined = np.empty(0, np.int64)
    if gap < cutoff:
        joined = real.of(pair, flank, float(record.time[near.sample[k]]), (float(first[0]), opened))
    overlaps, loads, names = real.loads(pair, flank, joined, place, gap)
    states = {
        name: ContactState.PARTLY_STRETCHED
        if min(overlaps[n] for n in range(len(names)) if names[n] == name) < 0.0
        else ContactState.LOADING
        for name in names
    }
    return ToothContact(
        pair,
        flank,
        place,
        float(near.radius[k]),
        gap,
        float(loads.sum()) + (pull if gap < cutoff else 0.0),
        {},
        states or {"bare": ContactState.OPEN},
        tuple(joined.tolist()),
    )


def _stretch_limit(law: MaterialLaw, scene: GearScene) -> float:
    """How far the asperities of a part stretch [m]; 0 where that makes no difference to the force."""
    return float(law.table[H_STRETCH]) * scene.surface.roughness


def _share_ratios(scene: GearScene, flank: Flank, pair: int, place: Floats) -> dict[str, Floats]:
    """Shares of the materials of a pair over their means; ones where they do not change with tooth and place."""
    coating = scene.coating
    means = {one.name: one.share for one in scene.materials() if one.share > 0.0}
    if not coating.by_place:
        return {name: np.ones_like(place) for name in means}
    teeth = met_teeth(pair, coast=flank == Flank.COAST)
    along = place / scene.geometry.path_length
    fractions = [fraction_at(table, tooth, along) for table, tooth in zip(coating.tables, teeth, strict=True)]
    shares = interface_shares(coating.pairing, *fractions)
    return {name: shares[name] / mean for name, mean in means.items()}


def _force(
    scene: GearScene,
    laws: dict[str, MaterialLaw],
    gap: Floats,
    joined: dict[str, Floats],
    radius: Floats,
    ratios: dict[str, Floats],
) -> Floats:
    """Force of a pair without deflection of the bodies [N]; its materials' shares are `ratios` times their means."""
    sigma = scene.surface.roughness
    total = np.zeros_like(gap)
    for name, law in laws.items():
        total += (
            law.scale
            * ratios[name]
            * np.array(
                [
                    law_value(law.table, g + law.offset, z + law.offset)[0]
                    for g, z in zip(gap / sigma, joined[name] / sigma, strict=True)
                ]
            )
        )
    return np.sqrt(2.0 * radius * sigma) * total


def _contact(pair: _Followed, k: int, limits: _Limits, stretches: dict[str, float]) -> ToothContact:
    near = pair.near
    gap = float(near.gap[k])
    joined = {name: float(heights[k]) for name, heights in pair.joined.items()}
    states = {}
    for name, limit in stretches.items():
        stretch = gap - joined[name]
        if gap >= limits.engage:
            states[name] = ContactState.OPEN
        elif stretch <= _JUST * limit:
            states[name] = ContactState.LOADING
        elif stretch < (1.0 - _JUST) * limit:
            states[name] = ContactState.PARTLY_STRETCHED
        else:
            states[name] = ContactState.FULLY_STRETCHED
    return ToothContact(
        near.pair,
        near.flank,
        float(near.place[k]),
        float(near.radius[k]),
        gap,
        float(pair.force[k]),
        joined,
        states,
    )


def _unrecoverable(contact: ToothContact) -> ToothContact:
    """Keep of a contact what the record holds: its gap, and whether it is open."""
    states = {
        name: state if state == ContactState.OPEN else ContactState.UNRECOVERABLE
        for name, state in contact.states.items()
    }
    unknown = dict.fromkeys(contact.joined, math.nan)
    return ToothContact(
        contact.pair, contact.flank, contact.place, contact.radius, contact.gap, math.nan, unknown, states
    )
