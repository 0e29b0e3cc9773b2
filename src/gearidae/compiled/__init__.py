"""Compile with numba, once per machine, and never run what has gone stale.

Numba's own cache looks at the file of the function it compiles, not at the files of the functions that this one
calls, and not at the SUNDIALS library. So gearidae keeps its compiled code in a folder of its own, see `cache`. Some
options of numba's that are not documented are used where it takes them, see `options`.

What a compiled function calls is compiled into it again, and with it into all its callers. A function that is called
rarely can be declared as `compiled_once` instead, see `once`.
"""

import os

from gearidae.errors import SceneError

try:
    import numba  # noqa: F401  # here first: it reads the user's settings when it is imported
except ImportError:
    raise
except Exception as error:
    settings = ", ".join(
        f"{name}={os.environ[name]}" for name in sorted(os.environ) if name.startswith("NUMBA_")
    )
    raise SceneError(
        "environment", settings, f"with these settings numba cannot be loaded: {error}"
    ) from error

from gearidae.compiled.cache import cache_folder, is_cached
from gearidae.compiled.functions import Function, compiled, compiled_callback
from gearidae.compiled.kinds import name_type
from gearidae.compiled.once import compiled_once
from gearidae.compiled.options import compiles, numba_options
from gearidae.compiled.ready import is_ready, make_ready

__all__ = [
    "Function",
    "cache_folder",
    "compiled",
    "compiled_callback",
    "compiled_once",
    "compiles",
    "is_cached",
    "is_ready",
    "make_ready",
    "name_type",
    "numba_options",
]
