"""What observations of gears say about keys that are not known, and what follows for other gears.

A use of the core, which never imports it. `gearidae.studies` has its public names.
"""
