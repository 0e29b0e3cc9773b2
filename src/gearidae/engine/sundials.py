"""SUNDIALS as compiled code sees it: the library inside the scikit-sundae wheel, by name.

scikit-sundae bundles SUNDIALS under hashed file names. Loading its extension module's own file into LLVM's process
makes every exported function visible by its plain name, whatever the file is called, so that numba can declare and
call it; no compiler and no second copy of the library are needed.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from functools import cache
from typing import Any

from llvmlite import binding
from numba import types

__all__ = ["replace_steps", "unavailable"]

# load_library_permanently must come before any compiled (or cached) function that calls into the library is loaded.


@cache
def unavailable() -> str:
    """Say why the native driver cannot work here; an empty string if it can.

    Loads the library as a side effect, which the compiled driver needs before it is called.
    """
    try:
        from sksundae import _cy_common, _cy_ida
    except ImportError as error:
        return f"scikit-sundae cannot be imported ({error})"
    config = _cy_common.config
    if config.get("SUNDIALS_FLOAT_TYPE") != "double" or config.get("SUNDIALS_INT_TYPE") != "int":
        return f"SUNDIALS was built with {config.get('SUNDIALS_FLOAT_TYPE')} and {config.get('SUNDIALS_INT_TYPE')}"
    if not str(config.get("SUNDIALS_VERSION", "")).startswith("7."):
        return f"SUNDIALS {config.get('SUNDIALS_VERSION')} is not of the 7 series"
    try:
        binding.load_library_permanently(_cy_ida.__file__)
    except RuntimeError as error:
        return f"the SUNDIALS library cannot be loaded ({error})"
    missing = [name for name in _NAMES if binding.address_of_symbol(name) is None]
    return f"the SUNDIALS library lacks {', '.join(missing)}" if missing else ""


def replace_steps(linear: int, context: int, setup: int, solve: int) -> None:
    """Give a dense linear solver another set-up and solve.

    A linear solver is a record of pointers: content, a table of functions, its context. Where the table and the two
    functions lie in it depends on SUNDIALS' version, so they are looked for by what they hold.

    Parameters
    ----------
    linear, context : int
        Addresses of the solver and of its context.
    setup, solve : int
        Addresses of functions ``int(linear, matrix)`` and ``int(linear, matrix, x, b, tolerance)``.

    Raises
    ------
    RuntimeError
        If the functions are not where they could be.
    """
    fields = [ctypes.c_int64.from_address(linear + 8 * i) for i in range(6)]
    after = next((i for i, field in enumerate(fields) if field.value == context), 0)
    wanted = {
        binding.address_of_symbol("SUNLinSolSetup_Dense"): setup,
        binding.address_of_symbol("SUNLinSolSolve_Dense"): solve,
    }
    table = fields[after - 1].value if after else 0
    functions = [ctypes.c_int64.from_address(table + 8 * i) for i in range(12)] if table else []
    found = [function for function in functions if function.value in wanted]
    if len(found) != len(wanted):
        raise RuntimeError("SUNDIALS lays out its linear solvers in an unknown way")
    for function in found:
        function.value = wanted[function.value]


_PTR = types.intp
_REALS: Any = types.CPointer(types.float64)  # type: ignore[no-untyped-call]
_INT = types.int32
_REAL = types.float64
_NAMES: list[str] = []


def _declare(name: str, result: Any, *arguments: Any) -> Callable[..., Any]:
    _NAMES.append(name)
    declared: Callable[..., Any] = types.ExternalFunction(name, result(*arguments))
    return declared


SUNContext_Create = _declare("SUNContext_Create", _INT, _INT, _PTR)
SUNContext_Free = _declare("SUNContext_Free", _INT, _PTR)
SUNContext_ClearErrHandlers = _declare("SUNContext_ClearErrHandlers", _INT, _PTR)
N_VMake_Serial = _declare("N_VMake_Serial", _PTR, types.int32, _PTR, _PTR)
N_VDestroy = _declare("N_VDestroy", types.void, _PTR)
N_VGetArrayPointer = _declare("N_VGetArrayPointer", _REALS, _PTR)
N_VEnableFusedOps_Serial = _declare("N_VEnableFusedOps_Serial", _INT, _PTR, _INT)
SUNDenseMatrix = _declare("SUNDenseMatrix", _PTR, types.int32, types.int32, _PTR)
SUNDenseMatrix_Data = _declare("SUNDenseMatrix_Data", _REALS, _PTR)
SUNMatDestroy = _declare("SUNMatDestroy", types.void, _PTR)
SUNLinSol_Dense = _declare("SUNLinSol_Dense", _PTR, _PTR, _PTR, _PTR)
SUNLinSolFree = _declare("SUNLinSolFree", _INT, _PTR)
IDACreate = _declare("IDACreate", _PTR, _PTR)
IDAInit = _declare("IDAInit", _INT, _PTR, _PTR, _REAL, _PTR, _PTR)
IDAReInit = _declare("IDAReInit", _INT, _PTR, _REAL, _PTR, _PTR)
IDAFree = _declare("IDAFree", types.void, _PTR)
IDASVtolerances = _declare("IDASVtolerances", _INT, _PTR, _REAL, _PTR)
IDASetUserData = _declare("IDASetUserData", _INT, _PTR, _PTR)
IDASetLinearSolver = _declare("IDASetLinearSolver", _INT, _PTR, _PTR, _PTR)
IDASetJacFn = _declare("IDASetJacFn", _INT, _PTR, _PTR)
IDASetMaxNumSteps = _declare("IDASetMaxNumSteps", _INT, _PTR, types.int64)
IDASetMaxConvFails = _declare("IDASetMaxConvFails", _INT, _PTR, _INT)
IDASetInitStep = _declare("IDASetInitStep", _INT, _PTR, _REAL)
IDASetStopTime = _declare("IDASetStopTime", _INT, _PTR, _REAL)
IDARootInit = _declare("IDARootInit", _INT, _PTR, _INT, _PTR)
IDASetRootDirection = _declare("IDASetRootDirection", _INT, _PTR, _PTR)
IDASetNoInactiveRootWarn = _declare("IDASetNoInactiveRootWarn", _INT, _PTR)
IDASolve = _declare("IDASolve", _INT, _PTR, _REAL, _PTR, _PTR, _PTR, _INT)
IDAGetDky = _declare("IDAGetDky", _INT, _PTR, _REAL, _INT, _PTR)
IDAGetNumSteps = _declare("IDAGetNumSteps", _INT, _PTR, _PTR)
IDAGetNumResEvals = _declare("IDAGetNumResEvals", _INT, _PTR, _PTR)
IDAGetNumJacEvals = _declare("IDAGetNumJacEvals", _INT, _PTR, _PTR)
IDAGetNumErrTestFails = _declare("IDAGetNumErrTestFails", _INT, _PTR, _PTR)
IDAGetNumNonlinSolvConvFails = _declare("IDAGetNumNonlinSolvConvFails", _INT, _PTR, _PTR)
IDAGetNumGEvals = _declare("IDAGetNumGEvals", _INT, _PTR, _PTR)

IDA_ONE_STEP = 2
IDA_TSTOP_RETURN, IDA_ROOT_RETURN = 1, 2
