"""The command line; everything heavier than reading its arguments is loaded by the command that needs it."""

from gearidae.cli.main import main

__all__ = ["main"]
