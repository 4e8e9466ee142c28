"""Node ekf: odometry and slip from belt counters and IMU."""

import sys
from dataclasses import replace
from functools import partial
from typing import Any

from geometry_msgs.msg import PoseWithCovarianceStamped
from nav_msgs.msg import Odometry as OdometryMessage
from sensor_msgs.msg import Imu, JointState
from std_srvs.srv import Trigger
from tracked_interfaces.msg import SlipEstimate

from node_kit import Level, Parameter, ParameterTable, StackNode, qos, run
from node_kit.conversions import (
    imu_from_message,
    odometry_to_message,
    pose_sample_from_message,
    slip_to_message,
    tracks_from_message,
)
from tracked_description import ROBOT_FILE, load_robot
from tracked_localization import Estimate, Health, OdometryFilter, OdometryFilterSettings, SlipSettings
from tracked_types import ImuSample, PoseSample, TrackSample

FUSE_POSE = Parameter("fuse_pose", False, "listen to `pose`: measured poses in the odometry's frame, however late")
PARAMETERS = ParameterTable.from_settings(
    OdometryFilterSettings, SlipSettings, extra=(qos.RELIABLE_SENSORS, FUSE_POSE, Parameter(*ROBOT_FILE))
)
_WATCH_PERIOD_S = 0.1


class EkfNode(StackNode):
    """Subscribes imu/data, joint_states, maybe pose; publishes odom, slip, the transform odom -> base_footprint."""

    NAME = "ekf"
    PARAMETERS = PARAMETERS

    def __init__(self) -> None:
        super().__init__()
        robot = load_robot(self.value("robot_file"))
        slip = SlipSettings.from_robot(robot, **self.tuning(SlipSettings))
        settings = OdometryFilterSettings.from_robot(robot, slip, **self.tuning(OdometryFilterSettings))
        self.filter = OdometryFilter(
            replace(settings, odom_frame=self.frame(settings.odom_frame), base_frame=self.frame(settings.base_frame))
        )
        to_slip_message = partial(slip_to_message, frame_id=self.frame(settings.base_frame))
        self.odometry = self.publish_typed(OdometryMessage, "odom", odometry_to_message, qos.STATE)
        self.slip = self.publish_typed(SlipEstimate, "slip", to_slip_message, qos.STATE)
        self.transforms.advertise()
        to_tracks = partial(tracks_from_message, wheel_radius_m=robot.tracks.wheel_radius_m)
        sensor = qos.sensor(reliable=self.value(qos.RELIABLE_SENSORS.name))
        imu_frame = self.frame(robot.frames.imu)
        self.subscribe_typed(Imu, "imu/data", imu_from_message, self.on_imu, sensor, expected_frame=imu_frame)
        self.subscribe_typed(JointState, "joint_states", to_tracks, self.on_tracks, sensor)
        if self.value(FUSE_POSE.name):
            self.filter.expect_poses()
            odom_frame = self.frame(settings.odom_frame)
            self.subscribe_typed(
                PoseWithCovarianceStamped,
                "pose",
                pose_sample_from_message,
                self.on_pose,
                sensor,
                expected_frame=odom_frame,
            )
        self.serve(Trigger, "reset_odometry", self.on_reset)
        self.every_wall(_WATCH_PERIOD_S, self.on_watch)

    def on_imu(self, sample: ImuSample) -> None:
        """One sample in; estimates out."""
        self._publish(self.filter.add_imu(sample))

    def on_tracks(self, sample: TrackSample) -> None:
        """One sample in; estimates out."""
        self._publish(self.filter.add_tracks(sample))

    def on_pose(self, sample: PoseSample) -> None:
        """One measured pose in; the estimates to come know of it."""
        self._publish(self.filter.add_pose(sample))

    def on_reset(self, _request: Any, response: Any) -> Any:
        """Put the odometry back to the origin."""
        self.filter.reset()
        response.success, response.message = True, "odometry starts at the origin"
        return response

    def on_watch(self) -> None:
        """Say how the sensors are, even if none of them speaks."""
        self._report(self.filter.health_at(self.get_clock().now().nanoseconds))

    def _publish(self, estimates: list[Estimate]) -> None:
        for estimate in estimates:
            odometry = estimate.odometry
            self.odometry.publish(odometry)
            self.slip.publish(estimate.slip)
            x, y, yaw = odometry.pose.x_m, odometry.pose.y_m, odometry.pose.yaw_rad
            self.transforms.send(
                odometry.frame_id, odometry.child_frame_id, x, y, 0.0, 0.0, 0.0, yaw, odometry.stamp_ns
            )

    def _report(self, health: Health) -> None:
        level = Level.WARN if health.culprits else Level.OK
        if not health.advancing:
            level = Level.ERROR
        values = {
            "advances": health.advancing,
            "at rest": health.standing,
            "gyro bias (rad/s)": self.filter.gyro_bias_radps,
        }
        self.diagnostics.report("odometry", level, health.summary, values | dict(health.counts))


def main() -> int:
    """Run the node; the exit code of the process."""
    return run(EkfNode)


if __name__ == "__main__":
    sys.exit(main())
