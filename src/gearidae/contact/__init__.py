"""Physics of one contact, plain numbers in SI units in and out.

`jkr_load` is one asperity, `rough_pressure` two rough planes, `line_force` two teeth whose asperities alone give way,
`elastic_line_force` two teeth whose bodies give way too. A surface is anything with the properties of `Surface`, such
as ``scene.surface`` (bare) or ``scene.coated_surface``.

Names are loaded on first use, so that a caller of one law does not pay for the others.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearidae.lazy import lazy_names

if TYPE_CHECKING:
    from gearidae.contact.bulk import bulk_influence
    from gearidae.contact.elastic import (
        ElasticCurve,
        ElasticFoldError,
        elastic_line_curve,
        elastic_line_force,
    )
    from gearidae.contact.jkr import (
        Asperity,
        Surface,
        asperity_load,
        asperity_of,
        contact_modulus,
        jkr_load,
        jkr_slope,
        tabor_parameter,
        tabor_regime,
    )
    from gearidae.contact.line import line_force
    from gearidae.contact.rough import (
        adhesion_loss_per_asperity,
        maximum_tension,
        rough_pressure,
        rough_pressure_slopes,
    )

__all__ = [
    "Asperity",
    "ElasticCurve",
    "ElasticFoldError",
    "Surface",
    "adhesion_loss_per_asperity",
    "asperity_load",
    "asperity_of",
    "bulk_influence",
    "contact_modulus",
    "elastic_line_curve",
    "elastic_line_force",
    "jkr_load",
    "jkr_slope",
    "line_force",
    "maximum_tension",
    "rough_pressure",
    "rough_pressure_slopes",
    "tabor_parameter",
    "tabor_regime",
]

_HOME = {
    "Asperity": "jkr",
    "ElasticCurve": "elastic",
    "ElasticFoldError": "elastic",
    "Surface": "jkr",
    "adhesion_loss_per_asperity": "rough",
    "asperity_load": "jkr",
    "asperity_of": "jkr",
    "bulk_influence": "bulk",
    "contact_modulus": "jkr",
    "elastic_line_curve": "elastic",
    "elastic_line_force": "elastic",
    "jkr_load": "jkr",
    "jkr_slope": "jkr",
    "line_force": "line",
    "maximum_tension": "rough",
    "rough_pressure": "rough",
    "rough_pressure_slopes": "rough",
    "tabor_parameter": "jkr",
    "tabor_regime": "jkr",
}

__getattr__, __dir__ = lazy_names(globals(), _HOME)
