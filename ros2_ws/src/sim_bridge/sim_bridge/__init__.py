"""Simulated tracked robot: physics with slipping belts, sensors, and the node that offers them.

The physics (`vehicle`, `world`, `belts`) and the sensors know no ROS; only `nodes` does.
"""
