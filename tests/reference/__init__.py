"""Slow readable twins of the package's kernels, and closed forms to hold them against. Used by tests only."""
