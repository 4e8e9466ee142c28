"""Driving by hand: what keys and joysticks ask for, and what is asked when they fall silent."""
