"""The benchmark: run time against error, compared with independent references and other integrators.

Sits above the engine and is imported by the command line only when asked for.
"""

from gearidae_bench.benchmark import Result, all_contenders, run_benchmark
from gearidae_bench.measure import Settings
from gearidae_bench.scenes import SCENES, find_scenes

__all__ = ["SCENES", "Result", "Settings", "all_contenders", "find_scenes", "run_benchmark"]
