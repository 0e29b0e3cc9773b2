"""Numerical formulas: Adams' for a motion in time, interpolation between two times, quadrature of powers."""
