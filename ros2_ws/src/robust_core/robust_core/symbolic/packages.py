"""The optional packages of this part, or an error that says which one is missing."""

from types import ModuleType

from robust_core.errors import MissingDependencyError


def casadi_module() -> ModuleType:
    """CasADi."""
    try:
        import casadi
    except ImportError as error:
        raise MissingDependencyError("models are derived from formulas with casadi, which is not installed") from error
    return casadi


def flint_module() -> ModuleType:
    """python-flint."""
    try:
        import flint
    except ImportError as error:
        raise MissingDependencyError(
            "enclosures are computed with python-flint, which is not installed; sampled bounds need none"
        ) from error
    return flint
