"""numbalsoda: LSODA in C++, called from a compiled loop over a right-hand side compiled by Numba.

It finds no events. It is told where each descent ends (the reference's reel-down time), integrates to
there and takes one Newton step to the end of the line, so that it pays for no event and no overshoot.
"""
import importlib.metadata
import os

import numba
import numpy as np
from numba import carray, cfunc, njit

import equations as eq
import members

GRID = 33


def driver():
    """numbalsoda's `lsoda`, its callback's signature, its version, and how it was built."""
    library = os.environ.get("PEERS_LSODA_SOURCE")
    if not library:
        import numbalsoda

        return numbalsoda.lsoda, numbalsoda.lsoda_sig, importlib.metadata.version("numbalsoda"), ""
    # The package's own driver file beside a library built from its own C++ sources.
    import importlib.util

    spec = importlib.util.spec_from_file_location("numbalsoda_driver", library + "/driver.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.lsoda, module.lsoda_sig, os.environ["PEERS_LSODA_VERSION"], ", built without its Fortran part"


def solver(model, fill, lsoda, signature):
    n = eq.STATES[model]

    @cfunc(signature)
    def rhs(t, y, dy, p):
        fill(carray(y, (n,)), carray(p, (eq.PARAMETERS,)), carray(dy, (n,)))

    address = rhs.address

    @njit
    def sweep(p, start, end_s, rtol, atol, moments, states, rates):
        for k in range(p.shape[0]):
            y0 = start[k].copy()
            t = moments * end_s[k]
            solution, good = lsoda(address, y0, t, p[k].copy(), rtol, atol, 100000)
            if not good:
                return False
            for i in range(1, t.size):
                states[k, i - 1] = solution[i]
                fill(solution[i], p[k], rates[k, i - 1])
        return True

    # Peaks of the fluid temperature lie in the last part of a descent.
    moments = np.concatenate([[0.0], np.linspace(0.3, 1.0, GRID)])

    def solve(p, end_s, rtol):
        start = np.array([eq.start(model, row) for row in p])
        states, rates = np.empty((len(p), GRID, n)), np.empty((len(p), GRID, n))
        if not sweep(p, start, end_s, rtol, rtol, moments, states, rates):
            raise RuntimeError("LSODA gave up")
        t = np.outer(end_s, moments[1:])
        peak = members.hermite_peak(t, states[..., -3], rates[..., -3])
        slope = (rates[:, -1, 0] - rates[:, -2, 0]) / (t[:, -1] - t[:, -2])
        return members.finish(model, end_s, states[:, -1], rates[:, -1], peak, slope)

    return solve


def peers():
    lsoda, signature, version, how = driver()
    fill = eq.compiled()
    for model, targets in [(eq.DYNAMIC, [1e-5, 1e-6]), (eq.QUASI_STEADY, [1e-6])]:
        yield dict(name="numbalsoda LSODA", version=version, model=model, targets=targets,
                   note=f"C++, right-hand side in Numba, told the end{how}",
                   solve=solver(model, fill[model], lsoda, signature))
