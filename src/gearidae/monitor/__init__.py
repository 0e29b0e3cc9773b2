"""What a record of the gear's speed says of the coating: maps of its frequencies, and the assessment of a record.

A use of the core, which never imports it. `gearidae.analysis` has its public names.
"""
