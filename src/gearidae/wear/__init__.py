"""Loss laws of a coating: one file a law, registered by its name.

A new law is a new file here (or anywhere, if it is imported): a frozen dataclass that derives from `LossLaw` and is
decorated with `register_loss`. `gearidae.studies.life` and `gearidae life` then accept its name.
"""

from gearidae.wear.arrhenius import Arrhenius
from gearidae.wear.base import Exposure, LossLaw
from gearidae.wear.registry import loss_law, loss_law_names, register_loss, unregister_loss

__all__ = [
    "Arrhenius",
    "Exposure",
    "LossLaw",
    "loss_law",
    "loss_law_names",
    "register_loss",
    "unregister_loss",
]
