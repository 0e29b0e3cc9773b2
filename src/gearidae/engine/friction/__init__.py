"""Friction of flanks and hubs: limits, accelerations with set-valued friction, and what holds the gears at rest."""
