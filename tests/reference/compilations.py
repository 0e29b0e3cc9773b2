"""How many functions a program has had compiled: the beginning of programs that tests run in processes of their own."""

COUNTING = """
from numba.core import event
class Count(event.Listener):
    n = 0
    def on_start(self, begun): self.n += 1
    def on_end(self, done): pass
count = Count()
event.register("numba:compile", count)
"""
"""After it, ``count.n`` is the number of functions that were not found on disk."""
