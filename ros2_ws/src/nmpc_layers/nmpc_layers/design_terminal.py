"""Designs the terminal weight of the upper layer and proves it: ``python -m nmpc_layers.design_terminal``.

Needed again after a change of the weights, of the references named beside them, or of the limits of the robot. Writes
the file that the weights file names; needs robust_core with its solver, as layers do not.
"""

import argparse
import sys
from pathlib import Path

from nmpc_layers.certified_terminal import TerminalSource, command_limits
from nmpc_layers.drive_limits import DriveLimits
from nmpc_layers.layer_weights import METHODS, MethodWeights, load_weights, weights_folder
from nmpc_layers.upper_settings import heading_point_of
from robust_core.design_files import save_design
from robust_core.errors import RobustCoreError
from robust_core.terminal import TerminalDesign, design_tracking_terminal
from tracked_description import Robot, load_robot
from tracked_types import PLAN_RATE_HZ


def design(robot: Robot, method: str, entry: MethodWeights, source: TerminalSource, rate_hz: int) -> TerminalDesign:
    """The weight of one method's upper layer at this rate.

    Raises
    ------
    RobustCoreError: if there is none.
    """
    weights = entry.upper
    return design_tracking_terminal(
        source.tracking_error(1.0 / rate_hz, heading_point_of(method)),
        command_limits(DriveLimits.from_robot(robot)),
        position=weights.position,
        heading=weights.heading,
        speed=weights.speed,
        yaw_rate=weights.yaw_rate,
    )


def main(arguments: list[str] | None = None) -> int:
    """Design, prove and write; 1 if a weight that the file names is not proven."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--weights-file", default="", help="default: the packaged one")
    parser.add_argument("--robot-file", default="", help="default: the packaged one")
    parser.add_argument("--rate-hz", type=int, default=PLAN_RATE_HZ, help="plans per second (default: %(default)s)")
    parser.add_argument("--out", type=Path, help="folder to write to (default: that of the weights file)")
    options = parser.parse_args(arguments)
    robot, weights = load_robot(options.robot_file), load_weights(options.weights_file)
    folder = options.out or weights_folder(options.weights_file)
    failed = 0
    for method in METHODS:
        entry = weights.of(method)
        if entry.upper_terminal is None:
            print(f"{method}: names no terminal weight")
            continue
        try:
            found = design(robot, method, entry, entry.upper_terminal, options.rate_hz)
            path = save_design(found.result.require(), folder / entry.upper_terminal.file)
        except RobustCoreError as error:
            print(f"{method}: {error}", file=sys.stderr)
            failed = 1
            continue
        print(f"{method}: {path}, level {found.level:.4g}, {found.result.reason}")
    return failed


if __name__ == "__main__":
    sys.exit(main())
