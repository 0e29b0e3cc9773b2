"""Tooth pairs in mesh: which are within reach, their gaps, contact lengths, shares of the materials, and forces."""
