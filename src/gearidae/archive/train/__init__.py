"""Runs of trains in datasets: along shafts and meshes, as the pair that is judged, and where the drive's work goes."""

from gearidae.archive.train.dataset import train_dataset
from gearidae.archive.train.view import judged_view, train_form
from gearidae.archive.train.work import Share, passed_on, work_shares

__all__ = ["Share", "judged_view", "passed_on", "train_dataset", "train_form", "work_shares"]
