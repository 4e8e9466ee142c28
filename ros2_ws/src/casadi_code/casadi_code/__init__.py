"""CasADi functions as machine code, called without copies: what every solver of the stack stands on."""

from casadi_code.code_cache import CompileError, SolverCodeWarning, cache_directory, compiled
from casadi_code.function_buffer import FunctionBuffer

__all__ = ["CompileError", "FunctionBuffer", "SolverCodeWarning", "cache_directory", "compiled"]
