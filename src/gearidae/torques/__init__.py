"""Torque laws of time, angle and speed: one file a law, registered by its name.

A new law is a new file here, or a function anywhere that is decorated with `register_torque` before a scene names it in
``drive.law`` or ``load.law``. Laws are plain functions; the engine compiles them when a scene first uses them.
"""

from gearidae.torques.registry import (
    Parameter,
    TorqueLaw,
    register_torque,
    torque_law,
    torque_names,
    unregister_torque,
)

__all__ = ["Parameter", "TorqueLaw", "register_torque", "torque_law", "torque_names", "unregister_torque"]
