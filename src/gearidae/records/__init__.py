"""Plain records that all packages exchange: samples, events, passages, endings, statistics, totals, solutions.

The engine returns them and the archive stores them; nothing here depends on another package.
"""

from gearidae.records.columns import (
    ELASTIC_COLUMNS,
    ELASTIC_SAMPLES,
    GEAR_COLUMNS,
    GEAR_SAMPLES,
    JOINT_FRICTION,
    JOINT_LOADS,
    LAW_SAMPLES,
    POPULATION_COLUMNS,
    POPULATION_SAMPLES,
    ROLLER_COLUMNS,
    ROLLER_SAMPLES,
    Column,
    sampled_columns,
)
from gearidae.records.energy import (
    GEAR_BOUND,
    QUADRATURE_BOUND,
    ROLLER_BOUND,
    ROUNDING_BOUND,
    TABLE_BOUND,
    TORQUE_BOUND,
    TRAVEL_BOUND,
    EnergyBalance,
)
from gearidae.records.events import (
    EVENT,
    EventKind,
    Events,
    Flank,
)
from gearidae.records.exposures import ExposureRows
from gearidae.records.extremes import (
    RUN_PARTS,
    Extremes,
)
from gearidae.records.impacts import Impacts
from gearidae.records.passages import Passages
from gearidae.records.results import (
    ROWS,
    Block,
    Solution,
    Words,
)
from gearidae.records.row_table import RowColumn, Rows
from gearidae.records.sampling import (
    first_sample,
    sample_times,
)
from gearidae.records.statistics import (
    COUNTERS,
    Ending,
    Statistics,
)

__all__ = [
    "COUNTERS",
    "ELASTIC_COLUMNS",
    "ELASTIC_SAMPLES",
    "EVENT",
    "GEAR_BOUND",
    "GEAR_COLUMNS",
    "GEAR_SAMPLES",
    "JOINT_FRICTION",
    "JOINT_LOADS",
    "LAW_SAMPLES",
    "POPULATION_COLUMNS",
    "POPULATION_SAMPLES",
    "QUADRATURE_BOUND",
    "ROLLER_BOUND",
    "ROLLER_COLUMNS",
    "ROLLER_SAMPLES",
    "ROUNDING_BOUND",
    "ROWS",
    "RUN_PARTS",
    "TABLE_BOUND",
    "TORQUE_BOUND",
    "TRAVEL_BOUND",
    "Block",
    "Column",
    "Ending",
    "EnergyBalance",
    "EventKind",
    "Events",
    "ExposureRows",
    "Extremes",
    "Flank",
    "Impacts",
    "Passages",
    "RowColumn",
    "Rows",
    "Solution",
    "Statistics",
    "Words",
    "first_sample",
    "sample_times",
    "sampled_columns",
]
