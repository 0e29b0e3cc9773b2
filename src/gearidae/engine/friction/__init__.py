"""Dry friction, of flanks, hubs and pin, and the dry load: limits, accelerations, gears at rest."""
