"""The bio-inspired X structure of (4.1.1)-(4.1.3): n layers of crossed rods held by one horizontal spring.

The travel y is the change of the structure's height: zero at the assembly angle, negative in compression.
With h = L sin(alpha) + y / (2n) and w = sqrt(L^2 - h^2), half a layer's height and width, the spring is
extended by s = 2 L cos(alpha) - 2 w (+ preload s0), so that

    force      -k_h (s + s0) s'           s'  = h / (n w)
    stiffness   k_h (s'^2 + (s + s0) s'') s'' = L^2 / (2 n^2 w^3)
    damping     c n_x / (n w)^2           n_x joints that turn by 1 / (n w) per unit of travel.

Neither the Taylor forms of (4.1.4)-(4.1.6) nor (5.1.1) know gravity; the exact law does, through the travel
at which it is evaluated (see docs/errata.md (4.1.3)).
"""

import math
from dataclasses import dataclass

STANDARD_GRAVITY_MPS2 = 9.81


def restoring_force(
    travel_m: float,
    spring_npm: float,
    rod_length_m: float,
    rest_height_m: float,
    rest_width_m: float,
    layers: float,
    preload_m: float,
) -> float:
    """Upward force of the structure on what it carries (N).

    ``rest_height_m`` = L sin(alpha) and ``rest_width_m`` = L cos(alpha); the travel must leave
    0 < h < L. Plain floats only, so that a simulator can compile it.
    """
    height = rest_height_m + travel_m / (2.0 * layers)
    width = math.sqrt(rod_length_m * rod_length_m - height * height)
    extension = 2.0 * (rest_width_m - width) + preload_m
    return -spring_npm * extension * height / (layers * width)


def tangent_stiffness(
    travel_m: float,
    spring_npm: float,
    rod_length_m: float,
    rest_height_m: float,
    rest_width_m: float,
    layers: float,
    preload_m: float,
) -> float:
    """Minus the derivative of :func:`restoring_force` by the travel (N/m); negative beyond the peak load."""
    height = rest_height_m + travel_m / (2.0 * layers)
    width = math.sqrt(rod_length_m * rod_length_m - height * height)
    extension = 2.0 * (rest_width_m - width) + preload_m
    slope = height / (layers * width)
    curvature = rod_length_m * rod_length_m / (2.0 * layers * layers * width * width * width)
    return spring_npm * (slope * slope + extension * curvature)


def tangent_damping(
    travel_m: float, joint_damping_nms: float, rod_length_m: float, rest_height_m: float, layers: float
) -> float:
    """Damping of the travel (N s/m) by all joints together; ``joint_damping_nms`` is c n_x, their sum."""
    height = rest_height_m + travel_m / (2.0 * layers)
    width_squared = rod_length_m * rod_length_m - height * height
    return joint_damping_nms / (layers * layers * width_squared)


class SnapThroughError(ValueError):
    """The structure cannot carry the load: it snaps through to its stop."""


@dataclass(frozen=True, slots=True)
class XStructure:
    """One unit of the suspension (or of the vibration sensor).

    Parameters
    ----------
    layers: n, number of layers.
    rod_length_m: L, half the length of a rod.
    angle_rad: alpha, angle of the rods to the horizontal at assembly.
    spring_npm: k_h, stiffness of the horizontal spring.
    joint_damping_nms: c, viscous friction of one joint.
    joints: n_x; None means 3 n + 1.
    preload_m: s0, extension of the spring at the assembly angle; negative when it is stretched there.

    Raises
    ------
    ValueError: for parameters outside the range in which the structure exists.
    """

    layers: int
    rod_length_m: float
    angle_rad: float
    spring_npm: float
    joint_damping_nms: float = 0.0
    joints: int | None = None
    preload_m: float = 0.0

    def __post_init__(self) -> None:
        if self.layers < 1 or self.layers != int(self.layers):
            raise ValueError(f"layers must be a whole number of at least 1, got {self.layers!r}")
        for name in ("rod_length_m", "spring_npm"):
            value = getattr(self, name)
            if not (value > 0.0 and math.isfinite(value)):
                raise ValueError(f"{name} must be positive and finite, got {value!r}")
        if not 0.0 < self.angle_rad < math.pi / 2.0:
            raise ValueError(f"angle_rad must lie between 0 and pi/2, got {self.angle_rad!r}")
        if not 0.0 < self._free_cosine < 1.0:
            raise ValueError(f"preload_m = {self.preload_m!r} leaves no height at which the spring is relaxed")

    @property
    def joint_count(self) -> int:
        """n_x, 3 n + 1 unless given."""
        return 3 * self.layers + 1 if self.joints is None else self.joints

    @property
    def rest_height_m(self) -> float:
        """Half a layer's height at assembly, L sin(alpha)."""
        return self.rod_length_m * math.sin(self.angle_rad)

    @property
    def rest_width_m(self) -> float:
        """Half a layer's width at assembly, L cos(alpha)."""
        return self.rod_length_m * math.cos(self.angle_rad)

    @property
    def travel_limits_m(self) -> tuple[float, float]:
        """Travel at which the rods lie flat and at which they stand upright."""
        per_layer = 2.0 * self.layers
        return -per_layer * self.rest_height_m, per_layer * (self.rod_length_m - self.rest_height_m)

    @property
    def _free_cosine(self) -> float:
        """Cosine of the rod angle at which the spring is relaxed."""
        return math.cos(self.angle_rad) + 0.5 * self.preload_m / self.rod_length_m

    def _travel_at(self, angle_rad: float) -> float:
        return 2.0 * self.layers * (self.rod_length_m * math.sin(angle_rad) - self.rest_height_m)

    def force_n(self, travel_m: float) -> float:
        """Upward force at a travel (N)."""
        return restoring_force(
            travel_m,
            self.spring_npm,
            self.rod_length_m,
            self.rest_height_m,
            self.rest_width_m,
            self.layers,
            self.preload_m,
        )

    def stiffness_npm(self, travel_m: float) -> float:
        """Tangent stiffness at a travel (N/m)."""
        return tangent_stiffness(
            travel_m,
            self.spring_npm,
            self.rod_length_m,
            self.rest_height_m,
            self.rest_width_m,
            self.layers,
            self.preload_m,
        )

    def damping_nspm(self, travel_m: float) -> float:
        """Tangent damping at a travel (N s/m)."""
        total = self.joint_damping_nms * self.joint_count
        return tangent_damping(travel_m, total, self.rod_length_m, self.rest_height_m, self.layers)

    @property
    def peak_travel_m(self) -> float:
        """Travel of zero stiffness, where the structure carries most; it is unstable in deeper compression."""
        return self._travel_at(math.acos(self._free_cosine ** (1.0 / 3.0)))

    @property
    def peak_load_n(self) -> float:
        """Largest static load (N), the plateau of Fig. 5.1."""
        return self.force_n(self.peak_travel_m)

    def equilibrium_m(self, load_n: float) -> float:
        """Stable travel under a static load (m).

        Raises
        ------
        SnapThroughError: if the load is not below the peak load.
        ValueError: if the load is negative or not a number.
        """
        if not load_n >= 0.0:
            raise ValueError(f"load_n must not be negative, got {load_n!r}")
        low, high = self.peak_travel_m, self._travel_at(math.acos(self._free_cosine))
        if load_n >= self.force_n(low):
            raise SnapThroughError(
                f"a load of {load_n:.2f} N per unit snaps the X structure through: {self.layers} layers with "
                f"k_h = {self.spring_npm:g} N/m carry less than {self.force_n(low):.2f} N"
            )
        while True:
            middle = 0.5 * (low + high)
            if middle in (low, high):
                return middle
            if self.force_n(middle) > load_n:
                low = middle
            else:
                high = middle

    def natural_frequency_hz(self, mass_kg: float, *, gravity: bool = True) -> float:
        """Natural frequency of a mass on the structure (Hz).

        With gravity, of small motion about the equilibrium under the mass's weight; without, at the
        assembly angle, which for zero preload is (5.1.1) as printed.

        Raises
        ------
        SnapThroughError: if the structure cannot carry the mass.
        """
        travel = self.equilibrium_m(mass_kg * STANDARD_GRAVITY_MPS2) if gravity else 0.0
        return math.sqrt(self.stiffness_npm(travel) / mass_kg) / (2.0 * math.pi)
