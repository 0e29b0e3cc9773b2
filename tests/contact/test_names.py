import subprocess
import sys

import pytest

from gearidae import contact


def test_every_public_name_is_there():
    for name in contact.__all__:
        assert getattr(contact, name).__doc__
    assert set(contact.__all__) <= set(dir(contact))
    with pytest.raises(AttributeError, match="no attribute 'jkr_pressure'"):
        _ = contact.jkr_pressure


def test_static_laws_need_no_compiler():
    script = (
        "import sys, gearidae.contact as c; assert 'scipy' not in sys.modules; "
        "c.jkr_load, c.rough_pressure, c.line_force, c.elastic_line_force; assert 'numba' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", script], check=True)
