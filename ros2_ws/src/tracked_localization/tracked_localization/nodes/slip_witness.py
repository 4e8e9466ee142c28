"""Node slip_witness: slip from belts, gyro and scans together; tracks that turn under a robot that does not move."""

import sys
from functools import partial

from geometry_msgs.msg import PoseWithCovarianceStamped
from nav_msgs.msg import Odometry as OdometryMessage
from sensor_msgs.msg import Imu, JointState
from sensor_msgs.msg import LaserScan as LaserScanMessage
from tracked_interfaces.msg import Traction as TractionMessage

from node_kit import Level, Parameter, ParameterTable, StackNode, qos, run
from node_kit.conversions import (
    imu_from_message,
    odometry_from_message,
    pose_sample_to_message,
    scan_from_message,
    tracks_from_message,
    traction_to_message,
)
from tracked_description import ROBOT_FILE, load_robot
from tracked_localization.witness.odometry_anchor import OdometryAnchor
from tracked_localization.witness.scan_motion import ScanMotionSettings
from tracked_localization.witness.settings import WitnessSettings
from tracked_localization.witness.slip_witness import SlipWitness
from tracked_types import Grip, ImuSample, LaserScan, Odometry, PeriodGrid, TrackSample, Traction

FEED_POSE = Parameter(
    "feed_pose",
    False,
    "publish the way by scans on `pose`, where there is no map: never together with a localiser that does",
)
PARAMETERS = ParameterTable.from_settings(
    WitnessSettings, ScanMotionSettings, extra=(FEED_POSE, qos.RELIABLE_SENSORS, Parameter(*ROBOT_FILE))
)


class SlipWitnessNode(StackNode):
    """Subscribes imu/data, joint_states, scan; publishes traction.

    With feed_pose it also subscribes odom and publishes pose, which teaches ekf the longitudinal slip.
    """

    NAME = "slip_witness"
    PARAMETERS = PARAMETERS

    def __init__(self) -> None:
        super().__init__()
        robot = load_robot(self.value("robot_file"))
        settings = WitnessSettings.from_robot(robot, **self.tuning(WitnessSettings))
        self.witness = SlipWitness(settings, ScanMotionSettings(**self.tuning(ScanMotionSettings)))
        to_traction = partial(traction_to_message, frame_id=self.frame(robot.frames.base_footprint))
        self.traction = self.publish_typed(TractionMessage, "traction", to_traction, qos.STATE)
        self._grid = PeriodGrid(robot.lidar.rate_hz)
        self._told: Traction | None = None
        self._scan_reason = "no scan yet"
        sensor, subscribe = qos.sensor(reliable=self.value(qos.RELIABLE_SENSORS.name)), self.subscribe_typed
        to_tracks = partial(tracks_from_message, wheel_radius_m=robot.tracks.wheel_radius_m)
        frames = robot.frames
        subscribe(Imu, "imu/data", imu_from_message, self.on_imu, sensor, expected_frame=self.frame(frames.imu))
        subscribe(JointState, "joint_states", to_tracks, self.on_tracks, sensor)
        subscribe(
            LaserScanMessage, "scan", scan_from_message, self.on_scan, sensor, expected_frame=self.frame(frames.lidar)
        )
        self.anchor = None
        if self.value(FEED_POSE.name):
            self.anchor, self._odom_frame = OdometryAnchor(), self.frame(frames.odom)
            self.poses = self.publish_typed(PoseWithCovarianceStamped, "pose", pose_sample_to_message, qos.STATE)
            subscribe(
                OdometryMessage,
                "odom",
                odometry_from_message,
                self.on_odometry,
                qos.STATE,
                expected_frame=self._odom_frame,
            )

    def on_imu(self, sample: ImuSample) -> None:
        """One sample in."""
        self.witness.add_imu(sample)

    def on_tracks(self, sample: TrackSample) -> None:
        """One sample in; traction out when it has changed, and with every scan period."""
        witnessed = self.witness.add_tracks(sample)
        if witnessed is None:
            return
        traction, told = witnessed.traction, self._told
        if told is None or traction.grip is not told.grip or self._grid.is_instant(traction.stamp_ns):
            self.traction.publish(traction)
            self._tell(traction)

    def on_scan(self, scan: LaserScan) -> None:
        """One scan in; where it says that the robot is, if somebody wants to know."""
        step = self.witness.add_scan(scan)
        self._scan_reason = "nothing known of the motion" if step is None else step.reason
        if self.anchor is None:
            return
        if step is None or step.step is None:
            self.anchor.release()
            return
        pose = self.anchor.pose(step, self._odom_frame)
        if pose is not None:
            self.poses.publish(pose)

    def on_odometry(self, odometry: Odometry) -> None:
        """Where the odometry is."""
        if self.anchor is not None:
            self.anchor.add_odometry(odometry)

    def _tell(self, traction: Traction) -> None:
        blocked, before = traction.grip is Grip.BLOCKED, self._told
        if blocked and (before is None or before.grip is not Grip.BLOCKED):
            self.get_logger().warning(traction.reason)
        self._told = traction
        values: dict[str, object] = {
            "share lost to the ground": traction.lost_share,
            "its variance": traction.lost_share_variance,
            "yaw multiplier": traction.yaw_multiplier,
            "scan": self._scan_reason or "seen",
        }
        sentence = traction.reason if blocked else traction.grip.value
        self.diagnostics.report(
            "traction", Level.WARN if blocked else Level.OK, sentence, values | dict(self.witness.refused)
        )


def main() -> int:
    """Run the node; the exit code of the process."""
    return run(SlipWitnessNode)


if __name__ == "__main__":
    sys.exit(main())
