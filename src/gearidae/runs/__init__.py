"""Running scenes: one run, a sweep, runs that stream into an archive, executors and progress.

The public door is `gearidae.simulate` and `gearidae.sweep`.
"""
