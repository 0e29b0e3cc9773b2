"""From a scene to numbers: what the engine knows of a scene, its tooth pairs, torques, residual and observed columns.

The state of a run lives here; integrators and events change it and nothing else does.
"""
