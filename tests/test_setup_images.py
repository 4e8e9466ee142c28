"""The container files name what the tree has."""

import re

import yaml

from tests.support.node_process import ROOT

DOCKER = ROOT / "docker"
NOT_IN_THE_STACK_SERVICE = {"sim_bridge", "recorder", "mcap_recorder", "replay"}


def test_the_compose_file_starts_every_node_of_the_table_that_is_not_optional_once():
    services = yaml.safe_load((DOCKER / "compose.yaml").read_text())["services"]
    table = yaml.safe_load((ROOT / "ros2_ws/src/tracked_bringup/tracked_bringup/data/nodes.yaml").read_text())["nodes"]
    simulator = table["sim_bridge"]
    assert services["simulator"]["command"][:2] == [simulator["package"], simulator["executable"]]
    hosted = services["stack"]["command"][2:]
    assert sorted(hosted) == sorted(
        node["class"]
        for name, node in table.items()
        if name not in NOT_IN_THE_STACK_SERVICE and not node.get("optional")
    )


def test_every_copied_path_exists():
    for file in sorted(DOCKER.glob("*.Dockerfile")):
        for paths in re.findall(r"^COPY (.+) \S+$", file.read_text(), re.MULTILINE):
            for path in paths.split():
                assert (ROOT / path).exists(), f"{file.name} copies {path}"


def test_the_image_of_a_robot_leaves_out_only_what_a_robot_does_not_deploy():
    skipped = re.search(r"--packages-skip (.+)$", (DOCKER / "jazzy.Dockerfile").read_text(), re.MULTILINE)
    assert skipped is not None
    assert skipped.group(1).split() == ["sim_bridge", "tracked_lab"]
