"""Real asperities of tooth pairs: which may join or let go soon, their forces and energy, and what is joined."""
