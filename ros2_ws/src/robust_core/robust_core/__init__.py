"""Robust control, estimation and the plants they are tried on. Knows no ROS and no robot."""
