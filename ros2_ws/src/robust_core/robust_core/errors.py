"""The errors of robust_core: what was wrong, what was expected, what to try."""


class RobustCoreError(Exception):
    """Everything that robust_core raises on purpose."""


class ArgumentError(RobustCoreError, ValueError):
    """An argument is not what it must be; the text names it, the expected form and a way out.

    >>> print(ArgumentError("A", "an array (m, n, n)", "shape (2, 3)", "stack one square matrix per vertex"))
    A must be an array (m, n, n), got shape (2, 3): stack one square matrix per vertex
    """

    def __init__(self, argument: str, expected: str, got: str, remedy: str = "") -> None:
        super().__init__(f"{argument} must be {expected}, got {got}" + (f": {remedy}" if remedy else ""))
        self.argument = argument
        self.expected = expected
        self.got = got
        self.remedy = remedy


class MissingDependencyError(RobustCoreError, ImportError):
    """An optional package is needed for what was asked."""


class ModelMismatchError(RobustCoreError):
    """A polytopic model does not reproduce the system it stands for."""


class RateError(RobustCoreError):
    """The rates of the weights cannot be bounded, or a theorem needs bounds that the model does not have."""


class EnclosureError(RobustCoreError):
    """Interval arithmetic could not enclose an expression over the box."""


class SolverError(RobustCoreError):
    """The solver failed; no verdict follows from it."""


class SolverLimitError(SolverError):
    """The solver ran into its time or iteration limit."""


class CertificateError(RobustCoreError):
    """A certificate does not prove what it claims."""


class CertificateDamagedError(CertificateError):
    """A certificate file was changed, cut or is of another format."""


class CertificateMismatchError(CertificateError):
    """A certificate belongs to another model or theorem."""


class ProofFailedError(CertificateError):
    """An inequality that the certificate claims does not hold; the text names it."""


class NotProvenError(RobustCoreError):
    """A proof was required and there is none; the text carries the verdict and its reason."""
