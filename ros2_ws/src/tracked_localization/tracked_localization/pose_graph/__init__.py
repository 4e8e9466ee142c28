"""Loops of a map closed by a graph of poses."""
