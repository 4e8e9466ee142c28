# The stack of a robot on ROS 2 Jazzy from apt: everything but the simulator and the lab.
#   docker build -f docker/jazzy.Dockerfile -t tracked_stack:jazzy .
# Tested against a stand-in for the base image (docker/stand_in.Dockerfile), not against the real one. `ros2 run` and
# `ros2 launch` come from the real base.
ARG BASE=ros:jazzy-ros-base
FROM ${BASE}

RUN apt-get update \
    && DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends python3-pip \
    && rm -rf /var/lib/apt/lists/*

WORKDIR /opt/tracked_stack
# Into a directory of their own: apt's Python packages stay as they are, and come second.
COPY requirements/robot.txt requirements/robot.txt
RUN python3 -m pip install --no-cache-dir --require-hashes --target /opt/tracked_packages -r requirements/robot.txt
ENV PYTHONPATH=/opt/tracked_packages

COPY ros2_ws/src ros2_ws/src
COPY docker/entrypoint.sh docker/entrypoint.sh
RUN . /opt/ros/jazzy/setup.sh && cd ros2_ws && colcon build --packages-skip sim_bridge tracked_lab

ENTRYPOINT ["/opt/tracked_stack/docker/entrypoint.sh"]
CMD ["ros2", "launch", "tracked_bringup", "bringup.launch.py"]
