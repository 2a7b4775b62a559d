"""The two models' equations, written once for every peer: each gets them compiled by its own means.

What the default study leaves alone is a number in the code, so that compilers can fold it; what it varies
is a row of nine: c, eps, C1, C2, C3, K12, K13, K23, T0 with c = (pi/2)(ro^4 - ri^4) sum(1/d) rho f A nu0.
"""
import math

G = 9.80665
IN, FT, LBF = 0.0254, 0.3048, 4.4482216152605
RO, RI, RHO, NU0, A, B = 8.5 * IN, 3 * IN, 970.0, 0.125, 0.003, 1740.0
L, REEL_O, REEL_I, J = 500 * FT, 11 * IN, 5.5 * IN, 30.0
W2, WX = 6000 * LBF, 2000 * LBF
M_TOW, M_ADDED, CDA, RHO_AIR, LIFT = 1000.0, 2000.0, 500.0, 0.30, 0.05

W1 = M_TOW * G
BUOYANCY = (1 + LIFT) * (W1 + W2)
DRAG = 0.5 * RHO_AIR * CDA
V0 = math.sqrt(LIFT * (W1 + W2) / DRAG)
SLOPE = (REEL_O**2 - REEL_I**2) / L
TORQUE = math.pi / 2 * (RO**4 - RI**4) * RHO * A * NU0
MASS = M_TOW + M_ADDED
PARAMETERS = 9
DYNAMIC, QUASI_STEADY = "dynamic", "quasi-steady"
STATES = {DYNAMIC: 6, QUASI_STEADY: 4}
# What a relative tolerance is worth in each state (m, m/s, K): line against its length, speeds against the
# payload's, temperatures against a rise.
SCALES = {DYNAMIC: [100.0, 1.0, 1.0, 100.0, 100.0, 100.0], QUASI_STEADY: [100.0] * 4}


def equations(exp, sqrt, absolute):
    """The right-hand sides as functions of scalars, with the elementary functions of a compiler."""

    def heat(T1, T2, T3, P, p):
        return (
            (p[5] * (T2 - T1) + p[6] * (T3 - T1) + P) / p[2],
            (p[5] * (T1 - T2) + p[7] * (T3 - T2)) / p[3],
            (p[6] * (T1 - T3) + p[7] * (T2 - T3)) / p[4],
        )

    def dynamic(l, V1, V2, T1, T2, T3, p):
        R2 = REEL_O * REEL_O - SLOPE * l
        v = V1 - V2
        w2 = v * v / R2
        viscous = p[0] * exp(B / (T1 + p[1] * (T1 - T2)))
        dW = (WX / L) * l
        m1 = MASS + dW * (1 / G)
        m2 = (W2 - dW) * (1 / G)
        j = J / R2
        q = 0.5 * j * SLOPE * w2 + viscous * v / R2
        a = BUOYANCY - W1 - dW - DRAG * V1 * absolute(V1) - q
        b = q - (W2 - dW)
        inverse = 1.0 / ((m1 + j) * (m2 + j) - j * j)
        H1, H2, H3 = heat(T1, T2, T3, viscous * w2, p)
        return (
            v, ((m2 + j) * a + j * b) * inverse, (j * a + (m1 + j) * b) * inverse, H1, H2, H3,
        )

    def quasi_steady(l, T1, T2, T3, p):
        R2 = REEL_O * REEL_O - SLOPE * l
        tension = W2 - (WX / L) * l
        v = tension * R2 / (p[0] * exp(B / (T1 + p[1] * (T1 - T2))))
        H1, H2, H3 = heat(T1, T2, T3, tension * v, p)
        return v, H1, H2, H3

    return heat, dynamic, quasi_steady


def compiled():
    """Numba's: `rhs(y, p, dy)` for both models."""
    import numba

    jit = numba.njit(fastmath=True, inline="always")
    source = _numba_source()
    dynamic, quasi_steady = jit(source["dynamic"]), jit(source["quasi_steady"])

    @numba.njit(fastmath=True)
    def fill_dynamic(y, p, dy):
        dy[0], dy[1], dy[2], dy[3], dy[4], dy[5] = dynamic(y[0], y[1], y[2], y[3], y[4], y[5], p)

    @numba.njit(fastmath=True)
    def fill_quasi_steady(y, p, dy):
        dy[0], dy[1], dy[2], dy[3] = quasi_steady(y[0], y[1], y[2], y[3], p)

    return {DYNAMIC: fill_dynamic, QUASI_STEADY: fill_quasi_steady}


def _numba_source():
    import numba

    heat, dynamic, quasi_steady = equations(math.exp, math.sqrt, abs)
    # Numba compiles a closure's callees only if they are compiled themselves.
    inner = numba.njit(fastmath=True, inline="always")(heat)
    for function in (dynamic, quasi_steady):
        cells = dict(zip(function.__code__.co_freevars, function.__closure__))
        cells["heat"].cell_contents = inner
    return dict(dynamic=dynamic, quasi_steady=quasi_steady)


def start(model, p):
    """The state at release."""
    warm = [p[8]] * 3
    return [0.0, V0, V0] + warm if model == DYNAMIC else [0.0] + warm
