"""Terms of a shaft's torque, one file each: how it is laid out among the tables, its value and its rate.

`gearidae.engine.torques.torque` adds them up; `docs/extending.md` shows how to add one.
"""
