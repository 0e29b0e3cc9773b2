"""A solver of SUNDIALS, opened and closed by compiled code."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearidae.compiled import compiled
from gearidae.engine.elastic.block_jacobian import store_size
from gearidae.engine.integrate import adams
from gearidae.engine.integrate.driver import CONVERGENCE_FAILURES_HIGH
from gearidae.engine.integrate.newton import make_solver
from gearidae.engine.model import layout as at
from gearidae.engine.sundials import memory as ptr
from gearidae.engine.sundials import names as sun

__all__ = ["DKY", "HANDLES", "SOLVER", "YP", "Y", "close", "open_solver"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

# Handles: addresses of what SUNDIALS has made.
CONTEXT, SOLVER, Y, YP, DKY, MATRIX, LINEAR, NEWTON, HANDLES = range(9)


@compiled(makes_arrays=True)
def open_solver(
    handles: Ints,
    model: Ints,
    steps: Ints,
    newton: Ints,
    vectors: Ints,
    where: Ints,
    newton_where: Ints,
    vector_where: Ints,
    desk: Floats,
    d: Floats,
    y: Floats,
    yp: Floats,
    dky: Floats,
) -> int:
    """Create IDA with solvers of our own over the caller's arrays; 0 if all went well.

    Parameters
    ----------
    handles : ndarray of int64, shape (HANDLES,)
        Filled in.
    model, steps, newton, vectors : ndarray of int64
        See `gearidae.engine.sundials.callbacks.Callbacks`.
    where, newton_where, vector_where : ndarray of int64
        From `gearidae.engine.sundials.names.places`, `newton_places` and `vector_places`.
    desk : ndarray, shape (DESK,)
        See `gearidae.engine.integrate.adams`; must outlive the solver.
    d, y, yp, dky : ndarray
        User data, state, rates and work space: must outlive the solver.
    """
    n = y.size
    flag = sun.SUNContext_Create(0, handles[CONTEXT:].ctypes.data)
    if flag != 0:
        return flag
    context = handles[CONTEXT]
    sun.SUNContext_ClearErrHandlers(context)
    handles[Y] = sun.N_VMake_Serial(n, y.ctypes.data, context)
    handles[YP] = sun.N_VMake_Serial(n, yp.ctypes.data, context)
    handles[DKY] = sun.N_VMake_Serial(n, dky.ctypes.data, context)
    sun.N_VEnableFusedOps_Serial(handles[Y], 1)  # the clones that IDA makes inherit them
    if vectors.size > 0:
        for vector in (Y, YP, DKY):
            ptr.replace(handles[vector], vector_where, vectors)
    solver = sun.IDACreate(context)
    handles[SOLVER] = solver
    flag |= sun.IDAInit(solver, model[0], d[at.LAST_TIME], handles[Y], handles[YP])
    flag |= sun.IDAWFtolerances(solver, model[2])
    flag |= sun.IDASetUserData(solver, d.ctypes.data)
    if newton.size > 0:
        desk[adams.OWN] = 1.0
        handles[NEWTON] = make_solver(context, desk, newton_where, newton)
        flag |= sun.IDASetNonlinearSolver(solver, handles[NEWTON])
    else:
        _make_linear_solver(handles, steps, where, d, y)
        flag |= sun.IDASetLinearSolver(solver, handles[LINEAR], handles[MATRIX])
        flag |= sun.IDASetJacFn(solver, model[1])
    flag |= sun.IDASetMaxNumSteps(solver, -1)
    flag |= sun.IDASetMaxConvFails(solver, CONVERGENCE_FAILURES_HIGH)
    return flag


@compiled
def _make_linear_solver(handles: Ints, steps: Ints, where: Ints, d: Floats, y: Floats) -> None:
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
    handles[MATRIX] = sun.SUNDenseMatrix(store_size(d), 1, context)
    ptr.replace(handles[LINEAR], where, steps)


@compiled(makes_arrays=True)
def close(handles: Ints) -> None:
    """Free what `open_solver` has made."""
    cell = np.empty(1, np.int64)
    if handles[SOLVER] != 0:
        cell[0] = handles[SOLVER]
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
