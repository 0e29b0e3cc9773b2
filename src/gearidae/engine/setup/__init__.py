"""From a scene to a problem that a driver can run: numbers, tables and nodes, and checkpoints of the run."""
