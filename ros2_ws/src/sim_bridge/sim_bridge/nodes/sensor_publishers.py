"""Topics of the simulated robot."""

from functools import partial

from geometry_msgs.msg import AccelStamped
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu, JointState, LaserScan
from tracked_interfaces.msg import SlipEstimate

from node_kit import StackNode, qos
from node_kit.conversions import (
    body_state_to_message,
    clock_to_message,
    imu_to_message,
    scan_to_message,
    slip_to_message,
    tracks_to_message,
    vertical_acceleration_to_message,
)
from sim_bridge.sensor_suite import SensorBatch
from tracked_description import Robot, suspension_joint_names

WORLD_FRAME = "world"


class SensorPublishers:
    """Publishes what the sensors deliver at each tick, and the clock.

    Everything is offered reliably: in lock-step a lost sample would stall the world. Subscribers that ask for
    best effort get that. The robot's frame names carry their prefix already.
    """

    def __init__(self, node: StackNode, robot: Robot) -> None:
        base, world = robot.frames.base_footprint, node.frame(WORLD_FRAME)
        joints = partial(
            tracks_to_message,
            wheel_radius_m=robot.tracks.wheel_radius_m,
            suspension_joints=suspension_joint_names(robot),
        )
        body = partial(body_state_to_message, frame_id=world, child_frame_id=base)
        slip = partial(slip_to_message, frame_id=base)
        acceleration = partial(vertical_acceleration_to_message, frame_id=world)
        self._clock = node.publish_typed(Clock, "clock", clock_to_message, qos.STATE)
        self._imu = node.publish_typed(Imu, "imu/data", imu_to_message, qos.STATE)
        self._joints = node.publish_typed(JointState, "joint_states", joints, qos.STATE)
        self._scan = node.publish_typed(LaserScan, "scan", scan_to_message, qos.STATE)
        self._truth = node.publish_typed(Odometry, "ground_truth/odom", body, qos.STATE)
        self._truth_slip = node.publish_typed(SlipEstimate, "ground_truth/slip", slip, qos.STATE)
        self._acceleration = node.publish_typed(AccelStamped, "ground_truth/acceleration", acceleration, qos.STATE)

    def publish(self, batch: SensorBatch) -> None:
        """Send what listeners get at one tick, the clock first."""
        if batch.truth:
            self._clock.publish(batch.stamp_ns)
        for imu in batch.imu:
            self._imu.publish(imu)
        for tracks in batch.tracks:
            self._joints.publish(tracks, batch.suspension_travel_m)
        for scan in batch.scans:
            self._scan.publish(scan)
        for state in batch.truth:
            self._truth.publish(state)
            self._acceleration.publish(state)
        for slip in batch.truth_slip:
            self._truth_slip.publish(slip)
