"""One self-contained page about an archive: outcome, scene, and its time series to look into."""

from gearidae.report.page import build_report, write_report

__all__ = ["build_report", "write_report"]
