"""SciPy's solve_ivp with its own event finding; the right-hand side in Python, or compiled by Numba."""
import math

import numpy as np
import scipy
from scipy.integrate import solve_ivp

import equations as eq
import members


def _function(model, fill):
    def rhs(t, y, p):
        dy = np.empty(y.size)
        fill(y, p, dy)
        return dy

    return rhs


def _end(t, y, p):
    return y[0] - eq.L


_end.terminal = True
_end.direction = 1


def descend(rhs, model, method, p, rtol, atol_factor=1.0):
    s = solve_ivp(rhs, (0, 1800.0), eq.start(model, p), method=method, args=(p,), rtol=rtol, events=_end,
                  atol=rtol * atol_factor * np.array(eq.SCALES[model]), first_step=1e-4)
    if s.status != 1:
        raise RuntimeError(s.message)
    rates = np.column_stack([rhs(0.0, y, p) for y in s.y.T])
    row = -3
    peak = members.hermite_peak(s.t, s.y[row], rates[row])
    return [s.t[-1], rates[0, -1], peak]


def interpreted(model):
    """The right-hand side as a user of SciPy writes it first: Python's own arithmetic."""
    _, dynamic, quasi_steady = eq.equations(math.exp, math.sqrt, abs)
    function = dynamic if model == eq.DYNAMIC else quasi_steady

    def rhs(t, y, p):
        return np.array(function(*y.tolist(), p))

    return rhs


def solver(model, method, fill):
    rhs = _function(model, fill) if fill else interpreted(model)

    def solve(p, end_s, rtol):
        return np.array([descend(rhs, model, method, row, rtol) for row in p])

    return solve


def confirm(p, model, count):
    """Outcomes of a few members by Radau at rtol 1e-11: what the reference must agree with."""
    rhs = _function(model, eq.compiled()[model])
    return np.array([descend(rhs, model, "Radau", row, 1e-11, 0.1) for row in p[:count]])


def peers():
    fill = eq.compiled()
    for method, model, targets, in_numba in [
        ("LSODA", eq.DYNAMIC, [1e-5], False), ("LSODA", eq.DYNAMIC, [1e-5, 1e-6], True),
        ("Radau", eq.DYNAMIC, [1e-5], True), ("BDF", eq.DYNAMIC, [1e-5], True),
        ("LSODA", eq.QUASI_STEADY, [1e-6], True),
    ]:
        yield dict(name=f"SciPy {method}", version=scipy.__version__, model=model, targets=targets,
                   note=f"solve_ivp, right-hand side in {'Numba' if in_numba else 'Python'}",
                   solve=solver(model, method, fill[model] if in_numba else None))
