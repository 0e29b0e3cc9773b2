"""The public names of the studies, whatever has been imported before."""

import subprocess
import sys

import gearidae as gd


def test_the_older_names_are_the_same_functions():
    both = set(gd.studies.__all__) & set(gd.analysis.__all__)
    assert both == {
        *(
            "coating_map",
            "contact_resonance",
            "open_map",
            "starting_torque",
            "static_starting_torque",
            "tooth_contacts",
        )
    }
    assert all(getattr(gd.studies, name) is getattr(gd.analysis, name) for name in both)


def test_reaching_the_studies_loads_nothing_heavy():
    script = "import sys, gearidae as gd; gd.studies; print({'numba', 'scipy', 'xarray'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"
