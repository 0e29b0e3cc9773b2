"""The extremes of a run, kept at accepted steps and at extrema located between them, whatever is sampled.

They read the motion and its rates, and change only their own record.
"""
