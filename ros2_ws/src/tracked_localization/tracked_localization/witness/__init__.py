"""The lidar as third witness of slip, beside gyro and belts."""
