"""States of the last moments, so that a measurement that comes late corrects the state of now.

What the filter does to errors between two instants is linear: the product of its transitions and corrections. A late
measurement corrects the state of its own instant as it would have then, and that product carries the correction on to
every later state (Larsen et al. 1998). The covariance stays true. All that is lost against fusing in time is that the
gains of the meantime were made without it, which is next to nothing for gyro and belts: they do not see the pose.
"""

from collections import deque
from dataclasses import dataclass

import numpy as np

from tracked_localization.state import SIZE, Array
from tracked_types import Pose2, wrap_angle

_IDENTITY = np.eye(SIZE)


@dataclass(slots=True)
class Snapshot:
    """State (11,) and covariance (11, 11) at one instant, and what becomes of their errors until the next one."""

    stamp_ns: int
    state: Array
    covariance: Array
    onward: Array

    @property
    def pose(self) -> Pose2:
        """Its pose."""
        return Pose2(float(self.state[0]), float(self.state[1]), wrap_angle(float(self.state[2])))


class PoseMemory:
    """Snapshots in the order of their stamps; it costs nothing until `begin`."""

    def __init__(self, length_ns: int) -> None:
        self._length_ns = length_ns
        self._snapshots: deque[Snapshot] = deque()
        self.active = False

    def begin(self) -> None:
        """Remember from now on."""
        self.active = True

    def clear(self) -> None:
        """The state has been set by other means than motion and measurement."""
        self._snapshots.clear()

    def carry(self, change: Array) -> None:
        """Errors of the state were multiplied by ``change`` (11, 11)."""
        if self._snapshots:
            last = self._snapshots[-1]
            last.onward = change @ last.onward

    def correct(self, gain: Array, measured: Array) -> None:
        """The state was corrected with ``gain`` (11, 1) by a measurement of the row ``measured`` (1, 11)."""
        if self._snapshots:
            last = self._snapshots[-1]
            last.onward -= gain @ (measured @ last.onward)

    def drop(self, *components: int) -> None:
        """These components were set anew: errors of before do not reach them."""
        if self._snapshots:
            self._snapshots[-1].onward[list(components)] = 0.0

    def mark(self, stamp_ns: int, state: Array, covariance: Array) -> None:
        """Remember the present state."""
        if not self.active:
            return
        self._snapshots.append(Snapshot(stamp_ns, state.copy(), covariance.copy(), _IDENTITY.copy()))
        while self._snapshots[0].stamp_ns < stamp_ns - self._length_ns:
            self._snapshots.popleft()

    @property
    def oldest_ns(self) -> int | None:
        """Stamp of the oldest snapshot."""
        return self._snapshots[0].stamp_ns if self._snapshots else None

    @property
    def newest_ns(self) -> int | None:
        """Stamp of the newest snapshot."""
        return self._snapshots[-1].stamp_ns if self._snapshots else None

    def nearest(self, stamp_ns: int) -> Snapshot:
        """The snapshot nearest to an instant between the oldest and the newest."""
        return min(self._snapshots, key=lambda snapshot: abs(snapshot.stamp_ns - stamp_ns))

    def pose_between(self, stamp_ns: int) -> Pose2:
        """Pose at an instant between the oldest and the newest, interpolated."""
        stamps = [snapshot.stamp_ns for snapshot in self._snapshots]
        after = next(index for index, stamp in enumerate(stamps) if stamp >= stamp_ns)
        late = self._snapshots[after]
        if late.stamp_ns == stamp_ns:
            return late.pose
        early = self._snapshots[after - 1]
        share = (stamp_ns - early.stamp_ns) / (late.stamp_ns - early.stamp_ns)
        step = early.pose.inverse().compose(late.pose)
        return early.pose.compose(Pose2(share * step.x_m, share * step.y_m, share * step.yaw_rad))

    def apply(self, snapshot: Snapshot, innovation: Array, variance: Array, state: Array, covariance: Array) -> None:
        """Correct a snapshot by what was measured of its pose, and with it all that came after, the present included.

        innovation: (3,), of the variance (3, 3). Older snapshots stay as they are; what comes of them even later
        passes through this correction. It then counts a little less than in order, and the covariance knows.
        """
        # Scaled to unit variance, corrections of covariances are exactly symmetric: minus a matrix times its transpose.
        root = np.linalg.cholesky(variance)
        unit_innovation: Array = np.linalg.solve(root, innovation)
        unit_gain: Array = np.linalg.solve(root, snapshot.covariance[:3]).T
        carry = None
        for place, later in enumerate(self._snapshots):
            if later is snapshot:
                carry = unit_gain
                if place > 0:
                    before = self._snapshots[place - 1]
                    before.onward -= unit_gain @ np.linalg.solve(root, before.onward[:3])
            if carry is not None:
                _correct(later.state, later.covariance, carry, unit_innovation)
                carry = later.onward @ carry
        if carry is not None:
            _correct(state, covariance, carry, unit_innovation)


def _correct(state: Array, covariance: Array, unit_gain: Array, unit_innovation: Array) -> None:
    state += unit_gain @ unit_innovation
    state[2] = wrap_angle(float(state[2]))
    covariance -= unit_gain @ unit_gain.T
