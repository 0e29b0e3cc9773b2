"""Tests of a user's own: runs compared with each other and with solutions in closed form.

`assert_runs_close` fails with a message that says what differs where, `solutions` has reference solutions with their
formulas, and the fixture ``gearidae_reference`` of `gearidae.testing.plugin` keeps an archive that later runs are
compared with.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearidae.lazy import lazy_names

if TYPE_CHECKING:
    from gearidae.testing import solutions as solutions
    from gearidae.testing.assertions import assert_runs_close as assert_runs_close
    from gearidae.testing.comparison import compare as compare

__getattr__, __dir__, __all__ = lazy_names(__name__)
