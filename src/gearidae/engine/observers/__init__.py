"""What follows a run from one accepted time to the next without changing it: balance, extremes, exposures."""
