"""Joystick."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Joystick:
    """Position of every axis (-1 to 1) and whether each button is down, at ``stamp_ns``."""

    stamp_ns: int
    axes: tuple[float, ...]
    buttons: tuple[bool, ...]
