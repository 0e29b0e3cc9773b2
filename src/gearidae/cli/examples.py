"""Examples below the help of each command but those of studies, which declare theirs; the tests parse every one."""

from __future__ import annotations

from collections.abc import Sequence

EXAMPLES: dict[str, tuple[str, ...]] = {
    "run": (
        "gearidae run mine.toml",
        "gearidae run teodorescu2009_low_speed --set coating.sam_fraction=0.5 -o run.nc",
        'gearidae run mine.toml --set "mesh.backlash=0.3 um" "run.duration=50 ms" --overwrite',
    ),
    "sweep": (
        "gearidae sweep mine.toml --over coating.sam_fraction=1:0.4:-0.05",
        "gearidae sweep mine.toml --over coating.sam_fraction=1,0.5 mesh.backlash=0.2e-6,0.3e-6 --jobs 2 -o grid.nc",
    ),
    "plot": (
        "gearidae plot mine.nc",
        "gearidae plot mine.nc --picture power_spectrum -o spectrum.pdf",
        "gearidae plot grid.nc --picture outcome",
        'gearidae plot mine.nc --picture teeth --from "76 ms" --to "79 ms" -o teeth.gif',
    ),
    "report": ("gearidae report mine.nc -o mine.html",),
    "explore": (
        "gearidae explore grid.nc",
        'gearidae explore grid.nc --select backlash=0.2e-6 --from "70 ms" --to "90 ms" -o exit.html',
    ),
    "assess": (
        "gearidae assess signal.csv --map map.nc",
        'gearidae assess signal.csv --map map.nc --anti-alias-filter "4 kHz" --history unknown',
        "gearidae assess sweep.nc --select sam_fraction=0.7 --map over_torque.nc --line torque=4.5e-18",
    ),
    "surface": (
        'gearidae surface scan.npy --size "2 um" --picture cutoffs.png',
        'gearidae surface scan.csv --size "2 um" --unit nm --cutoff "80 nm" -o surface.toml',
        'gearidae surface scan.csv --size "2 um, 1 um" --unit nm --cutoff "80 nm" --case mine.toml -o rough.toml',
    ),
    "surfaces": ("gearidae surfaces",),
    "compile": ("gearidae compile",),
    "check": (
        "gearidae check mine.toml",
        "gearidae check mine.toml --set coating.sam_fraction=0.5",
        "gearidae check mine.toml --json",
    ),
    "init": ("gearidae init mine", "gearidae init mine --preset start_up"),
    "schema": ("gearidae schema -o gearidae.schema.json",),
    "info": ("gearidae info mine.nc", "gearidae info mine.nc --json"),
}


def epilogue(examples: Sequence[str]) -> str:
    """Write command lines below the help of a command."""
    return "Examples:\n\n" + "\n\n".join(f"    {line}" for line in examples)
