"""The boundary with SUNDIALS: its functions by name, its memory, a solver opened and closed, its interpolation."""
