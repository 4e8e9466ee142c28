"""pytest plugin (``-p tools.ros_free_tests``): leaves out test files that speak ROS, where ROS is not installed."""

import re
from pathlib import Path

# rclpy, the kit's half that stands on it, and every message package.
SPEAKS_ROS = re.compile(
    r"^\s*(from|import) (rclpy|\w+_msgs|\w+_interfaces|std_srvs|ament_index_python|node_kit|\w+\.nodes)\b",
    re.MULTILINE,
)


def pytest_ignore_collect(collection_path: Path) -> bool | None:
    """True for a test file that imports ROS; no opinion on anything else."""
    if collection_path.suffix == ".py" and SPEAKS_ROS.search(collection_path.read_text()):
        return True
    return None
