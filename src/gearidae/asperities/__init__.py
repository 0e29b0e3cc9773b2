"""Laws of one asperity: one file a law, registered by its name.

A new law is a new file here (or anywhere, if it is imported): a frozen dataclass that derives from `AsperityLaw` and is
decorated with `register`. Readable and compiled force laws, stored energy, losses and the key ``contact.asperity``
follow from it.
"""

from gearidae.asperities.base import AsperityLaw
from gearidae.asperities.registry import (
    asperity,
    asperity_load,
    law_class,
    law_names,
    law_of,
    law_of_tip,
    register,
    tip_law,
    unregister,
)

__all__ = [
    "AsperityLaw",
    "asperity",
    "asperity_load",
    "law_class",
    "law_names",
    "law_of",
    "law_of_tip",
    "register",
    "tip_law",
    "unregister",
]
