"""sensor_msgs/Imu."""

import numpy as np
from sensor_msgs.msg import Imu

from node_kit.conversions.checks import checked_covariance
from node_kit.conversions.geometry import fill_vector, quaternion_from_message, vector_from_message
from node_kit.conversions.headers import fill_header, header_from_message
from node_kit.rejection import RejectedMessage
from tracked_types import ImuSample

NOT_MEASURED = -1.0  # REP-145: in the first element of a covariance


def imu_from_message(message: Imu) -> ImuSample:
    """Sample of a message that carries angular velocity and acceleration; its orientation is checked, not used.

    Raises
    ------
    RejectedMessage: stamp, frame, a number or a covariance cannot be used, or a quantity is not measured.
    """
    stamp_ns, frame_id = header_from_message(message.header)
    if message.orientation_covariance[0] != NOT_MEASURED:
        quaternion_from_message("orientation", message.orientation)
        checked_covariance("orientation_covariance", message.orientation_covariance, 3)
    if message.angular_velocity_covariance[0] == NOT_MEASURED:
        raise RejectedMessage("not measured: angular_velocity")
    if message.linear_acceleration_covariance[0] == NOT_MEASURED:
        raise RejectedMessage("not measured: linear_acceleration")
    return ImuSample(
        stamp_ns,
        frame_id,
        np.array(vector_from_message("angular_velocity", message.angular_velocity)),
        np.array(vector_from_message("linear_acceleration", message.linear_acceleration)),
        checked_covariance("angular_velocity_covariance", message.angular_velocity_covariance, 3),
        checked_covariance("linear_acceleration_covariance", message.linear_acceleration_covariance, 3),
    )


def imu_to_message(sample: ImuSample, into: Imu | None = None) -> Imu:
    """Message without orientation (REP-145: -1); ``into`` is a message to overwrite."""
    message = Imu() if into is None else into
    fill_header(message.header, sample.stamp_ns, sample.frame_id)
    message.orientation_covariance[0] = NOT_MEASURED
    fill_vector(message.angular_velocity, *sample.angular_velocity_radps.tolist())
    fill_vector(message.linear_acceleration, *sample.linear_acceleration_mps2.tolist())
    message.angular_velocity_covariance[:] = sample.angular_velocity_covariance.ravel()
    message.linear_acceleration_covariance[:] = sample.linear_acceleration_covariance.ravel()
    return message
