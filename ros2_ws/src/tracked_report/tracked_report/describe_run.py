"""What a record says of its run, from its scenario and from where it runs."""

from collections.abc import Iterable
from datetime import UTC, datetime
from functools import cache

from tracked_description import Robot
from tracked_report.machine import describe_machine, git_commit, package_versions
from tracked_report.node_parameters import node_parameters
from tracked_report.run_record import CommandLimits, RunMeta
from tracked_report.scenario import Scenario
from tracked_types import Outline


def describe_run(scenario: Scenario, variant: str, robot: Robot, scene: Iterable[Outline] = ()) -> RunMeta:
    """Everything known before the run: scenario, machine, versions, commit, time of day.

    The robot's own suspension holds where the scenario says nothing. What only the run can tell
    (``odom_in_world``, ``wall_duration_s``) is for the caller to add with ``model_copy(update=...)``.

    Raises
    ------
    KeyError: for an unknown variant.
    """
    return RunMeta(
        scenario=scenario.name,
        variant=variant,
        description=scenario.description,
        variant_description=scenario.variants[variant].description,
        seed=scenario.seed,
        created=datetime.now(UTC).isoformat(timespec="seconds"),
        commit=_commit(),
        world=scenario.world,
        time=scenario.time,
        suspension=scenario.suspension_of(variant) or robot.suspension.kind,
        pipeline_latency_s=float(str(node_parameters(scenario, variant)["upper_nmpc"]["pipeline_latency_s"])),
        limits=CommandLimits(
            speed_min_mps=robot.limits.speed_min_mps,
            speed_max_mps=robot.limits.speed_max_mps,
            yaw_rate_max_radps=robot.limits.yaw_rate_max_radps,
        ),
        scene=tuple(scene),
        machine=_machine(),
        versions=_versions(),
    )


# A process describes many runs, and asking git and the packages takes as long as the start of a run.
_commit = cache(git_commit)
_machine = cache(describe_machine)
_versions = cache(package_versions)
