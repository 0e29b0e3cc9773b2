"""Results: labelled datasets and the netCDF4 files that hold them."""

from gearidae.archive.dataset import combine, dimension_names, reached, to_dataset
from gearidae.archive.growing import GrowingArchive
from gearidae.archive.netcdf import open_archive, save
from gearidae.archive.provenance import SCHEMA_VERSION
from gearidae.archive.target import check_target
from gearidae.archive.variables import Variable

__all__ = [
    "SCHEMA_VERSION",
    "GrowingArchive",
    "Variable",
    "check_target",
    "combine",
    "dimension_names",
    "open_archive",
    "reached",
    "save",
    "to_dataset",
]
