"""Arrays that the belt-force model carries from step to step, and those it works in."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
CONTACT_CAPACITY = 128
PAIR_CAPACITY = 512


class BeltState(NamedTuple):
    """What must be saved and restored together with the rigid body; index 0 is the left side.

    travel, travel_rate: (2, wheels) suspension travel (m, negative in compression) and its rate.
    shear: (2, bars, 2) longitudinal and lateral shear of the belt on the ground (m).
    belt_speed, belt_travel: (2,).
    profile, setpoint, error, integral, motor_force: (2,) state of the drives.
    """

    travel: Array
    travel_rate: Array
    shear: Array
    belt_speed: Array
    belt_travel: Array
    profile: Array
    setpoint: Array
    error: Array
    integral: Array
    motor_force: Array

    def copy(self) -> "BeltState":
        """Independent copy."""
        return BeltState(*(array.copy() for array in self))

    def assign(self, other: "BeltState") -> None:
        """Overwrite the arrays in place with those of ``other``."""
        for mine, theirs in zip(self, other, strict=True):
            mine[...] = theirs


class Workspace(NamedTuple):
    """Per-step results that nothing needs after the next step.

    rotation: (3, 3) body to world. nodes: (2, wheels + 2, 3) outer side of the belt below idlers and wheels.
    bars: (2 (wheels + 1), 7) pose of each straight piece of belt: centre and quaternion (x, y, z, w).
    pairs: (PAIR_CAPACITY, 2) bar and entity that may touch.
    wrench: (6,) force and torque on the chassis about its centre of mass.
    load: (2, bars) normal load of each bar. thrust: (2,) ground force along each belt.
    """

    rotation: Array
    nodes: Array
    bars: Array
    pairs: NDArray[np.int64]
    wrench: Array
    load: Array
    thrust: Array


class Contacts(NamedTuple):
    """Points at which belts touch the world; rows beyond the current count are stale.

    side, bar: which belt and which piece of it. position, normal: (., 3) world; the normal points at the robot.
    depth: penetration (m). weight: share of the contact stiffness. surface_velocity: (., 3) of the touched body.
    friction: (., 2) longitudinal and lateral, NaN where zones and the world's floor decide. load: normal force (N).
    force: (., 3) force on the robot (N).
    """

    side: NDArray[np.int64]
    bar: NDArray[np.int64]
    position: Array
    normal: Array
    depth: Array
    weight: Array
    surface_velocity: Array
    friction: Array
    load: Array
    force: Array


def new_state(wheels: int, rest_travel_m: float) -> BeltState:
    """State at rest on flat ground."""
    pair = (2,)
    return BeltState(
        travel=np.full((2, wheels), rest_travel_m),
        travel_rate=np.zeros((2, wheels)),
        shear=np.zeros((2, wheels + 1, 2)),
        **{name: np.zeros(pair) for name in BeltState._fields[3:]},
    )


def new_workspace(wheels: int) -> Workspace:
    """Workspace for ``wheels`` road wheels per side."""
    return Workspace(
        rotation=np.eye(3),
        nodes=np.zeros((2, wheels + 2, 3)),
        bars=np.zeros((2 * (wheels + 1), 7)),
        pairs=np.zeros((PAIR_CAPACITY, 2), dtype=np.int64),
        wrench=np.zeros(6),
        load=np.zeros((2, wheels + 1)),
        thrust=np.zeros(2),
    )


def new_contacts() -> Contacts:
    """Empty contact buffers."""
    scalar, vector = (CONTACT_CAPACITY,), (CONTACT_CAPACITY, 3)
    return Contacts(
        side=np.zeros(scalar, dtype=np.int64),
        bar=np.zeros(scalar, dtype=np.int64),
        position=np.zeros(vector),
        normal=np.zeros(vector),
        depth=np.zeros(scalar),
        weight=np.zeros(scalar),
        surface_velocity=np.zeros(vector),
        friction=np.zeros((CONTACT_CAPACITY, 2)),
        load=np.zeros(scalar),
        force=np.zeros(vector),
    )
