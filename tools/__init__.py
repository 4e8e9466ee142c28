"""Helpers around the stack that are no part of it: set-up of a working tree."""
