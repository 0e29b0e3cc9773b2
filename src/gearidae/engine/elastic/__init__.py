"""Elastic contacts: nodes along a contact, their state and energy, their static solution and their Jacobian by blocks.

Only scenes whose bodies deflect load and compile it.
"""
