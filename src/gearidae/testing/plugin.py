"""Fixture for pytest: an archive that is kept as a reference, and that later runs are compared with.

The topmost ``conftest.py`` names it: ``pytest_plugins = ["gearidae.testing.plugin"]``. It is no entry point, because
pytest rewrites every assertion of a distribution that has one, those in compiled functions too.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Final

import pytest

if TYPE_CHECKING:
    import xarray as xr

FOLDER: Final = "gearidae_references"
"""Folder beside the test file that holds its references."""

_WRITERS: Final = pytest.StashKey[dict[Path, str]]()
"""Which test has written a reference first."""


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the option that writes references anew."""
    group = parser.getgroup("gearidae")
    group.addoption(
        "--gearidae-update",
        action="store_true",
        help="write the reference archives of gearidae_reference anew",
    )


@pytest.fixture
def gearidae_reference(request: pytest.FixtureRequest) -> Callable[..., None]:
    """Compare a run with the reference archive of a name; with ``--gearidae-update`` the run becomes the reference.

    The fixture is a function of the run, the name and the tolerances of `gearidae.testing.assert_runs_close`. The file
    is ``gearidae_references/NAME.nc`` beside the test file, and belongs under version control with it. Two tests cannot
    write one reference.
    """
    folder = Path(request.path).parent / FOLDER
    update = bool(request.config.getoption("--gearidae-update"))

    def check(
        ds: xr.Dataset,
        name: str,
        *,
        rtol: float = 1e-6,
        per: Mapping[str, float] | None = None,
        ignore: Sequence[str] = (),
    ) -> None:
        import gearidae as gd
        from gearidae.testing import assert_runs_close

        name = name.removesuffix(".nc")
        if not name or Path(name).name != name:
            pytest.fail(
                f"the name of a reference is that of a file, without folders: {name!r}", pytrace=False
            )
        target = folder / f"{name}.nc"
        writer = request.config.stash.setdefault(_WRITERS, {}).setdefault(target, request.node.nodeid)
        if update and writer != request.node.nodeid:
            pytest.fail(f"{writer} has written the reference {name}: give each test its own", pytrace=False)
        if update:
            folder.mkdir(exist_ok=True)
            gd.save(ds, target, overwrite=True)
            return
        if not target.exists():
            pytest.fail(
                f"there is no reference {target}: make it with pytest --gearidae-update", pytrace=False
            )
        assert_runs_close(ds, gd.open_archive(target), rtol=rtol, per=per, ignore=ignore)

    return check
