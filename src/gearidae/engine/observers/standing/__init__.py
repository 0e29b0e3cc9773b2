"""Where a gear stands: zeros of its speed, what free gears would have done since, and standstills on the way.

Everything here has its own steps and tolerance, so that it depends on those of the run only as far as the motion does.
"""
