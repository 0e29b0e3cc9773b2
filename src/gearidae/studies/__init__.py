"""Studies: simulations, or the static contact, used to answer a question (coating map, starting torque).

Their public names are reached through `gearidae.studies` and, for the older ones, `gearidae.analysis`.
"""
