"""Imported by the server that the attack's processes are copied from: compiles and loads all that they need, once."""

from gearidae_bench.attack_worker import warm_up

warm_up()
