"""Breach probabilities of the quasi-steady model by numpy: another sampler, another integrator.

Plain Monte Carlo with numpy's own generator over the laws of two cards, written out here once more: that of
tests/fixtures/habe, and the default one (distributions/habe.toml). Each descent by the classical Runge-Kutta
method with line length as the variable, 400 steps, all samples at once. Writes breach_probability.json and
breach_probability_default.json beside this file.
Run:  python3 breach_probability.py   (needs numpy and scipy; some minutes).
"""
import json
import pathlib

import numpy as np
import scipy
from scipy.stats import truncnorm

N, STEPS, SEED = 1_000_000, 400, 20261122
IN, FT, LBF = 0.0254, 0.3048, 4.4482216152605


def f2k(t):
    return (t + 459.67) / 1.8


def run(default, seed, name):
    """The counts of one card: of the default one, with the laws that it alone has."""
    rng = np.random.default_rng(seed)

    def lognormal(median, cv):
        return median * np.exp(np.sqrt(np.log1p(cv**2)) * rng.standard_normal(N))

    def truncated(mean, sd, lower, upper, size):
        law = truncnorm((lower - mean) / sd, (upper - mean) / sd, mean, sd)
        return law.rvs(size=size, random_state=rng)

    def normal(mean, sd):
        return mean + sd * rng.standard_normal(N) if default else mean

    inverse_gaps = np.zeros(N)
    for _ in range(14):
        inverse_gaps += 1 / truncated(0.062 * IN, 0.003 * IN, 0.053 * IN, 0.071 * IN, N)
    f = lognormal(1.0, 0.08)
    eps = 0.1 * rng.standard_normal(N)
    C1, C2, C3 = lognormal(3990, 0.08), lognormal(21100, 0.08), lognormal(14600, 0.08)
    K12, K13, K23 = lognormal(680, 0.15), lognormal(47.5, 0.15), lognormal(9.5, 0.15)
    T0 = truncated(f2k(60), 10 / 1.8, f2k(0), f2k(100), N)
    ro, ri = normal(8.5 * IN, 0.2e-3), 3 * IN
    lot = truncated(1, 0.025, 0.95, 1.05, N) if default else 1.0
    B = normal(1740, 8)
    Ro, Ri, L = normal(11 * IN, 0.04 * IN), 5.5 * IN, 500 * FT
    W2, Wx = normal(6000 * LBF, 30 * LBF), 2000 * LBF
    drag = np.pi / 2 * (ro**4 - ri**4) * inverse_gaps * 970.0 * f * lot * 0.003 * 0.125

    def velocity(l, T1, T2):
        R2 = Ro**2 - (Ro**2 - Ri**2) * l / L
        tension = W2 - Wx * l / L
        return tension * R2 / (drag * np.exp(B / (T1 + eps * (T1 - T2)))), tension

    def per_metre(l, y):
        _, T1, T2, T3 = y
        v, tension = velocity(l, T1, T2)
        P = tension * v
        return np.array([
            np.ones(N),
            (K12 * (T2 - T1) + K13 * (T3 - T1) + P) / C1,
            (K12 * (T1 - T2) + K23 * (T3 - T2)) / C2,
            (K13 * (T1 - T3) + K23 * (T2 - T3)) / C3,
        ]) / v

    y = np.array([np.zeros(N), T0, T0, T0])
    peak = T0.copy()
    h = L / STEPS
    for k in range(STEPS):
        l = k * h
        a = per_metre(l, y)
        b = per_metre(l + h / 2, y + h / 2 * a)
        c = per_metre(l + h / 2, y + h / 2 * b)
        d = per_metre(l + h, y + h * c)
        y = y + h / 6 * (a + 2 * b + 2 * c + d)
        peak = np.maximum(peak, y[1])
    time, final = y[0], velocity(L, y[1], y[2])[0]
    late, fast, hot = time > 210, final > 2.5 * FT, peak > f2k(450)
    result = dict(
        about=f"numpy {np.__version__}, SciPy {scipy.__version__}; made by breach_probability.py",
        samples=N,
        late=int(late.sum()), fast=int(fast.sum()), hot=int(hot.sum()),
        any=int((late | fast | hot).sum()),
        mean_time_s=float(time.mean()), sd_time_s=float(time.std(ddof=1)),
        mean_peak_fluid_temperature_k=float(peak.mean()),
        sd_peak_fluid_temperature_k=float(peak.std(ddof=1)),
    )
    print(result)
    pathlib.Path(__file__).with_name(name).write_text(json.dumps(result, indent=1) + "\n")


run(False, SEED, "breach_probability.json")
run(True, SEED + 1, "breach_probability_default.json")
