"""SUNDIALS as compiled code sees it: the library inside the scikit-sundae wheel, by name.

scikit-sundae bundles SUNDIALS under hashed file names. Loading its extension module's own file into LLVM's process
makes every exported function visible by its plain name, whatever the file is called, so that numba can declare and
call it; no compiler and no second copy of the library are needed.
"""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any, Final

import numpy as np
from llvmlite import binding
from numba import types
from numpy.typing import NDArray

from gearidae.engine.sundials.memory import CURRENT_STEP, SYSTEM

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
        for library in libraries(Path(_cy_ida.__file__)):
            binding.load_library_permanently(str(library))
    except RuntimeError as error:
        return f"the SUNDIALS library cannot be loaded ({error})"
    wanted = (*_NAMES, *OF_SOLVERS, *OF_NEWTON, "SUNNonlinSol_Newton", SYSTEM, CURRENT_STEP)
    if missing := [name for name in wanted if binding.address_of_symbol(name) is None]:
        return f"the SUNDIALS library lacks {', '.join(missing)}"
    try:
        linear_solver_offsets()
        newton_offsets()
    except RuntimeError as error:
        return str(error)
    return ""


def libraries(extension: Path) -> list[Path]:
    """List the files to load so that every function of SUNDIALS is found by its name.

    Linux and macOS look for a name in the extension module and go on in the libraries that it was linked with. Windows
    looks in one file at a time; there the libraries lie in a folder beside the package, where its wheel has put them.

    Parameters
    ----------
    extension : Path
        scikit-sundae's extension module for IDA.
    """
    if sys.platform != "win32":
        return [extension]
    return [extension, *sorted((extension.parents[1] / "scikit_sundae.libs").glob("sundials_*.dll"))]


def exports(name: str) -> bool:
    """Whether the library, loaded, has a function of this name."""
    return not unavailable() and binding.address_of_symbol(name) is not None


OF_SOLVERS: Final = ("SUNLinSolSetup_Dense", "SUNLinSolSolve_Dense")
"""Operations of the dense linear solver, which the driver replaces."""

OF_NEWTON: Final = (
    "SUNNonlinSolGetType_Newton",
    "SUNNonlinSolSolve_Newton",
    "SUNNonlinSolSetSysFn_Newton",
)
"""Operations of the Newton iteration, in whose place the driver puts its own."""


@cache
def linear_solver_offsets() -> NDArray[np.int64]:
    """Where SUNDIALS keeps a linear solver's functions, found by what lies there.

    A linear solver is a record of pointers: its content, a table of functions, its context. Where the table lies in
    it, and a function in the table, depends on SUNDIALS' version. That a vector's numbers lie where `numbers` looks
    for them is checked on the way.

    Returns
    -------
    ndarray of int64, shape (3,)
        Index of the table in a linear solver's record, those of `OF_SOLVERS` in the table.

    Raises
    ------
    RuntimeError
        If anything is not where it could be.
    """
    with _bench() as (context, vector, numbers):
        matrix = _call("SUNDenseMatrix", ctypes.c_int32(1), ctypes.c_int32(1), context)
        linear = _call("SUNLinSol_Dense", vector, _address(matrix), context)
        table = _table_offset(linear, context)
        functions = _operations(linear, table, 12, OF_SOLVERS, "linear solvers")
        if _words(_words(vector.value, 1)[0], 2)[1] != numbers.ctypes.data:
            raise RuntimeError("SUNDIALS lays out its vectors in an unknown way")
        _call("SUNLinSolFree", _address(linear))
        _call("SUNMatDestroy", _address(matrix))
    return np.array([table, *functions], dtype=np.int64)


@cache
def newton_offsets() -> NDArray[np.int64]:
    """Where SUNDIALS keeps a nonlinear solver's functions, found like `linear_solver_offsets`.

    Returns
    -------
    ndarray of int64, shape (4,)
        Index of the table in a nonlinear solver's record, those of `OF_NEWTON` in the table.

    Raises
    ------
    RuntimeError
        If anything is not where it could be.
    """
    with _bench() as (context, vector, _):
        newton = _call("SUNNonlinSol_Newton", vector, context)
        table = _table_offset(newton, context)
        functions = _operations(newton, table, 13, OF_NEWTON, "nonlinear solvers")
        _call("SUNNonlinSolFree_Newton", _address(newton))
    return np.array([table, *functions], dtype=np.int64)


@contextmanager
def _bench() -> Iterator[tuple[ctypes.c_int64, ctypes.c_int64, NDArray[np.float64]]]:
    """Provide a context and a vector over one number, to make solvers with and look at them."""
    numbers, context = np.zeros(1), ctypes.c_int64()
    _call("SUNContext_Create", ctypes.c_int(0), ctypes.byref(context))
    try:
        vector = _address(_call("N_VMake_Serial", ctypes.c_int32(1), _address(numbers.ctypes.data), context))
        yield context, vector, numbers
        _call("N_VDestroy", vector)
    finally:
        _call("SUNContext_Free", ctypes.byref(context))


def _table_offset(record: int, context: ctypes.c_int64) -> int:
    """Index of the table of functions in a record: just before the context; 0 if that is not there."""
    fields = _words(record, 4)
    return fields.index(context.value) - 1 if context.value in fields[1:] else 0


def _operations(record: int, table: int, size: int, names: tuple[str, ...], kind: str) -> list[int]:
    """Indices of these functions in the table of so many that a record has."""
    functions = _words(_words(record, table + 1)[table], size) if table else []
    wanted = [binding.address_of_symbol(name) for name in names]
    if any(function not in functions for function in wanted):
        raise RuntimeError(f"SUNDIALS lays out its {kind} in an unknown way")
    return [functions.index(function) for function in wanted]


_address = ctypes.c_int64


def _call(name: str, *arguments: Any) -> int:
    """Call a function of SUNDIALS from Python."""
    kinds = [type(a) if isinstance(a, (ctypes.c_int, ctypes.c_int64)) else ctypes.c_void_p for a in arguments]
    function = ctypes.CFUNCTYPE(ctypes.c_int64, *kinds)(binding.address_of_symbol(name))
    return int(function(*arguments))


def _words(address: int, count: int) -> list[int]:
    return list((ctypes.c_int64 * count).from_address(address))


_PTR = types.intp
_REALS: Any = types.CPointer(types.float64)  # type: ignore[no-untyped-call]
_INT = types.int32
_REAL = types.float64
_NAMES: list[str] = []


def _declare(name: str, result: Any, *arguments: Any) -> Callable[..., Any]:
    _NAMES.append(name)
    return _declare_optional(name, result, *arguments)


def _declare_optional(name: str, result: Any, *arguments: Any) -> Callable[..., Any]:
    """Declare a function that is done without where the library does not export it."""
    declared: Callable[..., Any] = types.ExternalFunction(name, result(*arguments))
    return declared


SUNContext_Create = _declare("SUNContext_Create", _INT, _INT, _PTR)
SUNContext_Free = _declare("SUNContext_Free", _INT, _PTR)
SUNContext_ClearErrHandlers = _declare("SUNContext_ClearErrHandlers", _INT, _PTR)
N_VMake_Serial = _declare("N_VMake_Serial", _PTR, types.int32, _PTR, _PTR)
N_VDestroy = _declare("N_VDestroy", types.void, _PTR)
N_VEnableFusedOps_Serial = _declare("N_VEnableFusedOps_Serial", _INT, _PTR, _INT)
SUNDenseMatrix = _declare("SUNDenseMatrix", _PTR, types.int32, types.int32, _PTR)
SUNDenseMatrix_Data = _declare("SUNDenseMatrix_Data", _REALS, _PTR)
SUNDenseMatrix_Rows = _declare("SUNDenseMatrix_Rows", types.int32, _PTR)
SUNMatDestroy = _declare("SUNMatDestroy", types.void, _PTR)
SUNLinSol_Dense = _declare("SUNLinSol_Dense", _PTR, _PTR, _PTR, _PTR)
SUNLinSolFree = _declare("SUNLinSolFree", _INT, _PTR)
IDACreate = _declare("IDACreate", _PTR, _PTR)
IDAInit = _declare("IDAInit", _INT, _PTR, _PTR, _REAL, _PTR, _PTR)
IDAReInit = _declare("IDAReInit", _INT, _PTR, _REAL, _PTR, _PTR)
IDAFree = _declare("IDAFree", types.void, _PTR)
IDAWFtolerances = _declare("IDAWFtolerances", _INT, _PTR, _PTR)
SUNNonlinSolNewEmpty = _declare("SUNNonlinSolNewEmpty", _PTR, _PTR)
SUNNonlinSolFreeEmpty = _declare("SUNNonlinSolFreeEmpty", types.void, _PTR)
IDASetNonlinearSolver = _declare("IDASetNonlinearSolver", _INT, _PTR, _PTR)
IDASetUserData = _declare("IDASetUserData", _INT, _PTR, _PTR)
IDASetLinearSolver = _declare("IDASetLinearSolver", _INT, _PTR, _PTR, _PTR)
IDASetJacFn = _declare("IDASetJacFn", _INT, _PTR, _PTR)
IDASetMaxNumSteps = _declare("IDASetMaxNumSteps", _INT, _PTR, types.int64)
IDASetMaxConvFails = _declare("IDASetMaxConvFails", _INT, _PTR, _INT)
IDASetInitStep = _declare("IDASetInitStep", _INT, _PTR, _REAL)
IDASetStopTime = _declare("IDASetStopTime", _INT, _PTR, _REAL)
IDASetMaxStep = _declare("IDASetMaxStep", _INT, _PTR, _REAL)
IDASolve = _declare("IDASolve", _INT, _PTR, _REAL, _PTR, _PTR, _PTR, _INT)
IDASetEtaFixedStepBounds = _declare("IDASetEtaFixedStepBounds", _INT, _PTR, _REAL, _REAL)
IDASetEtaMax = _declare("IDASetEtaMax", _INT, _PTR, _REAL)
IDASetMaxOrd = _declare("IDASetMaxOrd", _INT, _PTR, _INT)
IDAGetSolution = _declare_optional("IDAGetSolution", _INT, _PTR, _REAL, _PTR, _PTR)
IDAGetCurrentTime = _declare("IDAGetCurrentTime", _INT, _PTR, _PTR)
IDAGetDky = _declare("IDAGetDky", _INT, _PTR, _REAL, _INT, _PTR)
IDAGetNumSteps = _declare("IDAGetNumSteps", _INT, _PTR, _PTR)
IDAGetNumResEvals = _declare("IDAGetNumResEvals", _INT, _PTR, _PTR)
IDAGetNumJacEvals = _declare("IDAGetNumJacEvals", _INT, _PTR, _PTR)
IDAGetNumErrTestFails = _declare("IDAGetNumErrTestFails", _INT, _PTR, _PTR)
IDAGetNumNonlinSolvConvFails = _declare("IDAGetNumNonlinSolvConvFails", _INT, _PTR, _PTR)

IDA_ONE_STEP = 2
IDA_TSTOP_RETURN, IDA_ROOT_RETURN = 1, 2
