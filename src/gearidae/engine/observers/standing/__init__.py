"""Where a gear stands: zeros of its speed, what free gears would have done since, and standstills on the way.

The observer notes zeros, slow times and slips, in compiled code (`follow`, `zeros`). The judge reads them at the end of
a block (`judge`), with free gears by scipy (`free_gears`) over the laws of the shafts (`torques`), so that what is said
depends on the steps and the tolerance of a run only as far as the motion does.
"""
