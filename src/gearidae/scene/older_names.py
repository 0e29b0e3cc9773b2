"""Names of older versions in the table ``contact``, which are read for good."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from functools import cache
from typing import Any, Final

from gearidae.errors import SceneError
from gearidae.scene.group import shorten

log = logging.getLogger(__name__)

MODELS: Final = {
    "auto": ("auto", "statistical"),
    "asperity": ("rigid", "statistical"),
    "elastic": ("elastic", "statistical"),
    "population": ("rigid", "discrete"),
}
"""Values of ``contact.model``: those of ``contact.bodies`` and ``contact.roughness``."""
_NET: Final = "net"


def with_new_names(contact: Mapping[str, Any], *, quiet: bool = False) -> dict[str, Any]:
    """Return a table ``contact`` with the present names; what is no value of an older name stays.

    Parameters
    ----------
    contact : mapping
        As a case file or an archive has it.
    quiet : bool, optional
        Whether nothing is said about it, as of an archive.

    Raises
    ------
    SceneError
        If an older name is given beside the present one.
    """
    data = dict(contact)
    model = data.get("model")
    for name in ("bodies", "roughness"):
        if model is not None and data.get(name) is not None:
            raise SceneError("model", shorten(model), f"cannot be given beside {name}: leave it out")
    if isinstance(model, str) and model in MODELS:
        del data["model"]
        data["bodies"], data["roughness"] = MODELS[model]
        if not quiet:
            bodies, roughness = MODELS[model]
            _note(
                f'contact.model = "{model}" is an older name and is read as'
                f' contact.bodies = "{bodies}", contact.roughness = "{roughness}"'
            )
    if data.get("friction_law") == _NET:
        data["friction_law"] = "coulomb"
        if not quiet:
            _note('contact.friction_law = "net" is an older name and is read as "coulomb"')
    return data


@cache
def _note(words: str) -> None:
    """Log a note, once in a process."""
    log.warning("note: %s", words)
