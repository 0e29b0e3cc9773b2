"""Equations of motion: residual and Jacobian, static deflections that go with a motion, and what is sampled of it."""
