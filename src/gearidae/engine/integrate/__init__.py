"""From one accepted time to the next: formulas, step control, Newton iteration, root finding, and the two drivers.

Everything here is about time integration; the physics is in `gearidae.engine.motion`.
"""
