"""All that is dry, friction of flanks and hubs and the dry load: limits, accelerations, gears at rest."""
