"""Fixtures: every test has its own ROS domain, its own context and ends every process that it started."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.support.domains import own_domain
from tests.support.node_process import NodeProcess
from tests.support.probe import Probe, own_probe
from tests.support.step_run import StepRun, drive_over_the_step


@pytest.fixture
def ros_domain(monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """A domain nobody else uses; ROS_DOMAIN_ID says it to whatever the test starts."""
    with own_domain() as domain:
        monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
        monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
        yield domain


@pytest.fixture
def probe(ros_domain: int) -> Iterator[Probe]:
    """A node of the test's own in the test's domain."""
    with own_probe(ros_domain) as made:
        yield made


@pytest.fixture
def start_node(ros_domain: int, tmp_path: Path) -> Iterator[Callable[..., NodeProcess]]:
    """``start_node(package, executable, *arguments)`` runs the real executable until the test ends."""
    started: list[NodeProcess] = []

    def start(*arguments: str, **environment: str) -> NodeProcess:
        process = NodeProcess(arguments, tmp_path / f"process_{len(started)}.log", environment)
        started.append(process)
        return process

    yield start
    for process in reversed(started):
        process.end()


@pytest.fixture(scope="session")
def step_run(tmp_path_factory: pytest.TempPathFactory) -> StepRun:
    """The step scenario, driven once for all tests that look at it."""
    with own_domain() as domain:
        return drive_over_the_step(domain, tmp_path_factory.mktemp("step"))
