"""Real asperities of tooth pairs: those that may join or detach soon, forces and energy, joined asperities."""
