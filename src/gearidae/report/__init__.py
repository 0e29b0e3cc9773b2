"""Self-contained pages about an archive: a report of it, and a page to look through its runs."""

from gearidae.report.explorer import build_explorer, explore
from gearidae.report.page import build_report, write_report

__all__ = ["build_explorer", "build_report", "explore", "write_report"]
