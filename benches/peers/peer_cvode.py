"""SUNDIALS CVODE with its own root finding; right-hand side and the loop over steps compiled by Numba.

The libraries are those in scikit-sundae's wheel, called directly: through its Python callbacks
(also measured, as `scikit-sundae`) nearly all the time would go to Python.
"""
import ctypes as ct
import importlib.metadata
import pathlib

import numba
import numba.extending
import numpy as np
from numba import carray, cfunc, njit, types

import equations as eq
import members

ADAMS, BDF = 1, 2
ONE_STEP, ROOT_RETURN = 2, 2
# Pointers cross as integers of their width: compiled code then needs no casts.
POINTER, INT, REAL, LONG = ct.c_size_t, ct.c_int, ct.c_double, ct.c_long
FUNCTIONS = {
    "SUNContext_Create": (INT, [INT, POINTER]),
    "N_VNew_Serial": (POINTER, [INT, POINTER]),
    "N_VGetArrayPointer": (POINTER, [POINTER]),
    "SUNDenseMatrix": (POINTER, [INT, INT, POINTER]),
    "SUNLinSol_Dense": (POINTER, [POINTER, POINTER, POINTER]),
    "CVodeCreate": (POINTER, [INT, POINTER]),
    "CVodeInit": (INT, [POINTER, POINTER, REAL, POINTER]),
    "CVodeReInit": (INT, [POINTER, REAL, POINTER]),
    "CVodeSVtolerances": (INT, [POINTER, REAL, POINTER]),
    "CVodeSetLinearSolver": (INT, [POINTER, POINTER, POINTER]),
    "CVodeRootInit": (INT, [POINTER, INT, POINTER]),
    "CVodeSetUserData": (INT, [POINTER, POINTER]),
    "CVodeSetMaxNumSteps": (INT, [POINTER, LONG]),
    "CVode": (INT, [POINTER, REAL, POINTER, POINTER, INT]),
}


def load():
    """The functions of the wheel's libraries, and SUNDIALS' version."""
    import sksundae  # loads the libraries that these depend on

    folder = pathlib.Path(sksundae.__file__).parents[1] / "scikit_sundae.libs"
    names = ["core", "nvecserial", "sunmatrixdense", "sunlinsoldense", "cvode"]
    found = [next(folder.glob(f"libsundials_{name}-*.so*")) for name in names]
    version = found[-1].name.split(".so.")[-1]
    libraries = [ct.CDLL(str(path), mode=ct.RTLD_GLOBAL) for path in found]
    functions = {}
    for name, (result, arguments) in FUNCTIONS.items():
        function = next(getattr(lib, name) for lib in libraries if hasattr(lib, name))
        function.restype, function.argtypes = result, arguments
        functions[name] = function
    return functions, version


@numba.extending.intrinsic
def as_pointer(typing, address):
    """An address as what `carray` takes."""
    def code(context, builder, signature, arguments):
        return builder.inttoptr(arguments[0], numba.core.cgutils.voidptr_t)

    return types.voidptr(address), code


def check(code, what):
    if code < 0:
        raise RuntimeError(f"{what} returned {code}")


def solver(model, method, fill, functions):
    n = eq.STATES[model]
    entries = functions["N_VGetArrayPointer"]
    parameter_count = eq.PARAMETERS

    @cfunc(types.int32(types.double, types.uintp, types.uintp, types.uintp))
    def rhs(t, y, dy, p):
        fill(
            carray(as_pointer(entries(y)), (n,), np.float64),
            carray(as_pointer(p), (parameter_count,), np.float64),
            carray(as_pointer(entries(dy)), (n,), np.float64),
        )
        return 0

    length = eq.L

    @cfunc(types.int32(types.double, types.uintp, types.CPointer(types.double), types.uintp))
    def end(t, y, g, p):
        g[0] = carray(as_pointer(entries(y)), (n,), np.float64)[0] - length
        return 0

    handle = ct.c_size_t()
    check(functions["SUNContext_Create"](0, ct.addressof(handle)), "SUNContext_Create")
    context = handle.value
    vector = functions["N_VNew_Serial"](n, context)
    weights = functions["N_VNew_Serial"](n, context)
    def view(v):
        address = functions["N_VGetArrayPointer"](v)
        return np.ctypeslib.as_array(ct.cast(address, ct.POINTER(ct.c_double)), (n,))
    y, atol = view(vector), view(weights)
    parameters = np.zeros(eq.PARAMETERS)
    y[:] = eq.start(model, np.full(eq.PARAMETERS, 290.0))
    memory = functions["CVodeCreate"](method, context)
    check(functions["CVodeInit"](memory, rhs.address, 0.0, vector), "CVodeInit")
    check(functions["CVodeSetUserData"](memory, parameters.ctypes.data), "CVodeSetUserData")
    check(functions["CVodeSVtolerances"](memory, 1e-6, weights), "CVodeSVtolerances")
    matrix = functions["SUNDenseMatrix"](n, n, context)
    linear = functions["SUNLinSol_Dense"](vector, matrix, context)
    check(functions["CVodeSetLinearSolver"](memory, linear, matrix), "CVodeSetLinearSolver")
    check(functions["CVodeRootInit"](memory, 1, end.address), "CVodeRootInit")
    check(functions["CVodeSetMaxNumSteps"](memory, 100000), "CVodeSetMaxNumSteps")
    step, again = functions["CVode"], functions["CVodeReInit"]
    fluid = n - 3

    @njit
    def sweep(p, start, y, parameters, out):
        t = np.zeros(1)
        dy = np.empty(n)
        for k in range(p.shape[0]):
            parameters[:] = p[k]
            y[:] = start[k]
            if again(memory, 0.0, vector) < 0:
                return False
            fill(y, parameters, dy)
            t0, T0, dT0, peak = 0.0, y[fluid], dy[fluid], y[fluid]
            while True:
                code = step(memory, 1800.0, vector, t.ctypes.data, ONE_STEP)
                if code < 0 or t[0] >= 1800.0:
                    return False
                fill(y, parameters, dy)
                T1, dT1 = y[fluid], dy[fluid]
                peak = max(peak, T1)
                if dT0 > 0 and dT1 < 0:
                    h = t[0] - t0
                    a, b, rise = dT0 * h, dT1 * h, T1 - T0
                    c2, c3 = 3 * rise - 2 * a - b, a + b - 2 * rise
                    s = a / (np.sqrt(c2 * c2 - 3 * a * c3) - c2)
                    peak = max(peak, T0 + s * (a + s * (c2 + s * c3)))
                t0, T0, dT0 = t[0], T1, dT1
                if code == ROOT_RETURN:
                    break
            out[k, 0], out[k, 1], out[k, 2] = t[0], dy[0], peak
        return True

    scales = np.array(eq.SCALES[model])

    def solve(p, end_s, rtol):
        atol[:] = rtol * scales
        check(functions["CVodeSVtolerances"](memory, rtol, weights), "CVodeSVtolerances")
        start = np.array([eq.start(model, row) for row in p])
        out = np.empty((len(p), 3))
        if not sweep(p, start, y, parameters, out):
            raise RuntimeError("CVODE gave up")
        return out

    solve.keep = (rhs, end, context, parameters)  # C holds their addresses
    return solve


def through_python(model, fill):
    """scikit-sundae's own interface, with a Python callback into the compiled right-hand side."""
    from sksundae.cvode import CVODE

    def rhs(t, y, dy, data):
        fill(y, data["p"], dy)

    def end(t, y, events, data):
        events[0] = y[0] - eq.L

    end.terminal, end.direction = [True], [1]
    scales = np.array(eq.SCALES[model])

    def solve(p, end_s, rtol):
        out = []
        for row in p:
            cvode = CVODE(rhs, userdata={"p": row}, rtol=rtol, atol=list(rtol * scales), eventsfn=end, num_events=1,
                          method="BDF", max_num_steps=100000)
            s = cvode.solve([0.0, 1800.0], np.array(eq.start(model, row)))
            rates = np.empty_like(s.y)
            for y, dy in zip(s.y, rates):
                fill(y, row, dy)
            peak = members.hermite_peak(s.t, s.y[:, -3], rates[:, -3])
            out.append([s.t[-1], rates[-1, 0], peak])
        return np.array(out)

    return solve


def peers():
    fill = eq.compiled()
    functions, version = load()
    for model, method, label, targets in [
        (eq.DYNAMIC, BDF, "BDF", [1e-5, 1e-6]), (eq.QUASI_STEADY, ADAMS, "Adams", [1e-6]),
    ]:
        yield dict(name=f"CVODE {label}", version=version, model=model, targets=targets,
                   note="C, right-hand side and loop over steps in Numba",
                   solve=solver(model, method, fill[model], functions))
    yield dict(name="CVODE BDF", version="scikit-sundae " + importlib.metadata.version("scikit-sundae"),
               model=eq.DYNAMIC, targets=[1e-5], note="Python callbacks, right-hand side in Numba",
               solve=through_python(eq.DYNAMIC, fill[eq.DYNAMIC]))
