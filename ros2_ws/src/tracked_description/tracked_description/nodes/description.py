"""Node that tells everybody what the robot looks like and where its sensors are."""

from std_msgs.msg import String

from node_kit import Parameter, ParameterTable, StackNode, qos, run
from node_kit.conversions import string_to_message
from tracked_description import ROBOT_FILE, load_robot, robot_urdf
from tracked_description.fixed_frames import fixed_frames


class DescriptionNode(StackNode):
    """Publishes the URDF on robot_description and the fixed frames on tf_static, both latched."""

    NAME = "description"
    PARAMETERS = ParameterTable(Parameter(*ROBOT_FILE))

    def __init__(self) -> None:
        super().__init__()
        robot = load_robot(self.value("robot_file"))
        self.urdf = self.publish_typed(String, "robot_description", string_to_message, qos.LATCHED)
        self.urdf.publish(robot_urdf(robot, self.frame("")))
        for fixed in fixed_frames(robot):
            self.transforms.send_static(self.frame(fixed.parent), self.frame(fixed.child), *fixed.xyz_m, *fixed.rpy_rad)


def main() -> int:
    """Run the node; returns the exit code."""
    return run(DescriptionNode)
