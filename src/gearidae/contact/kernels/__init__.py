"""Compiled forms of the contact laws: tables, branches and vector instructions.

The readable physics is in `gearidae.contact`.
"""
