"""Executables that are nodes."""
