"""IDA's memory: a solver of SUNDIALS, opened and closed by compiled code."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from gearidae.arrays import Ints
from gearidae.compiled import compiled
from gearidae.engine.model.addresses import model_at
from gearidae.engine.model.state import Floats, Model
from gearidae.engine.motion.block_jacobian import store_size
from gearidae.engine.sundials import memory
from gearidae.engine.sundials import names as sun

# Handles: addresses of what SUNDIALS has made.
CONTEXT, IDA, Y, YP, DKY, MATRIX, LINEAR, NEWTON, HANDLES = range(9)


class Functions(NamedTuple):
    """Addresses of what SUNDIALS calls, arrays of int64.

    Attributes
    ----------
    model : ndarray, shape (3,)
        Residual, Jacobian (0 if it is not needed), error weights.
    steps : ndarray, shape (2,) or (0,)
        Set-up and solution of a linear solver of ours; none where SUNDIALS has to solve, or nothing is left to.
    newton : ndarray, shape (3,) or (0,)
        Functions of the package's own nonlinear solver, see `gearidae.engine.step.iterate`; none where SUNDIALS
        iterates.
    """

    model: Ints
    steps: Ints
    newton: Ints


class FunctionOffsets(NamedTuple):
    """Where SUNDIALS keeps the functions of linear and nonlinear solvers.

    See `gearidae.engine.sundials.names.places` and `newton_places`.
    """

    linear: Ints
    newton: Ints


@compiled(makes_arrays=True)
def open_solver(
    handles: Ints,
    address: int,
    functions: Functions,
    offsets: FunctionOffsets,
    vectors: tuple[Floats, ...],
    most_failures: int,
) -> int:
    """Create IDA with solvers of our own over the caller's arrays; 0 if all went well.

    Parameters
    ----------
    handles : ndarray of int64, shape (HANDLES,)
        Filled in.
    address : int
        Of the model, from `Addresses`, which must outlive the solver, as the vectors must.
    vectors : tuple of three ndarrays, shape (n,)
        State, rates and work space.
    most_failures : int
        Of Newton's iteration in one step.
    """
    m, (y, yp, dky) = model_at(address), vectors
    m.work.adams.native_newton = 1 if functions.newton.size > 0 else 0
    n = y.size
    if m.work.adams.native_newton != 0:  # nodes are eliminated
        n -= m.scene.nodes * m.scene.histories
    flag = sun.SUNContext_Create(0, handles[CONTEXT:].ctypes.data)
    if flag != 0:
        return flag
    context = handles[CONTEXT]
    sun.SUNContext_ClearErrHandlers(context)
    handles[Y] = sun.N_VMake_Serial(n, y.ctypes.data, context)
    handles[YP] = sun.N_VMake_Serial(n, yp.ctypes.data, context)
    handles[DKY] = sun.N_VMake_Serial(n, dky.ctypes.data, context)
    sun.N_VEnableFusedOps_Serial(handles[Y], 1)  # the clones that IDA makes inherit them
    solver = sun.IDACreate(context)
    handles[IDA] = solver
    flag |= sun.IDAInit(solver, functions.model[0], m.state.time, handles[Y], handles[YP])
    flag |= sun.IDAWFtolerances(solver, functions.model[2])
    flag |= sun.IDASetUserData(solver, address)
    if functions.newton.size > 0:
        handles[NEWTON] = sun.SUNNonlinSolNewEmpty(context)
        memory.replace(handles[NEWTON], offsets.newton, functions.newton)
        flag |= sun.IDASetNonlinearSolver(solver, handles[NEWTON])
    else:
        _make_linear_solver(handles, functions.steps, offsets.linear, m, y)
        flag |= sun.IDASetLinearSolver(solver, handles[LINEAR], handles[MATRIX])
        flag |= sun.IDASetJacFn(solver, functions.model[1])
    flag |= sun.IDASetMaxNumSteps(solver, -1)
    flag |= sun.IDASetMaxConvFails(solver, most_failures)
    return flag


@compiled
def _make_linear_solver(handles: Ints, steps: Ints, where: Ints, m: Model, y: Floats) -> None:
    """Make SUNDIALS' dense solver, or one with set-up and solution of our own."""
    context = handles[CONTEXT]
    if steps.size == 0:
        handles[MATRIX] = sun.SUNDenseMatrix(y.size, y.size, context)
        handles[LINEAR] = sun.SUNLinSol_Dense(handles[Y], handles[MATRIX], context)
        return
    # the matrix is a column to keep numbers in, so the dense solver is made for another and its steps replaced
    single = sun.N_VMake_Serial(1, y.ctypes.data, context)
    other = sun.SUNDenseMatrix(1, 1, context)
    handles[LINEAR] = sun.SUNLinSol_Dense(single, other, context)
    sun.SUNMatDestroy(other)
    sun.N_VDestroy(single)
    handles[MATRIX] = sun.SUNDenseMatrix(store_size(m), 1, context)
    memory.replace(handles[LINEAR], where, steps)


@compiled(makes_arrays=True)
def close_solver(handles: Ints) -> None:
    """Free what `open_solver` has made."""
    cell = np.empty(1, np.int64)
    if handles[IDA] != 0:
        cell[0] = handles[IDA]
        sun.IDAFree(cell.ctypes.data)
    if handles[NEWTON] != 0:
        sun.SUNNonlinSolFreeEmpty(handles[NEWTON])
    if handles[LINEAR] != 0:
        sun.SUNLinSolFree(handles[LINEAR])
    if handles[MATRIX] != 0:
        sun.SUNMatDestroy(handles[MATRIX])
    for k in (Y, YP, DKY):
        if handles[k] != 0:
            sun.N_VDestroy(handles[k])
    if handles[CONTEXT] != 0:
        cell[0] = handles[CONTEXT]
        sun.SUNContext_Free(cell.ctypes.data)
    handles[:] = 0
