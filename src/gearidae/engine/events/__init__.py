"""Events: the guard that the solver watches, the histories of tooth pairs, and what is done at each kind of event.

Drivers call it at every accepted time.
"""
