"""Description of the tracked robot: one file of numbers, and the URDF made from it."""

from tracked_description.robot import ROBOT_FILE, Robot, load_robot

__all__ = ["ROBOT_FILE", "Robot", "load_robot"]
