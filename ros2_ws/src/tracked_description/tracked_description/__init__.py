"""Description of the tracked robot: one file of numbers, and the URDF made from it."""

from tracked_description.robot import Robot, load_robot

__all__ = ["Robot", "load_robot"]
