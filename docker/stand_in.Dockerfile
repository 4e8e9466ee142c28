# Stands in for the image of apt Jazzy where that cannot be pulled: the same commands at the same places, from wheels.
# It proves that docker/jazzy.Dockerfile builds and starts its nodes, not that it fits the real base.
#   docker build -f docker/stand_in.Dockerfile -t tracked_stack:stand_in .
ARG BASE=tracked_stack:wheels
FROM ${BASE}

RUN venv=/opt/tracked_stack/.venv \
    && /opt/tracked_stack/.cache/uv/bin/uv pip install --python "$venv/bin/python" pip \
    && mkdir -p /opt/ros/jazzy \
    && echo "export AMENT_PREFIX_PATH=$venv CMAKE_PREFIX_PATH=$venv" > /opt/ros/jazzy/setup.sh \
    && ln -s setup.sh /opt/ros/jazzy/setup.bash \
    && mv /opt/tracked_stack /opt/wheels && mkdir /opt/tracked_stack && ln -s /opt/wheels/.venv /opt/tracked_stack/.venv
ENV PATH=/opt/tracked_stack/.venv/bin:$PATH
ENTRYPOINT []
