"""Laws of a mesh and of its tooth pairs that know gaps and rates alone: one file each."""
