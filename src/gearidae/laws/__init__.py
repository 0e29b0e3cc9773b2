"""Laws: what acts on a shaft, one file each, with all that is known of it; see `gearidae.laws.law`.

Declarations and compiled functions stand together. Nothing here imports the engine, and nothing is declared to numba
before it is used, so that whoever reads the declarations needs neither.
"""
