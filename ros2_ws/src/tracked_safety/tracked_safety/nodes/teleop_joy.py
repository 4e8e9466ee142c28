"""Node teleop_joy: a joystick as commands."""

import sys
import time

from sensor_msgs.msg import Joy

from node_kit import Parameter, ParameterTable, RejectedMessage, StackNode, qos, run
from node_kit.conversions import joystick_from_message
from tracked_description import ROBOT_FILE, load_robot
from tracked_safety.nodes.teleop_output import TeleopOutput
from tracked_safety.teleop.joy_teleop import JoySettings, JoystickRefused, JoyTeleop
from tracked_types import Joystick

PARAMETERS = ParameterTable.from_settings(JoySettings, extra=(Parameter(*ROBOT_FILE),))


class TeleopJoyNode(StackNode):
    """Subscribes joy; publishes cmd_vel_teleop while the dead-man's button is down and messages come."""

    NAME = "teleop_joy"
    PARAMETERS = PARAMETERS

    def __init__(self) -> None:
        super().__init__()
        robot = load_robot(self.value("robot_file"))
        self.teleop = JoyTeleop(JoySettings.from_robot(robot, **self.tuning(JoySettings)))
        self.output = TeleopOutput(self, robot, self.teleop.twist)
        self.subscribe_typed(Joy, "joy", joystick_from_message, self.on_joystick, qos.SENSOR)
        self.every_wall(1.0 / robot.control.rate_hz, self.output.publish)

    def on_joystick(self, joystick: Joystick) -> None:
        """One message; node_kit counts those that are refused."""
        try:
            self.teleop.update(joystick, self.get_clock().now().nanoseconds, time.monotonic())
        except JoystickRefused as refusal:
            raise RejectedMessage(refusal.reason) from refusal

    def safe_stop(self) -> None:
        """Rest is the last word."""
        self.output.stop()


def main() -> int:
    """Run the node; the exit code of the process."""
    return run(TeleopJoyNode)


if __name__ == "__main__":
    sys.exit(main())
