"""Energies at a state: what contacts store and have lost, energy of motion, power and force of the changing radius."""
