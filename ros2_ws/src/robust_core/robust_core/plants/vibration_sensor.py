"""The vibration sensor of chapter 4 as a discrete plant: travel (m) and its rate (m/s) of an X structure under a mass.

Forward Euler as in (4.1.9)-(4.1.11). The nonlinear term enters with D_f = (0, -Ts): the printed sign doubles the error
instead of removing it (erratum 4.1.10).
"""

import math
from dataclasses import dataclass

import numpy as np

from robust_core.checks import finite_number
from robust_core.models.lipschitz_plant import LipschitzPlant


@dataclass(frozen=True, slots=True, kw_only=True)
class VibrationSensor:
    """Table 4.3 and the identified friction; joint_damping_nms is c, of one of 3 n + 1 joints (N m s/rad)."""

    mass_kg: float = 0.21
    rod_length_m: float = 0.10
    angle_rad: float = 0.13 * math.pi
    layers: int = 3
    spring_npm: float = 390.0
    joint_damping_nms: float = 0.052
    period_s: float = 0.001

    def __post_init__(self) -> None:
        for name in ("mass_kg", "rod_length_m", "angle_rad", "layers", "spring_npm", "joint_damping_nms", "period_s"):
            finite_number(name, getattr(self, name), low=0.0, open_low=True)

    @property
    def stiffness(self) -> tuple[float, float, float]:
        """Taylor coefficients of the force over the mass: of y, y^2 and y^3, (4.1.4)."""
        alpha, L, n, secant = self.angle_rad, self.rod_length_m, self.layers, 1.0 / math.cos(self.angle_rad)
        scale = self.spring_npm / self.mass_kg
        return (
            scale * math.tan(alpha) ** 2 / n**2,
            scale * 3.0 * math.sin(alpha) * secant**4 / (4.0 * L * n**3),
            -scale * (4.0 * secant**4 - 5.0 * secant**6) / (8.0 * L**2 * n**4),
        )

    @property
    def damping(self) -> tuple[float, float, float]:
        """Taylor coefficients of the damping over the mass: constant, of y and y^2, (4.1.5)."""
        reach, secant = self.rod_length_m * self.layers, 1.0 / math.cos(self.angle_rad)
        scale = self.joint_damping_nms * (3 * self.layers + 1) / self.mass_kg
        return (
            scale * secant**2 / reach**2,
            scale * math.sin(self.angle_rad) * secant**4 / reach**3,
            -scale * (3.0 * secant**4 - 4.0 * secant**6) / (4.0 * reach**4),
        )

    def plant(self) -> LipschitzPlant:
        """The discrete plant; the fault acts like the excitation, as an acceleration of the base."""
        Ts = self.period_s
        return LipschitzPlant.of(
            A=[[1.0, Ts], [-Ts * self.stiffness[0], 1.0 - Ts * self.damping[0]]],
            B=[[0.0], [-Ts]],
            C=[[1.0, 0.0]],
            Df=[[0.0], [-Ts]],
            D=[[0.0], [Ts]],
        )

    def lipschitz_constant(self, travel_m: float, rate_mps: float, samples: int = 201) -> float:
        """Largest gradient of f over |y| <= travel, |y'| <= rate (1/s or 1/s^2 mixed, as the thesis does), sampled.

        The thesis's tau = 80 covers 22 mm at 8 Hz only (erratum 4.4.2).
        """
        finite_number("travel_m", travel_m, low=0.0)
        finite_number("rate_mps", rate_mps, low=0.0)
        y, v = np.meshgrid(np.linspace(-travel_m, travel_m, samples), np.linspace(-rate_mps, rate_mps, samples))
        (_, k2, k3), (_, c1, c2) = self.stiffness, self.damping
        by_travel = 2.0 * k2 * y + 3.0 * k3 * y**2 + v * (c1 + 2.0 * c2 * y)
        return float(np.hypot(by_travel, c1 * y + c2 * y**2).max())
