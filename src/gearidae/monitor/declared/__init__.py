"""The studies of coating maps, as in `gearidae.studies.declared`."""
