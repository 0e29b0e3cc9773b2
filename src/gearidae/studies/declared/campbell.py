"""Spectra of gears at many speeds, with meshes, shafts and the frequency of the contact: a Campbell diagram.

The drive holds each speed. Finished runs are kept beside the output, in OUT.nc.journal, until it is written.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import cycle, pairwise
from typing import TYPE_CHECKING, Annotated, Any, Final, NamedTuple, TypeAlias, Unpack

import numpy as np
import xarray as xr

from gearidae.analysis.ringing import HIGHEST
from gearidae.analysis.spectra import power_spectrum
from gearidae.archive.output_selection import read_keep
from gearidae.archive.provenance import provenance
from gearidae.archive.select import judged_teeth
from gearidae.archive.train import judged_view
from gearidae.arrays import Floats
from gearidae.errors import SceneError
from gearidae.runs.execution import RunOptions, prepared
from gearidae.runs.sweep_plan import SweepPlan
from gearidae.runs.sweeping import run_plan
from gearidae.scene import GearScene, TrainScene, is_long_train, require_gears, require_meshes
from gearidae.scene.joints import PIN_KEYS
from gearidae.scene.judged import judged_mesh, judged_shaft
from gearidae.scene.pairs import quantities, sweep_values
from gearidae.scene.quantity import whole
from gearidae.studies.study import Column, Option, Picture, Rows, Study

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from gearidae.runs.run_cache import RunCache
    from gearidae.scene import Scene

AnyGears: TypeAlias = GearScene | TrainScene
_MULTIPLES: Final = (1, 2, 3, 4)
_LEFT_OUT: Final = 0.2
"""Part of each run in which it settles."""
_HOLDS: Final = 30.0
"""Time constants of the speed in a run: six in what is left out, and each long against a period of the contact."""
_HIGHEST_MULTIPLE: Final = 1000
_ABOVE: Final = 1.3
"""Height of the picture over its highest line."""
_STYLES: Final = ("-", "-.", "--", ":")
"""Lines of the meshes of a train, one after the other."""
_WORDS: Final = {
    False: {"shaft": "pinion", "contact": "frequency of one pair"},
    True: {"shaft": "drive's shaft", "contact": "highest natural frequency"},
}
"""What columns name, of pairs and of trains."""


def campbell(
    scene: Scene,
    speeds: Sequence[Any],
    *,
    variable: str = "gear_speed",
    multiples: Sequence[int] = _MULTIPLES,
    **options: Unpack[RunOptions],
) -> xr.Dataset:
    r"""Spectra at many speeds, and where multiples of the mesh frequency meet the frequency of the contact.

    At each speed a run begins with it. In place of ``drive.torque``, ``drive.schedule`` and ``drive.law`` the drive has
    the torque that the load takes there, and holds the speed by ``drive.speed_gain``: the scene's own, or one that
    takes a thirtieth of the run, slow against the contact. Harmonics and static errors stay; they and the mesh are what
    excites the gears. The first fifth of each run is left out.

    Parameters
    ----------
    scene : Scene
        With gears, a pair or a train, and samples; ``run.samples = "ringing"`` takes as many as show the contact.
    speeds : sequence
        Of the pinion, of a train those of the drive's shaft [rad/s], two or more, or texts with a unit (``"300 rpm"``).
    variable : str, optional
        Sampled variable whose spectra are taken; of a train that of the judged shaft, or of the mesh that drives it.
    multiples : sequence of int, optional
        Multiples of the mesh frequency whose crossings with that of the contact are looked for.
    **options
        ``executor``, ``jobs``, ``backend``, ``progress``, ``archive``, ``overwrite`` and ``resume``, as for
        `gearidae.sweep`.

    Returns
    -------
    Dataset, dims (speed, frequency)
        ``density``, the power spectral density (Welch's method, segments of half what is left, mean taken out) [unit of
        the variable squared per Hz]. Along ``speed`` [rad/s]: ``mean_speed`` [rad/s] that the pinion has had,
        ``mesh_frequency`` [Hz] at it, ``contact_frequency`` [Hz] of one pair under the torque at that speed
        (`contact_resonance`; NaN without a torque), ``rms`` of the variable about its mean, ``peak_frequency`` [Hz] of
        the strongest line, ``verdict``. Along ``multiple``: ``critical_speed`` [rad/s] of the pinion at which this
        multiple of the mesh frequency meets the contact's, between two of the speeds; NaN if it does not. The attribute
        ``note`` says where lines may be aliases.

        Of a train, whose pinion is the drive's shaft, these are of the mesh that drives the judged shaft and of the
        highest natural frequency. Besides there are ``mesh_frequencies`` (mesh, speed), ``natural_frequencies`` (mode,
        speed) of the whole train at rest under the torque at that speed, with one pair in each mesh, rising, and
        ``critical_speeds`` (mesh, mode, multiple); ``shaft_ratio`` is the speed of each shaft over that of the drive's.

    Raises
    ------
    SceneError
        If the scene is a roller or has no samples, or a speed, a multiple, the variable or a setting is not allowed.
    Interrupted
        On Ctrl-C; finished runs are kept beside the archive.

    Examples
    --------
    >>> import gearidae as gd
    >>> scene = gd.preset("teodorescu2009_low_speed")
    >>> found = gd.studies.campbell(scene, ["40 rpm", "60 rpm", "80 rpm"])  # doctest: +SKIP
    >>> ax = gd.plot.campbell(found)  # doctest: +SKIP
    """
    ringing = scene.run.samples == "ringing"  # of the held speeds, which the scene itself does not have
    base, execution = prepared(require_meshes(scene), options, samples=2 if ringing else None, trains=True)
    held = _speeds(speeds)
    crossed = [whole("multiples", multiple, 1, _HIGHEST_MULTIPLE) for multiple in multiples]
    if base.run.sample_count < 2:
        raise SceneError("run.samples", base.run.samples, "must be a number: spectra need samples")
    try:
        selection = read_keep(sorted({variable, "gear_speed"}), base)
    except SceneError as error:
        raise SceneError("variable", variable, error.allowed) from None
    if variable not in selection.columns(base):
        raise SceneError("variable", variable, f"must be sampled: one of {', '.join(_sampled(base))}")
    base, plan = _plan(base, held, ringing=ringing)

    def work(kept: RunCache | None) -> xr.Dataset:
        runs = run_plan(plan, execution, kept, selection)
        return _dataset(scene, plan, runs, variable, crossed)

    settings = [held.tolist(), variable, crossed]
    return STUDY.compute(
        execution, base, work, settings, origin=scene, selection=selection, scenes=plan.scenes
    )


def _sampled(scene: Scene) -> tuple[str, ...]:
    return read_keep(("samples",), scene).columns(scene)


def _speeds(speeds: Sequence[Any]) -> Floats:
    """Speeds of the pinion in rising order [rad/s]."""
    values = quantities("speeds", speeds, "rad/s")
    if not np.isfinite(values).all() or np.unique(values).size < 2 or values.min() <= 0.0:
        raise SceneError("speeds", str(speeds)[:60], "must be two speeds or more above 0 rad/s")
    return np.unique(values)


def _plan(base: AnyGears, speeds: Floats, *, ringing: bool) -> tuple[AnyGears, SweepPlan]:
    """Make the scenes in which the drive holds each speed, and the one that they were made of."""
    from gearidae.runs.train_statics import (
        ratios,
        resistances,
    )  # compiled code, which readers of files do without

    train, ratio = base.train, ratios(base.train)
    dry, viscous, drag = resistances(base)
    inertia = float(np.array([shaft.inertia for shaft in train.shafts]) @ ratio**2)
    gain = base.drive.speed_gain or _HOLDS * inertia / base.run.duration
    base = base.replace(
        {
            "drive.torque": 0.0,
            "drive.schedule": [],
            "drive.law": None,
            "drive.orientation": 0.0,
            "drive.pin_radius": 0.0,
            **{f"drive.{key}": None for key in PIN_KEYS},
            "drive.speed": float(speeds[0]),
            "drive.speed_gain": gain,
            "run.stop": "time",
        }
    )
    taken = float(dry @ ratio) + float(viscous @ ratio**2) * speeds + float(drag @ ratio**3) * speeds**2
    axis: dict[str, list[Any]] = {
        "drive.speed": speeds.tolist(),
        "drive.torque": taken.tolist(),
        "initial.gear_speed": (speeds * ratio[train.load]).tolist(),
    }
    if ringing:
        from gearidae.runs.ringing_samples import counted  # compiled code likewise

        base = base.replace({"run.samples": counted(_held(base.replace({"run.samples": "ringing"}), axis))})
    return base, SweepPlan(base, (axis,), _held(base, axis))


def _held(base: AnyGears, axis: Mapping[str, Sequence[Any]]) -> list[Scene]:
    """Scenes with the values of an axis."""
    return [base.replace(dict(zip(axis, row, strict=True))) for row in zip(*axis.values(), strict=True)]


def _dataset(
    scene: Scene, plan: SweepPlan, runs: xr.Dataset, variable: str, multiples: Sequence[int]
) -> xr.Dataset:
    from gearidae.runs.train_statics import ratios

    base = require_meshes(plan.base)
    train, ratio = base.train, ratios(base.train)
    teeth = judged_teeth(base.to_dict())
    judged, mesh = (train.load, 0) if isinstance(base, GearScene) else (judged_shaft(base), judged_mesh(base))
    settled = judged_view(runs).isel(time=slice(round(_LEFT_OUT * runs.sizes["time"]), None))
    density = power_spectrum(settled[[variable]], variable)
    ended = runs["status"].values == "finished"
    mean = np.where(ended, settled["gear_speed"].mean("time").values, np.nan) / ratio[judged]
    meshes = np.array([m.geometry.pinion_teeth * ratio[m.a] for m in train.meshes])[:, None] * mean
    meshes /= 2.0 * math.pi
    modes = np.stack([_frequencies(member) for member in plan.scenes], axis=1)
    spectra = density.values
    # below the second bin there is what is left of the mean
    peaks = density["frequency"].values[2:][np.nan_to_num(spectra[:, 2:]).argmax(axis=1)]
    speeds = np.array(plan.axes[0]["drive.speed"])
    crossings = np.array(
        [[[_crossing(speeds, n * line, mode) for n in multiples] for mode in modes] for line in meshes]
    )
    columns = {
        "speed": speeds,
        "frequency": density["frequency"].values,
        "multiple": np.array(multiples, dtype=np.int64),
        "density": spectra,
        "mean_speed": mean,
        "mesh_frequency": meshes[mesh],
        "contact_frequency": modes[-1],
        "rms": np.where(ended, settled[variable].std("time").values, np.nan),
        "peak_frequency": np.where(np.isfinite(spectra[:, 2:]).all(axis=1), peaks, np.nan),
        "verdict": runs["verdict"].values,
        "critical_speed": crossings[mesh, -1],
    }
    if is_long_train(base):
        columns |= {
            "mesh": np.array([m.name for m in train.meshes]),
            "mode": np.arange(1, len(modes) + 1),
            "shaft": np.array([shaft.name for shaft in train.shafts]),
            "shaft_ratio": ratio,
            "mesh_frequencies": meshes,
            "natural_frequencies": modes,
            "critical_speeds": crossings,
        }
    rate, highest = float(density.attrs["sampling_rate"]), np.nanmax(np.append(modes, 0.0))
    note = (
        f"the contact's frequency, {highest:.4g} Hz, is above what samples at {rate:.4g} Hz show: lines may be "
        'aliases; run.samples = "ringing" takes enough'
    )
    attributes = {
        **provenance(base, "took spectra at many speeds", swept=("drive.speed",)),
        "title": f"{scene.name}: Campbell diagram of {variable}",
        "summary": "Power spectral density at many speeds, frequencies of mesh and contact, and where they meet.",
        "variable": variable,
        "resolution": density.attrs["resolution"],
        "pinion_teeth": teeth.pinion_teeth,
        "gear_teeth": teeth.gear_teeth,
        **({"note": note} if highest > HIGHEST * rate else {}),
    }
    units = str(runs[variable].attrs["units"])
    return STUDY.dataset(
        columns,
        attributes,
        units=units,
        density_units=str(density.attrs["units"]),
        variable=variable,
        **_WORDS[is_long_train(base)],
    )


def _frequencies(scene: Scene) -> Floats:
    """Frequency of one pair under the torque of a member, or those of a train, rising [Hz]; NaN without any."""
    if is_long_train(scene):
        from gearidae.mesh.train_modes import natural_frequencies
        from gearidae.runs.train_statics import mesh_forces

        found = natural_frequencies(scene, mesh_forces(scene))
        return np.array([math.nan] * (len(scene.train.shafts) - 1 - len(found)) + found)
    from gearidae.runs.equilibrium import contact_resonance
    from gearidae.runs.estimates import mean_drive_torque

    gears = require_gears(scene)
    return np.array([contact_resonance(gears) if mean_drive_torque(gears) > 0.0 else math.nan])


def _crossing(speeds: Floats, mesh: Floats, contact: Floats) -> float:
    """Lowest speed at which two frequencies meet, by straight lines between the speeds; NaN if they do not."""
    known = np.isfinite(mesh) & np.isfinite(contact)
    for (low, below), (high, above) in pairwise(zip(speeds[known], (mesh - contact)[known], strict=True)):
        if below <= 0.0 <= above or above <= 0.0 <= below:
            return float(low + (high - low) * below / (below - above)) if above != below else float(low)
    return math.nan


def _written(
    *,
    speeds: Annotated[
        str,
        Option(
            "Speeds of the pinion, or the drive's shaft: '4:12:0.5 rad/s', or '40 rpm,60 rpm'; numbers are rad/s."
        ),
    ],
) -> dict[str, Any]:
    return {"speeds": _speeds(sweep_values([f"speeds={speeds}"])["speeds"]).tolist()}


def _announced(scene: Scene, _: int | None, *, speeds: Sequence[float], **__: Any) -> str:
    train = require_meshes(scene).train
    shaft = train.shafts[train.drive].name if is_long_train(scene) else "the pinion"
    return f"{len(speeds)} runs, speeds of {shaft} from {speeds[0]:.4g} to {speeds[-1]:.4g} rad/s"


class _Lines(NamedTuple):
    """Frequencies of a diagram by what they are called, shapes (speeds,), and where they meet.

    Attributes
    ----------
    meshes, contacts, turns : dict of str to ndarray
        Mesh frequencies, natural frequencies of the contacts, turns of the shafts.
    met : list of (str, str, int, float)
        Mesh and contact by their names, the multiple and the speed; NaN where they do not meet.
    shaft : str
        Whose speeds are held, in words.
    """

    meshes: dict[str, Floats]
    contacts: dict[str, Floats]
    turns: dict[str, Floats]
    met: list[tuple[str, str, int, float]]
    shaft: str


def _lines(ds: xr.Dataset) -> _Lines:
    """Take the lines of a diagram, of a pair or of a train."""
    multiples = ds["multiple"].values.tolist()
    if "mode" not in ds.coords:
        mesh, contact = ds["mesh_frequency"].values, ds["contact_frequency"].values
        turns = {name: mesh / int(ds.attrs[f"{name}_teeth"]) for name in ("pinion", "gear")}
        met = [
            ("mesh", "contact", *pair) for pair in zip(multiples, ds["critical_speed"].values, strict=True)
        ]
        return _Lines({"mesh": mesh}, {"contact": contact}, turns, met, "the pinion")
    together = _alike(ds["mesh"].values.tolist(), ds["mesh_frequencies"].values)
    words = {number: f"mesh {' and '.join(names)}" for number, names in together.items()}
    modes = [f"natural frequency {mode}" for mode in ds["mode"].values]
    turning = ds["mean_speed"].values / (2.0 * math.pi)
    ratio = dict(zip(ds["shaft"].values.tolist(), ds["shaft_ratio"].values.tolist(), strict=True))
    met = [
        (name, mode, multiple, speed)
        for number, name in words.items()
        for mode, row in zip(modes, ds["critical_speeds"].values[number], strict=True)
        for multiple, speed in zip(multiples, row.tolist(), strict=True)
    ]
    return _Lines(
        {name: ds["mesh_frequencies"].values[number] for number, name in words.items()},
        dict(zip(modes, ds["natural_frequencies"].values, strict=True)),
        {name: turning * over for name, over in ratio.items()},
        met,
        next(name for name, over in ratio.items() if over == 1.0),
    )


def _alike(names: Sequence[str], frequencies: Floats) -> dict[int, list[str]]:
    """Meshes whose frequency is the same, as those of an idler: names by the number of the first of them."""
    together: dict[int, list[str]] = {}
    for number, name in enumerate(names):
        same = [
            k for k in together if np.allclose(frequencies[k], frequencies[number], rtol=1e-9, equal_nan=True)
        ]
        together.setdefault(same[0] if same else number, []).append(name)
    return together


def _sentence(ds: xr.Dataset) -> str:
    low, high = (float(ds["speed"][options]) for options in (0, -1))
    lines = _lines(ds)
    met = [(*names, multiple, speed) for *names, multiple, speed in lines.met if math.isfinite(speed)]
    span = f"From {low:.4g} to {high:.4g} rad/s of {lines.shaft} "
    if "mode" in ds.coords:
        found = [
            f"{multiple} times {mesh} meets {mode} at {speed:.4g} rad/s"
            for mesh, mode, multiple, speed in met
        ]
        none = f"no multiple up to {int(ds['multiple'].max())} of a mesh frequency meets a natural frequency"
        return f"{span}{', '.join(found) if found else none}."
    where = "the mesh frequency meets that of the contact "
    none = f"no multiple up to {int(ds['multiple'].max())} of {where.strip()}"
    return f"{span}{where + ', '.join(f'{n} times at {speed:.4g} rad/s' for *_, n, speed in met) if met else none}."


def _rows(ds: xr.Dataset) -> Rows:
    """A line for each speed, then the crossings."""
    yield str(ds.attrs["title"]), "", ""
    units, lines = str(ds["rms"].attrs["units"]).replace("rad s-1", "rad/s"), _lines(ds)
    for number, speed in enumerate(ds["speed"].values.tolist()):
        run = ds.isel(speed=number)
        named = [
            f"{name} {_hertz(line[number])}" for name, line in {**lines.meshes, **lines.contacts}.items()
        ]
        yield (
            f"{speed:.4g} rad/s",
            f"rms {float(run['rms']):.3g} {units}",
            f"strongest line {_hertz(run['peak_frequency'])}, {', '.join(named)}; {run['verdict'].item()}",
        )
    for mesh, contact, multiple, speed in lines.met:
        met, shown = f"{speed:.4g} rad/s" if math.isfinite(speed) else "not at these speeds", True
        if "mode" in ds.coords:  # of a train, whose pairs of lines are many, those that meet
            shown = math.isfinite(speed)
        if shown:
            yield f"{multiple} x {mesh} meets {'the contact' if contact == 'contact' else contact}", met, ""
    if "note" in ds.attrs:
        yield "aliases", "possible", str(ds.attrs["note"])


def _hertz(value: xr.DataArray | float) -> str:
    return f"{float(value):.4g} Hz" if math.isfinite(float(value)) else "unknown"


def picture(ds: xr.Dataset, ax: Axes | None = None, *, highest: float | None = None) -> Axes:
    """Draw the spectra over the speed, with multiples of the mesh, the shafts and the contact as lines.

    Parameters
    ----------
    ds : xarray.Dataset
        From `gearidae.studies.campbell`.
    ax : matplotlib Axes, optional
        Where to draw; by default in a figure of its own.
    highest : float, optional
        Highest frequency to be shown [Hz]; by default somewhat above the contact and the multiples.

    Returns
    -------
    Axes
        With a circle where a multiple of the mesh frequency meets the contact's.

    Raises
    ------
    SceneError
        If the dataset is something else.
    """
    from gearidae.drawing.density import draw_density, is_apart, legend_on_density, line_on_density
    from gearidae.drawing.style import label_axis, line_colour, line_width, new_axes

    STUDY.require(ds)
    ax = new_axes(ax, height=4.4)
    speed, lines = ds["speed"].values, _lines(ds)
    multiples = ds["multiple"].values.tolist()
    if highest is None:
        known = np.concatenate(
            [*lines.contacts.values(), *(max(multiples) * m for m in lines.meshes.values())]
        )
        known = known[np.isfinite(known)]
        highest = _ABOVE * float(known.max()) if known.size else math.inf
    shown = ds.sel(frequency=slice(0.0, highest))
    units = str(ds["density"].attrs["units"]).replace("rad s-1", "rad/s").replace(")2 Hz-1", ")²/Hz")
    draw_density(ax, speed, shown["frequency"].values, shown["density"].values.T, units)
    top = float(shown["frequency"][-1])
    for (name, mesh), style in zip(lines.meshes.items(), cycle(_STYLES)):
        for number, multiple in enumerate(multiples):
            line_on_density(ax, speed, multiple * mesh, "" if number else f"{name} and multiples", style)
            if multiple * mesh[-1] < top:
                options: dict[str, Any] = {"xytext": (-2, 3), "textcoords": "offset points", "ha": "right"}
                ax.annotate(
                    f"{multiple}",
                    (speed[-1], multiple * mesh[-1]),
                    **options,
                    color="white",
                    fontsize="x-small",
                )
    for (name, line), style in zip(lines.turns.items(), cycle(("--", ":"))):
        if is_apart(line, top):
            line_on_density(ax, speed, line, name, style)
    for number, (name, line) in enumerate(lines.contacts.items()):
        ax.plot(speed, line, color=line_colour(4 + number), linewidth=line_width(1.6), label=name)
    met = [
        (at, np.interp(at, speed, lines.contacts[name])) for _, name, _, at in lines.met if math.isfinite(at)
    ]
    at, frequency = np.array(met).reshape(-1, 2).T
    ax.plot(at, frequency, "o", color=line_colour(1), fillstyle="none", label="_met")
    ax.set_ylim(0.0, top)
    label_axis(ax.yaxis, "frequency", "Hz")
    ax.set_xlabel(f"speed of {lines.shaft} (rad/s)")
    if "note" in ds.attrs:
        ax.set_title(str(ds.attrs["note"]).replace("; ", ";\n"), fontsize="x-small", loc="left")
    legend_on_density(ax, "x-small")
    return ax


_SPEED: Final = ("speed",)
STUDY = Study(
    kind="campbell",
    words="Campbell diagram",
    maker="campbell",
    title="Campbell diagram",
    command=_written,
    options=("variable", "multiples"),
    announcement=_announced,
    examples=("gearidae campbell low_speed --speeds '4:12:0.5 rad/s'",),
    columns={
        "speed": Column(_SPEED, "rad s-1", "speed of the {shaft} that is held"),
        "frequency": Column(("frequency",), "Hz", "frequency"),
        "multiple": Column(("multiple",), "1", "multiple of the mesh frequency"),
        "density": Column(("speed", "frequency"), "{density_units}", "power spectral density of {variable}"),
        "mean_speed": Column(_SPEED, "rad s-1", "mean speed of the {shaft}"),
        "mesh_frequency": Column(_SPEED, "Hz", "mesh frequency at the mean speed"),
        "contact_frequency": Column(_SPEED, "Hz", "{contact} under the torque at the speed"),
        "rms": Column(_SPEED, "{units}", "root of the mean square of {variable} about its mean"),
        "peak_frequency": Column(_SPEED, "Hz", "frequency of the strongest line"),
        "verdict": Column(_SPEED, "", "verdict of the run"),
        "critical_speed": Column(
            ("multiple",),
            "rad s-1",
            "speed at which the multiple of the mesh frequency meets that of the contact",
        ),
        "mesh": Column(("mesh",), "", "name of the mesh", required=False),
        "mode": Column(("mode",), "1", "number of the natural frequency", required=False),
        "shaft": Column(("shaft",), "", "name of the shaft", required=False),
        "shaft_ratio": Column(("shaft",), "1", "speed of the shaft over that of the drive's", required=False),
        "mesh_frequencies": Column(
            ("mesh", "speed"), "Hz", "mesh frequency at the mean speed", required=False
        ),
        "natural_frequencies": Column(
            ("mode", "speed"),
            "Hz",
            "natural frequency of the train under the torque at the speed",
            required=False,
        ),
        "critical_speeds": Column(
            ("mesh", "mode", "multiple"),
            "rad s-1",
            "speed at which the multiple of the mesh frequency meets the natural frequency",
            required=False,
        ),
    },
    sentence=_sentence,
    rows=_rows,
    pictures=(Picture("campbell", "Spectra over the speed, with mesh, shafts and contact", draw=picture),),
)
