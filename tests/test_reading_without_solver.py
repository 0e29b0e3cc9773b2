"""Reading and drawing results takes neither the engine nor a compiler; a process of its own knows what was imported."""

import subprocess
import sys

import pytest

import gearidae as gd

LOOK = """
import sys
from pathlib import Path

import gearidae as gd

ds = gd.open_archive(sys.argv[1])
assert ds.sizes["time"] == 20_001
heavy = ("numba", "llvmlite", "sksundae", "gearidae.engine", "gearidae.contact.kernels", "gearidae.compiled.cache")
for use in sys.argv[2:]:
    exec(use)
    print(*sorted(name for name in sys.modules if any(name == one or name.startswith(one + ".") for one in heavy)))
"""
LIGHT = {
    "open": "",
    "overview": "gd.plot.overview(ds)",
    "spectrum": "gd.analysis.power_spectrum(ds)",
    "windows": "gd.analysis.impact_windows(ds)",
    "signal": "gd.analysis.read_signal(sys.argv[1])",
    "words": "from gearidae.analysis.verdict import outcomes; outcomes(ds)",
    "summary": "from gearidae.archive.run_summary import summary_of; summary_of(ds)",
    "validity": "from gearidae.runs.kept_validity import validity_of; assert len(validity_of(ds)) == 17",
    "accessor": "ds.gearidae.scene; ds.gearidae.verdicts(); ds.gearidae.to_dataframe(); ds.gearidae.events()",
    "chain": "gd.concat([ds.isel(event=slice(0))], 'time')",
    "checkpoints": "from gearidae.archive import RunJournal",
    "laws": "from gearidae.laws.shafts import SHAFT_LAWS, driving_force; assert SHAFT_LAWS[0].name == 'constant'",
}


@pytest.fixture(scope="module")
def archive(tmp_path_factory):
    file = tmp_path_factory.mktemp("reading") / "run.nc"
    scene = gd.preset("teodorescu2009_low_speed").replace({"run.samples": 20_001, "run.duration": 0.4})
    gd.simulate(scene, archive=file)
    return file


def test_reading_and_drawing_load_neither_numba_nor_the_engine(archive):
    """Heavy modules that a process has loaded after one use after the other.

    The picture of the teeth needs the force law when it is drawn, which shows that the look itself sees such modules.
    """
    uses = [*LIGHT.values(), "gd.plot.teeth", "gd.plot.teeth(ds, time=0.1)"]
    command = [sys.executable, "-c", LOOK, str(archive), *uses]
    *light, teeth = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
    assert dict(zip([*LIGHT, "teeth"], light, strict=True)) == dict.fromkeys([*LIGHT, "teeth"], "")
    assert {"numba", "gearidae.contact.kernels.law"} <= set(teeth.split())
