"""The studies of lives, as in `gearidae.studies.declared`."""
