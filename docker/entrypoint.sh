#!/bin/bash
# Runs a command in the environment of ROS and of the stack's workspace.
set -e
source /opt/ros/jazzy/setup.bash
source /opt/tracked_stack/ros2_ws/install/setup.bash
exec "$@"
