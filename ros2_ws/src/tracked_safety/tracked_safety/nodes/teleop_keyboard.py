"""Node teleop_keyboard: the keys of a terminal as commands."""

import atexit
import sys
import time

from node_kit import Level, Parameter, ParameterTable, StackNode, run
from tracked_description import ROBOT_FILE, load_robot
from tracked_safety.nodes.teleop_output import TeleopOutput
from tracked_safety.teleop.key_decoder import KeyDecoder
from tracked_safety.teleop.key_teleop import HELP, KeySettings, KeyTeleop
from tracked_safety.teleop.raw_terminal import NoTerminalError, RawTerminal

PARAMETERS = ParameterTable.from_settings(KeySettings, extra=(Parameter(*ROBOT_FILE),))


class TeleopKeyboardNode(StackNode):
    """Publishes cmd_vel_teleop while a key of its terminal is held down."""

    NAME = "teleop_keyboard"
    PARAMETERS = PARAMETERS

    def __init__(self) -> None:
        super().__init__()
        robot = load_robot(self.value("robot_file"))
        self.teleop = KeyTeleop(KeySettings.from_robot(robot, **self.tuning(KeySettings)))
        self.decoder = KeyDecoder()
        self.output = TeleopOutput(self, robot, self.teleop.twist)
        self.terminal = RawTerminal(sys.stdin.fileno())
        atexit.register(self.terminal.restore)  # whatever ends this process but SIGKILL
        print(HELP, flush=True)
        self._show_speeds()
        self.every_wall(1.0 / robot.control.rate_hz, self.on_time)

    def on_time(self) -> None:
        """Take in what has been typed, and say what that asks for."""
        before = self.teleop.speeds
        try:
            keys = self.decoder.feed(self.terminal.read())
        except NoTerminalError as error:
            self.request_exit(1, str(error))
            return
        for key in keys:
            self.teleop.press(key, time.monotonic())
        if self.teleop.speeds != before:
            self._show_speeds()
        self.output.publish()

    def safe_stop(self) -> None:
        """The terminal gets back its manners."""
        self.terminal.restore()
        self.output.stop()

    def _show_speeds(self) -> None:
        speeds = self.teleop.speeds
        text = f"{speeds.speed_mps:.2f} m/s, {speeds.yaw_rate_radps:.2f} rad/s"
        print(f"  {text}", flush=True)
        self.diagnostics.report("keys", Level.OK, text)


def main() -> int:
    """Run the node; the exit code of the process."""
    return run(TeleopKeyboardNode)


if __name__ == "__main__":
    sys.exit(main())
