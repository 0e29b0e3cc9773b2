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
    from gearidae.asperities import AsperityLaw as AsperityLaw
    from gearidae.asperities import asperity as asperity
    from gearidae.asperities import asperity_load as asperity_load
    from gearidae.asperities import law_names as law_names
    from gearidae.asperities import register as register
    from gearidae.asperities import unregister as unregister
    from gearidae.asperities.jkr import jkr_load as jkr_load
    from gearidae.asperities.jkr import jkr_slope as jkr_slope
    from gearidae.asperities.tip import Asperity as Asperity
    from gearidae.asperities.tip import Surface as Surface
    from gearidae.asperities.tip import asperity_of as asperity_of
    from gearidae.asperities.tip import contact_modulus as contact_modulus
    from gearidae.asperities.tip import tabor_parameter as tabor_parameter
    from gearidae.asperities.tip import tabor_regime as tabor_regime
    from gearidae.contact.attraction import attraction_energy as attraction_energy
    from gearidae.contact.attraction import attraction_force as attraction_force
    from gearidae.contact.attraction import attraction_pressure as attraction_pressure
    from gearidae.contact.bulk import bulk_influence as bulk_influence
    from gearidae.contact.elastic import ElasticCurve as ElasticCurve
    from gearidae.contact.elastic import ElasticFoldError as ElasticFoldError
    from gearidae.contact.elastic import elastic_line_curve as elastic_line_curve
    from gearidae.contact.elastic import elastic_line_force as elastic_line_force
    from gearidae.contact.line import line_force as line_force
    from gearidae.contact.parting import adhesion_energy as adhesion_energy
    from gearidae.contact.rough import adhesion_loss_per_asperity as adhesion_loss_per_asperity
    from gearidae.contact.rough import maximum_tension as maximum_tension
    from gearidae.contact.rough import rough_pressure as rough_pressure
    from gearidae.contact.rough import rough_pressure_slopes as rough_pressure_slopes
    from gearidae.studies.hub_contact import hub_adhesion as hub_adhesion

__getattr__, __dir__, __all__ = lazy_names(__name__)
