"""Compile with numba, once per machine, and never run what has gone stale.

Numba's own cache looks at the file of the function it compiles, not at the files of the functions that this one
calls, and not at the SUNDIALS library. So gearidae keeps its compiled code in a folder of its own, see `cache`. Some
options of numba's that are not documented are used where it takes them, see `options`.

What a compiled function calls is compiled into it again, and with it into all its callers. A function that is called
rarely can be declared as `compiled_once` instead, see `once`.

A function is declared to numba when it is first used, and the names of this package that need numba are loaded on
first use: who reads the declarations of a law imports a module of compiled functions without numba.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearidae.lazy import lazy_names

if TYPE_CHECKING:
    from gearidae.compiled.cache import cache_folder as cache_folder
    from gearidae.compiled.cache import is_cached as is_cached
    from gearidae.compiled.functions import Function as Function
    from gearidae.compiled.functions import compiled as compiled
    from gearidae.compiled.functions import compiled_callback as compiled_callback
    from gearidae.compiled.kinds import name_type as name_type
    from gearidae.compiled.once import compiled_once as compiled_once
    from gearidae.compiled.options import compiles as compiles
    from gearidae.compiled.options import numba_options as numba_options
    from gearidae.compiled.ready import is_ready as is_ready
    from gearidae.compiled.ready import make_ready as make_ready

__getattr__, __dir__, __all__ = lazy_names(__name__)
