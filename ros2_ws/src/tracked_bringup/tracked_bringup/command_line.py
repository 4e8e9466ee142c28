"""The command line of the bringup."""

import argparse
import re
from dataclasses import dataclass
from pathlib import Path

from tracked_bringup.graph_plan import GROUPINGS, Grouping
from tracked_bringup.scenarios import ArgumentError, scenario_names, split_change


def parser() -> argparse.ArgumentParser:
    """The command line."""
    made = argparse.ArgumentParser(
        prog="bringup",
        description="Runs every variant of a scenario in a graph of its own, then writes the report.",
        epilog=f"packaged scenarios: {', '.join(scenario_names())}. Exit code: 0 done; 1 a node failed; 2 bad "
        "arguments; 3 endpoints not matched; 4 time stood still; 5 no report; 130 interrupted.",
    )
    made.add_argument("scenario", help="name of a packaged scenario, or path of a .yaml file")
    made.add_argument(
        "changes",
        nargs="*",
        metavar="key:=value",
        help="changes a key of the scenario (duration_s:=10, reference.shape:=circle) or a parameter of a node "
        "(upper_nmpc.method:=thesis); namespace:=r1 puts all nodes and frames below r1",
    )
    made.add_argument("--grouping", choices=GROUPINGS, default="default", help="nodes by group, or one process each")
    made.add_argument("--variant", action="append", help="run only this variant (may be repeated)")
    made.add_argument("--name", help="folder below out/ for records, logs and report (default: the scenario's name)")
    made.add_argument("--nodes", type=Path, help="another node table")
    made.add_argument("--verbose", action="store_true", help="show every line of the nodes, not only warnings")
    return made


@dataclass(frozen=True, slots=True, kw_only=True)
class Options:
    """What is asked besides the scenario."""

    grouping: Grouping = "default"
    namespace: str = ""
    variants: tuple[str, ...] = ()
    name: str = ""
    verbose: bool = False


def split_options(arguments: argparse.Namespace) -> tuple[Options, list[str]]:
    """Options, and the changes that concern the scenario.

    Raises
    ------
    ArgumentError: if the namespace is no ROS name.
    """
    namespace, changes = "", []
    for change in arguments.changes:
        key, value = split_change(change)
        if key == "namespace":
            namespace = str(value).strip("/")
        else:
            changes.append(change)
    if namespace and not re.fullmatch(r"[A-Za-z_]\w*(/[A-Za-z_]\w*)*", namespace):
        raise ArgumentError(f"namespace: {namespace!r} is no ROS name")
    options = Options(
        grouping=arguments.grouping,
        namespace=namespace,
        variants=tuple(arguments.variant or ()),
        name=arguments.name or "",
        verbose=arguments.verbose,
    )
    return options, changes
