"""Unit quaternions (x, y, z, w) and REP-103 fixed-axis roll, pitch, yaw (rad)."""

import math

Quaternion = tuple[float, float, float, float]


def quaternion_from_yaw(yaw: float) -> Quaternion:
    """Rotation by ``yaw`` about z."""
    return 0.0, 0.0, math.sin(0.5 * yaw), math.cos(0.5 * yaw)


def quaternion_from_roll_pitch_yaw(roll: float, pitch: float, yaw: float) -> Quaternion:
    """Rotation by roll about x, then pitch about y, then yaw about z, all fixed axes."""
    sr, cr = math.sin(0.5 * roll), math.cos(0.5 * roll)
    sp, cp = math.sin(0.5 * pitch), math.cos(0.5 * pitch)
    sy, cy = math.sin(0.5 * yaw), math.cos(0.5 * yaw)
    return (
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    )


def yaw_from_quaternion(x: float, y: float, z: float, w: float) -> float:
    """Heading of a unit quaternion, in [-pi, pi]."""
    return math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))


def roll_pitch_yaw_from_quaternion(x: float, y: float, z: float, w: float) -> tuple[float, float, float]:
    """Fixed-axis angles of a unit quaternion; at pitch = +-pi/2, where they are not unique, roll is 0."""
    sine = 2.0 * (w * y - z * x)
    if abs(sine) >= 1.0 - 1e-12:
        return 0.0, math.copysign(0.5 * math.pi, sine), -2.0 * math.copysign(1.0, sine) * math.atan2(x, w)
    roll = math.atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
    return roll, math.asin(sine), yaw_from_quaternion(x, y, z, w)


def multiply(first: Quaternion, second: Quaternion) -> Quaternion:
    """Hamilton product: the rotation ``second`` followed by ``first``."""
    ax, ay, az, aw = first
    bx, by, bz, bw = second
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def rotate(quaternion: Quaternion, vector: tuple[float, float, float]) -> tuple[float, float, float]:
    """``vector`` turned by a unit quaternion."""
    x, y, z, w = quaternion
    vx, vy, vz = vector
    tx, ty, tz = 2.0 * (y * vz - z * vy), 2.0 * (z * vx - x * vz), 2.0 * (x * vy - y * vx)
    return (
        vx + w * tx + y * tz - z * ty,
        vy + w * ty + z * tx - x * tz,
        vz + w * tz + x * ty - y * tx,
    )


def slerp(start: Quaternion, end: Quaternion, weight: float) -> Quaternion:
    """Shortest rotation from ``start`` (weight 0) to ``end`` (weight 1), normalised."""
    cosine = sum(a * b for a, b in zip(start, end, strict=True))
    sign = 1.0 if cosine >= 0.0 else -1.0
    angle = math.acos(min(1.0, abs(cosine)))
    if angle < 1e-6:
        first, second = 1.0 - weight, sign * weight
    else:
        first = math.sin((1.0 - weight) * angle) / math.sin(angle)
        second = sign * math.sin(weight * angle) / math.sin(angle)
    x, y, z, w = (first * a + second * b for a, b in zip(start, end, strict=True))
    norm = math.sqrt(x * x + y * y + z * z + w * w)
    return x / norm, y / norm, z / norm, w / norm
