"""Trains: N shafts and M meshes, each mesh with all that a pair of gears has between its flanks."""

from gearidae.engine.train.solve import solve_train as solve_train

__all__ = ["solve_train"]
