"""Description of the tracked robot: one file of numbers, and the URDF made from it."""

from tracked_description.footprint import Footprint
from tracked_description.robot import Robot, load_robot
from tracked_description.robot_limits import RobotLimits
from tracked_description.suspension import suspension_joint_names
from tracked_description.urdf import robot_urdf

ROBOT_FILE = ("robot_file", "", "Path of the robot's YAML file; empty for the packaged robot.yaml.")
"""Name, default and description of the parameter that every robot-aware node has: ``Parameter(*ROBOT_FILE)``."""

__all__ = ["ROBOT_FILE", "Footprint", "Robot", "RobotLimits", "load_robot", "robot_urdf", "suspension_joint_names"]
