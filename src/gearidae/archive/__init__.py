"""Results: labelled datasets and the netCDF4 files that hold them; names are loaded on first use."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearidae.lazy import lazy_names

if TYPE_CHECKING:
    from gearidae.archive.dataset import combine as combine
    from gearidae.archive.dataset import dimension_names as dimension_names
    from gearidae.archive.dataset import reached as reached
    from gearidae.archive.dataset import to_dataset as to_dataset
    from gearidae.archive.netcdf import open_archive as open_archive
    from gearidae.archive.netcdf import save as save
    from gearidae.archive.provenance import SCHEMA_VERSION as SCHEMA_VERSION
    from gearidae.archive.target import check_target as check_target
    from gearidae.archive.unfinished import RunJournal as RunJournal
    from gearidae.archive.variables import Variable as Variable

__getattr__, __dir__, __all__ = lazy_names(__name__)
