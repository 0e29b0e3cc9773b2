"""What a height map says about the rough contact, for a cut-off wavelength that the user chooses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from gearidae.errors import SceneError
from gearidae.scene.dump import dump_keys
from gearidae.scene.group import shorten
from gearidae.scene.prefixes import with_prefix
from gearidae.scene.quantity import Quantity
from gearidae.surfaces.height_map import height_map
from gearidae.surfaces.remarks import remarks
from gearidae.surfaces.statistics import METHODS, asperities, statistics, usual_cutoffs

if TYPE_CHECKING:
    import xarray as xr

_LENGTH = Quantity(unit="m", at_least=1e-12, at_most=1.0)
_DIGITS = 4
"""Significant digits of the numbers that go into a scene: sampling leaves two or three."""
_STEEPEST = 10.0
"""Root mean square of the slopes from point to point that no surface has: measured ones are below 2."""


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredSurface:
    """A height map's numbers, and those of them that go into a scene.

    Attributes
    ----------
    statistics : xarray.Dataset
        Moments and asperities along ``cutoff`` [m], the asperities ``by`` summits and moments.
    cutoff : float or None
        Chosen cut-off wavelength [m]; None if the choice is still to be made.
    by : str
        Where roughness, density and radius are taken from: ``summits`` or ``moments``.
    both_flanks : bool
        Whether the roughness of both flanks is put into one.
    source : str
        Where the heights come from.
    asperities : xarray.Dataset or None
        The summits one by one at the chosen cut-off: ``along``, ``across``, ``height`` above their mean plane and
        ``radius`` [m] along ``asperity``.
    """

    statistics: xr.Dataset
    cutoff: float | None
    by: str
    both_flanks: bool
    source: str
    asperities: xr.Dataset | None = None

    @property
    def settings(self) -> dict[str, float | str]:
        """Keys of a scene with their values, for `Scene.replace`.

        Raises
        ------
        SceneError
            If no cut-off has been chosen, or too few summits are left at it.
        """
        values = {name: float(f"{value:.{_DIGITS}g}") for name, value in self._asperities().items()}
        return {
            f"surface.{name}": value for name, value in (values | {"provenance": self.provenance}).items()
        }

    @property
    def provenance(self) -> str:
        """How the numbers of the scene were made, in one line."""
        ds = self.statistics
        rows, columns = ds.attrs["points"]
        size = " x ".join(with_prefix(length, "m", 4) for length in ds.attrs["size"])
        flanks = "both flanks in one" if self.both_flanks else "one flank"
        words = (
            f"{self.source}: {rows} x {columns} points, {size}; cut-off wavelength "
            f"{with_prefix(self._chosen(), 'm', 4)}; by {self.by}; {flanks}"
            f"{'; rows aligned' if ds.attrs['rows_aligned'] else ''}"
        )
        return "".join(char if char.isprintable() else "_" for char in words)

    def asperity_list(self, along: str = "arc") -> str:
        """Write the summits as a list of asperities for ``contact.asperities``.

        Parameters
        ----------
        along : {"arc", "x"}
            Name of the positions along the columns' index: ``arc`` from the edge of the area that was analysed, for
            gears, ``x`` from its middle, for a roller.

        Returns
        -------
        str
            A table of comma-separated values with the columns ``arc [um]`` or ``x [um]``, ``height [nm]`` and
            ``radius [nm]``.

        Raises
        ------
        SceneError
            As for `settings`, and if both flanks are to be put into one, which has no summits of its own.
        """
        self._chosen()
        if self.both_flanks:
            raise SceneError(
                "both_flanks", True, "must be false: two flanks in one have no summits of their own"
            )
        assert self.asperities is not None
        ds = self.asperities
        if not ds.sizes["asperity"]:
            raise SceneError("cutoff", f"{self._chosen():.4g} m", "leaves no summit in this map")
        first = 0.5 * float(ds.attrs["length"]) if along == "x" else 0.0
        columns = (1e6 * (ds["along"].values - first), 1e9 * ds["height"].values, 1e9 * ds["radius"].values)
        rows = "".join(f"{s:.9g},{z:.9g},{r:.9g}\n" for s, z, r in zip(*columns, strict=True))
        return f"{along} [um],height [nm],radius [nm]\n{rows}"

    @property
    def remarks(self) -> tuple[str, ...]:
        """What to know before trusting the numbers, in sentences: holes, few summits, heights that are not Gaussian."""
        return remarks(self.statistics, self.cutoff)

    @property
    def planes(self) -> str:
        """Where the summits' mean plane lies, from which a scene's gaps count, in a sentence."""
        at = self.statistics.sel(cutoff=self._chosen(), by=self.by)
        height = float(at["summit_plane"])
        return (
            f"The summits' mean plane lies {with_prefix(height, 'm')} above the mean plane of the surface "
            f"({height / float(at['rms_height']):.2f} rms heights); initial.gap and mesh.backlash count from the "
            "summits' mean plane."
        )

    def fragment(self) -> str:
        """Write the part of a case file that follows from the map, with how it was made.

        Returns
        -------
        str
            Table ``[surface]`` of a case file, without the keys that no height map determines
            (modulus, surface energy).

        Raises
        ------
        SceneError
            As for `settings`.
        """
        settings = {key.removeprefix("surface."): value for key, value in self.settings.items()}
        attributes = self.statistics.attrs
        other = next(name for name in METHODS if name != self.by)
        lines = [
            f"Measured surface: {self.provenance}",
            f"Taken out: tilt {attributes['tilt_removed']:.3g}, curvature {attributes['curvature_removed']:.3g} 1/m.",
            f"By {other} instead: {_in_words(self._asperities(other))}.",
            self.planes,
            *self.remarks,
        ]
        return "".join(f"# {line}\n" for line in lines) + dump_keys("surface", settings)

    def _chosen(self) -> float:
        if self.cutoff is None:
            raise SceneError(
                "cutoff",
                "(none)",
                "choose a cut-off wavelength: roughness, density and radius depend on it (see .statistics)",
            )
        return self.cutoff

    def _asperities(self, by: str | None = None) -> dict[str, float]:
        """Numbers at the chosen cut-off; two independent flanks of the same kind have twice the moments."""
        at = self.statistics.sel(cutoff=self._chosen(), by=by or self.by)
        factors = {"roughness": 1.0, "asperity_density": 1.0, "asperity_radius": 1.0}
        if self.both_flanks:
            factors |= {"roughness": np.sqrt(2.0), "asperity_radius": np.sqrt(0.5)}
        values = {name: factor * float(at[name]) for name, factor in factors.items()}
        if by is None and not np.isfinite(list(values.values())).all():
            raise SceneError(
                "cutoff",
                f"{self._chosen():.4g} m",
                f"leaves {int(at['summit_count'])} summits in this map, too few to count; choose a shorter one",
            )
        return values


def surface_from(
    heights: Any,
    size: float | str | tuple[float | str, float | str],
    cutoff: float | str | None = None,
    *,
    by: str = "summits",
    both_flanks: bool = False,
    align_rows: bool = False,
    source: str = "height map",
) -> MeasuredSurface:
    """Analyse a measured height map.

    Tilt and curvature are taken out by the best paraboloid. Holes are filled by a membrane and not counted.

    Parameters
    ----------
    heights : array_like, shape (rows, columns)
        Heights [m]; NaN, or masked, where nothing was measured.
    size : float, str or a pair of them
        Extent along the rows' and along the columns' index [m], or with a unit: the number of points times their
        distance. A single one is that of a row of points (along the columns' index); along the other index, points are
        as far apart.
    cutoff : float or str, optional
        Shortest wavelength that is kept [m], or with a unit. The numbers depend on it, so that none is chosen for the
        user; without one, `MeasuredSurface.statistics` shows them over the whole range.
    by : {"summits", "moments"}, optional
        Count and measure each summit, or take the spectral moments for those of a Gaussian surface (Nayak, McCool).
    both_flanks : bool, optional
        Put the roughness of both flanks, independent and of the same kind, into the one rough surface of the model:
        roughness times sqrt(2), tip radius over sqrt(2). By default the map is the rough flank, the other one smooth.
    align_rows : bool, optional
        Shift the rows against each other, so that the median of the differences between neighbours is zero: for lines
        of a scan that drift or noise has offset. Waves along the columns that are about as long as the map are lost.
    source : str, optional
        Where the heights come from; goes into the scene.

    Returns
    -------
    MeasuredSurface

    Raises
    ------
    SceneError
        If the map, its size or the cut-off cannot be used.

    Examples
    --------
    >>> import gearidae as gd
    >>> heights = gd.surfaces.gaussian_map(256, 2e-6, 6e-9, shortest=50e-9, longest=500e-9)
    >>> found = gd.surface_from(heights, "2 um", cutoff="50 nm")
    >>> scene = gd.preset("teodorescu2009_low_speed").replace(found.settings)
    """
    if by not in METHODS:
        raise SceneError("by", shorten(by), f"must be {' or '.join(METHODS)}")
    extent = _extent(size, np.shape(heights))
    surface = height_map(heights, extent, align_rows=align_rows)
    if surface.steepness > _STEEPEST:
        raise SceneError(
            "surface scan",
            f"(rms slope {surface.steepness:.3g})",
            f"slopes above {_STEEPEST:g} come from a wrong unit: heights must be in metres; give their unit",
        )
    chosen = None if cutoff is None else _LENGTH.take("cutoff", cutoff)
    asked = usual_cutoffs(surface)
    if chosen is not None:
        asked = np.unique(np.append(asked[~np.isclose(asked, chosen, rtol=1e-6, atol=0.0)], chosen))
    made = statistics(surface, asked)
    listed = None if chosen is None else asperities(surface, chosen)
    return MeasuredSurface(made, chosen, by, both_flanks, source, listed)


def _in_words(asperities: dict[str, float]) -> str:
    return (
        f"roughness {with_prefix(asperities['roughness'], 'm')}, "
        f"asperity_density {asperities['asperity_density']:.3g} 1/m^2, "
        f"asperity_radius {with_prefix(asperities['asperity_radius'], 'm')}"
    )


def _extent(size: Any, shape: tuple[int, ...]) -> tuple[float, float]:
    """Read the extent along both indices [m]."""
    if isinstance(size, (tuple, list, np.ndarray)):
        if len(size) != 2:
            raise SceneError("size", shorten(size), "must be one length or two")
        return _LENGTH.take("size", size[0]), _LENGTH.take("size", size[1])
    width = _LENGTH.take("size", size)
    return (width * shape[0] / shape[1], width) if len(shape) == 2 and shape[1] else (width, width)
