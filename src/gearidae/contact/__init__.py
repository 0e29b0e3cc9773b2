"""Physics of one contact, plain numbers in SI units in and out.

`asperity` is the law of one asperity (`register` adds another; both are those of `gearidae.asperities`),
`rough_pressure` two rough planes, `line_force` two teeth of which only the asperities deform, `elastic_line_force` two
teeth with elastic bodies. A surface is anything with the properties of `Surface`, such as ``scene.surface`` (bare) or
``scene.coated_surface``.

Names are loaded on first use, so that a caller of one law does not pay for the others.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearidae.lazy import lazy_names

if TYPE_CHECKING:
    from gearidae.asperities import (
        AsperityLaw,
        asperity,
        asperity_load,
        law_names,
        register,
        unregister,
    )
    from gearidae.asperities.jkr import jkr_load, jkr_slope
    from gearidae.asperities.tip import (
        Asperity,
        Surface,
        asperity_of,
        contact_modulus,
        tabor_parameter,
        tabor_regime,
    )
    from gearidae.contact.bulk import bulk_influence
    from gearidae.contact.elastic import (
        ElasticCurve,
        ElasticFoldError,
        elastic_line_curve,
        elastic_line_force,
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
    "AsperityLaw",
    "ElasticCurve",
    "ElasticFoldError",
    "Surface",
    "adhesion_loss_per_asperity",
    "asperity",
    "asperity_load",
    "asperity_of",
    "bulk_influence",
    "contact_modulus",
    "elastic_line_curve",
    "elastic_line_force",
    "jkr_load",
    "jkr_slope",
    "law_names",
    "line_force",
    "maximum_tension",
    "register",
    "rough_pressure",
    "rough_pressure_slopes",
    "tabor_parameter",
    "tabor_regime",
    "unregister",
]

_HOME = {
    "Asperity": "gearidae.asperities.tip",
    "AsperityLaw": "gearidae.asperities",
    "ElasticCurve": "elastic",
    "ElasticFoldError": "elastic",
    "Surface": "gearidae.asperities.tip",
    "adhesion_loss_per_asperity": "rough",
    "asperity": "gearidae.asperities",
    "asperity_load": "gearidae.asperities",
    "asperity_of": "gearidae.asperities.tip",
    "bulk_influence": "bulk",
    "contact_modulus": "gearidae.asperities.tip",
    "elastic_line_curve": "elastic",
    "elastic_line_force": "elastic",
    "jkr_load": "gearidae.asperities.jkr",
    "jkr_slope": "gearidae.asperities.jkr",
    "law_names": "gearidae.asperities",
    "line_force": "line",
    "maximum_tension": "rough",
    "register": "gearidae.asperities",
    "rough_pressure": "rough",
    "rough_pressure_slopes": "rough",
    "tabor_parameter": "gearidae.asperities.tip",
    "tabor_regime": "gearidae.asperities.tip",
    "unregister": "gearidae.asperities",
}

__getattr__, __dir__ = lazy_names(globals(), _HOME)
