"""Settings of the LMI solver."""

from dataclasses import dataclass

from robust_core.checks import finite_number


@dataclass(frozen=True, slots=True, kw_only=True)
class SolverSettings:
    """Accuracy and limits of one solve; a limit that is hit raises SolverLimitError."""

    tolerance: float = 1e-8
    time_limit_s: float = 60.0
    iterations: int = 200

    def __post_init__(self) -> None:
        finite_number("tolerance", self.tolerance, low=1e-14, high=1e-3)
        finite_number("time_limit_s", self.time_limit_s, low=0.0, open_low=True)
        finite_number("iterations", self.iterations, low=1)
