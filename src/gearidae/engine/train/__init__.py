"""Trains: N shafts and M meshes, each mesh with all that a pair of gears has between its flanks."""

from gearidae.engine.train.continuing import end_of_train
from gearidae.engine.train.solve import OnTrainBlock, driver_of_train, solve_train

__all__ = ["OnTrainBlock", "driver_of_train", "end_of_train", "solve_train"]
