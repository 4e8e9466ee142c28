"""Rigid transform in space."""

from dataclasses import dataclass

from node_kit.rotations import (
    Quaternion,
    multiply,
    quaternion_from_roll_pitch_yaw,
    roll_pitch_yaw_from_quaternion,
    rotate,
    slerp,
)


@dataclass(frozen=True, slots=True)
class RigidTransform:
    """Pose of a child frame in its parent: translation (m) and unit quaternion (x, y, z, w)."""

    translation_m: tuple[float, float, float]
    quaternion: Quaternion

    @classmethod
    def identity(cls) -> "RigidTransform":
        """No motion."""
        return cls((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0))

    @classmethod
    def from_euler(cls, x: float, y: float, z: float, roll: float, pitch: float, yaw: float) -> "RigidTransform":
        """Transform from a position (m) and REP-103 fixed-axis angles (rad)."""
        return cls((x, y, z), quaternion_from_roll_pitch_yaw(roll, pitch, yaw))

    @property
    def roll_pitch_yaw_rad(self) -> tuple[float, float, float]:
        """REP-103 fixed-axis angles."""
        return roll_pitch_yaw_from_quaternion(*self.quaternion)

    def compose(self, other: "RigidTransform") -> "RigidTransform":
        """``other``, given in this child frame, expressed in this parent frame."""
        dx, dy, dz = rotate(self.quaternion, other.translation_m)
        x, y, z = self.translation_m
        return RigidTransform((x + dx, y + dy, z + dz), multiply(self.quaternion, other.quaternion))

    def inverse(self) -> "RigidTransform":
        """Pose of the parent frame in the child."""
        x, y, z, w = self.quaternion
        conjugate = (-x, -y, -z, w)
        tx, ty, tz = rotate(conjugate, self.translation_m)
        return RigidTransform((-tx, -ty, -tz), conjugate)

    def interpolate(self, other: "RigidTransform", weight: float) -> "RigidTransform":
        """Straight line and shortest rotation from this (weight 0) to ``other`` (weight 1)."""
        x, y, z = (a + weight * (b - a) for a, b in zip(self.translation_m, other.translation_m, strict=True))
        return RigidTransform((x, y, z), slerp(self.quaternion, other.quaternion, weight))


@dataclass(frozen=True, slots=True)
class StampedTransform:
    """Pose of ``child`` in ``parent`` at one instant."""

    stamp_ns: int
    parent: str
    child: str
    transform: RigidTransform
