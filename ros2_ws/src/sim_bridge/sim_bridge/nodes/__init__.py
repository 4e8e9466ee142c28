"""Executables of this package."""
