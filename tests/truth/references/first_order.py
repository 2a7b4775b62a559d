"""First- and second-order references of the published reliability problems, limit by limit.

The nearest point of each limit is found by SciPy's SLSQP from many starts (minimise ‖u‖² on g(u) = 0),
the curvatures there by central second differences in mpmath with 40 digits; Breitung's and Hohenbichler
and Rackwitz' formulas are evaluated from them. Writes first_order.json beside this file.

Run: python3 tests/truth/references/first_order.py   (SciPy, NumPy, mpmath)
"""

import json
import pathlib

import mpmath as mp
import numpy as np
import scipy
from scipy.optimize import minimize
from scipy.stats import norm

mp.mp.dps = 40


def functions(m):
    """Elementary functions of a module: NumPy for the search, mpmath for the curvatures."""
    sqrt, exp, log, sin, pi = m.sqrt, m.exp, m.log, m.sin, m.pi
    high = m is mp

    def lognormal(mean, cov, z):
        s2 = log(1 + (mp.mpf(cov) if high else cov) ** 2)
        return mean * exp(sqrt(s2) * z - s2 / 2)

    def uniform(z):
        return 2 * mp.ncdf(z) - 1 if high else 2 * norm.cdf(z) - 1

    def rp38(z):
        mean = [350, 50.8, 3.81, 173, 9.38, 33.1, 0.036]
        x = [a + a / 10 * t for a, t in zip(mean, z)]
        above = x[3] ** 2 - 4 * x[4] * x[5] * x[6] ** 2 + x[3] * (x[5] + 4 * x[4] + 2 * x[5] * x[6])
        below = x[3] * x[4] * (x[3] + x[5] + 2 * x[5] * x[6])
        return 155900 - x[0] * x[1] ** 3 / (2 * x[2] ** 3) * above / below

    def rp8(z):
        laws = [(120, 0.1)] * 4 + [(50, 0.2), (40, 0.2)]
        x = [lognormal(a, c, t) for (a, c), t in zip(laws, z)]
        return x[0] + 2 * x[1] + 2 * x[2] + x[3] - 5 * x[4] - 5 * x[5]

    def damped(strength):
        def g(z):
            laws = [(1.5, 0.1), (0.01, 0.1), (1, 0.2), (0.01, 0.2), (0.05, 0.4), (0.02, 0.5), (100, 0.1), (strength, 0.1)]
            m_p, m_s, kp, ks, zp, zs, s0, fs = (lognormal(a, c, t) for (a, c), t in zip(laws, z))
            wp, ws = sqrt(kp / m_p), sqrt(ks / m_s)
            wa, za, gm = (wp + ws) / 2, (zp + zs) / 2, m_s / m_p
            th = (wp - ws) / wa
            power = pi * s0 / (4 * zs * ws**3) * za * zs / (zp * zs * (4 * za**2 + th**2) + gm * za**2)
            return fs - 3 * ks * sqrt(power * (zp * wp**3 + zs * ws**3) * wp / (4 * za * wa**4))

        return g

    def undamped(mean, sd):
        def g(z):
            mass, c1, c2 = 1 + 0.05 * z[0], 1 + 0.1 * z[1], 0.1 + 0.01 * z[2]
            r, force, t1 = 0.5 + 0.05 * z[3], mean + sd * z[4], 1 + 0.2 * z[5]
            return 3 * r - abs(2 * force / (c1 + c2) * sin(sqrt((c1 + c2) / mass) * t1 / 2))

        return g

    r2 = sqrt(m.mpf(2)) if high else np.sqrt(2)
    d = lambda z: uniform(z[0]) - uniform(z[1])
    bowl = lambda z: 0.2 + 0.6 * d(z) ** 4
    return {
        "RP22": (2, [lambda z: 2.5 - (z[0] + z[1]) / r2 + 0.1 * (z[0] - z[1]) ** 2]),
        "RP53": (2, [lambda z: sin(2.5 * (1.5 + z[0])) + 2 - ((1.5 + z[0]) ** 2 + 4) * (1.5 + z[1]) / 20]),
        "RMINUSS": (2, [lambda z: 2 + z[0] - z[1]]),
        "RSQUAD": (2, [lambda z: 11 + z[0] - (1.5 + 0.5 * z[1]) ** 2]),
        "CANTILEVER2D": (
            2,
            [lambda z: 6000 / (m.mpf(325) if high else 325) - 1.5 * 6000**4 / 2.6e10 * (1000 + 200 * z[0]) / (250 + 37.5 * z[1]) ** 3],
        ),
        "RP38": (7, [rp38]),
        "RP33": (3, [lambda z: 3 * sqrt(m.mpf(3) if high else 3) - z[0] - z[1] - z[2], lambda z: 3 - z[2]]),
        "RP55": (
            2,
            [
                lambda z: bowl(z) - d(z) / r2,
                lambda z: bowl(z) + d(z) / r2,
                lambda z: d(z) + 5 / r2 - 2.2,
                lambda z: -d(z) + 5 / r2 - 2.2,
            ],
        ),
        "FOURBRANCH": (
            2,
            [
                lambda z: 3 + 0.1 * (z[0] - z[1]) ** 2 - (z[0] + z[1]) / r2,
                lambda z: 3 + 0.1 * (z[0] - z[1]) ** 2 + (z[0] + z[1]) / r2,
                lambda z: z[0] - z[1] + 7 / r2,
                lambda z: z[1] - z[0] + 7 / r2,
            ],
        ),
        "RP25": (2, [lambda z: z[0] ** 2 - 8 * z[1] + 16, lambda z: -16 * z[0] + z[1] + 32]),
        "RP8": (6, [rp8]),
        "DAMPED_15_0": (8, [damped(15)]),
        "DAMPED_27_5": (8, [damped(27.5)]),
        "UNDAMPED_1_0": (6, [undamped(1.0, 0.2)]),
        "UNDAMPED_0_45": (6, [undamped(0.45, 0.075)]),
        "RP107": (10, [lambda z: 5 * sqrt(m.mpf(10) if high else 10) - sum(z)]),
        "RP110": (
            2,
            [
                lambda z: 0.85 - 0.1 * z[0] if z[0] <= 3.5 else 4 - z[0],
                lambda z: 2.3 - z[1] if z[1] <= 2 else 0.5 - 0.1 * z[1],
            ],
        ),
    }


def nearest(g, n):
    """The point of g = 0 nearest to the origin, and on which side of it the origin lies."""
    rng = np.random.default_rng(20261122)
    scale = abs(g(np.zeros(n))) or 1.0
    best = None
    for k in range(80):
        start = rng.standard_normal(n) * (0.1 if k == 0 else 2.0)
        found = minimize(
            lambda u: u @ u,
            start,
            jac=lambda u: 2 * u,
            constraints={"type": "eq", "fun": lambda u: g(u) / scale},
            method="SLSQP",
            options={"maxiter": 500, "ftol": 1e-14},
        )
        if found.success and abs(g(found.x)) < 1e-7 * scale and (best is None or found.fun < best.fun - 1e-9):
            best = found
    return best.x, 1.0 if g(np.zeros(n)) > 0 else -1.0


def polished(g, u):
    """Newton's steps on the conditions of the nearest point, in mpmath; its gradient and Hessian."""
    n, h = len(u), mp.mpf(10) ** -10
    u = [mp.mpf(float(x)) for x in u]

    def derivatives(u):
        moved = lambda moves: g([x + sum(h * s for j, s in moves if j == i) for i, x in enumerate(u)])
        centre = moved([])
        grad = mp.matrix([(moved([(i, 1)]) - moved([(i, -1)])) / (2 * h) for i in range(n)])
        hess = mp.matrix(n, n)
        for i in range(n):
            hess[i, i] = (moved([(i, 1)]) - 2 * centre + moved([(i, -1)])) / h**2
            for j in range(i):
                mixed = moved([(i, 1), (j, 1)]) - moved([(i, 1), (j, -1)]) - moved([(i, -1), (j, 1)]) + moved([(i, -1), (j, -1)])
                hess[i, j] = hess[j, i] = mixed / (4 * h**2)
        return centre, grad, hess

    centre, grad, hess = derivatives(u)
    multiplier = -(grad.T * mp.matrix(u))[0] / (grad.T * grad)[0]
    for _ in range(6):
        system = mp.matrix(n + 1, n + 1)
        right = mp.matrix(n + 1, 1)
        for i in range(n):
            for j in range(n):
                system[i, j] = (1 if i == j else 0) + multiplier * hess[i, j]
            system[i, n] = system[n, i] = grad[i]
            right[i] = -(u[i] + multiplier * grad[i])
        right[n] = -centre
        step = mp.lu_solve(system, right)
        u = [x + step[i] for i, x in enumerate(u)]
        multiplier += step[n]
        centre, grad, hess = derivatives(u)
    return u, grad, hess


def reference(low, high, n):
    start, side = nearest(low, n)
    u, grad, hess = polished(high, start)
    slope = mp.norm(grad)
    alpha = np.array([float(-x / slope) for x in grad])
    beta = side * float(mp.norm(mp.matrix(u)))
    # Curvatures: the Hessian over the slope within the plane across alpha.
    basis = np.linalg.svd(alpha.reshape(1, -1))[2][1:]
    inner = np.array([[float(hess[i, j] / slope) for j in range(n)] for i in range(n)])
    curvatures = sorted(np.linalg.eigvalsh(basis @ inner @ basis.T)) if n > 1 else []
    out = {"point": [float(x) for x in u], "reliability_index": beta, "form": norm.sf(beta)}
    if beta > 0:
        psi = norm.pdf(beta) / norm.sf(beta)
        for name, factor in [("breitung", beta), ("hohenbichler_rackwitz", psi)]:
            terms = [1 + factor * k for k in curvatures]
            out[name] = norm.sf(beta) / np.sqrt(np.prod(terms)) if min(terms) > 0 else None
    out["curvatures"] = [float(k) for k in curvatures]
    return out


def main():
    low, high = functions(np), functions(mp)
    problems = {
        name: [reference(a, b, n) for a, b in zip(limits, high[name][1])] for name, (n, limits) in low.items()
    }
    about = f"first_order.py; SciPy {scipy.__version__}, mpmath {mp.__version__}"
    path = pathlib.Path(__file__).with_name("first_order.json")
    path.write_text(json.dumps({"made_by": about, "problems": problems}, indent=1) + "\n")


main()
