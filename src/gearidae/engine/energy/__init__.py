"""The energy balance of a run, kept at accepted steps.

It reads the state of the motion and the histories, and changes only its own sums.
"""
