"""What a step is made of: first step, correction, step control, root search, gears at rest, and blocks of output.

Everything here is about time integration; the physics is in `gearidae.engine.motion`, and the order of a step in
`gearidae.engine.step`.
"""
