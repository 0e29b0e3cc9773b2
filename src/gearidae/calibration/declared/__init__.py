"""The studies of calibrations and predictions, as in `gearidae.studies.declared`."""
