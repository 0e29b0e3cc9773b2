"""Make the reference solutions of all benchmark scenes anew: ``python benchmarks/make_references.py``.

Each goes to ``benchmarks/references/SCENE.npz`` with its provenance: what was solved, by which method, how far the
checks differ, with which versions, when. The benchmark makes those that do not fit the present scene by itself.
"""

from __future__ import annotations

import sys
from pathlib import Path

from gearidae_bench import SCENES
from gearidae_bench.reference import make_reference, save_reference

FOLDER = Path(__file__).with_name("references")


def main() -> None:
    """Make and keep every reference; say how good each is."""
    for bench in SCENES.values():
        reference = make_reference(bench)
        path = save_reference(reference, FOLDER)
        sys.stdout.write(f"{path.name}: own error {reference.provenance.own_error:.1e} of scale\n")


if __name__ == "__main__":
    main()
