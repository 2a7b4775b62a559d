"""Reference descents by SciPy's Radau at rtol 1e-11: an implementation of the model of its own.

Writes descents.json beside this file. Run:  python3 descents.py   (needs numpy and scipy).
Every case lists its overrides of the baseline in SI, its model, and the outcomes in SI.
Peaks are located on the solver's dense output, refined by bounded minimisation inside the step.
"""
import json
import math
import pathlib
import sys

import numpy as np
import scipy
from scipy.integrate import solve_ivp
from scipy.optimize import brentq, minimize_scalar

G = 9.80665
IN, FT, LBF, CST = 0.0254, 0.3048, 4.4482216152605, 1e-6


def fahrenheit(t):
    return (t + 459.67) / 1.8


BASE = dict(
    gaps=[0.062 * IN] * 14, ro=8.5 * IN, ri=3 * IN, rho=970.0, nu0=125000 * CST, A=0.003, B=1740.0,
    f=1.0, eps=0.0, lam=0.0, m=0.8, L=500 * FT, Ro=11 * IN, Ri=5.5 * IN, J=30.0, W2=6000 * LBF,
    Wx=2000 * LBF, m_tow=1000.0, m_added=2000.0, CdA=500.0, rho_air=0.30, lift=0.05, C1=3990.0,
    C2=21100.0, C3=14600.0, K12=680.0, K13=47.5, K23=9.5, Ka=0.0, Ta=fahrenheit(60.0),
    T0=fahrenheit(60.0),
)
LIMIT = 1800.0


class Rig:
    def __init__(self, **changes):
        self.__dict__.update(BASE)
        self.__dict__.update(changes)
        S = sum(1.0 / d for d in self.gaps)
        self.geometry = math.pi / 2 * (self.ro**4 - self.ri**4) * S
        self.gap = len(self.gaps) / S
        self.rt = 0.8 * (self.ro**5 - self.ri**5) / (self.ro**4 - self.ri**4)

    def radius(self, l):
        return math.sqrt(self.Ro**2 - (self.Ro**2 - self.Ri**2) * l / self.L)

    def torque(self, w, T1, T2):
        Tv = T1 + self.eps * (T1 - T2)
        nu = self.f * self.A * self.nu0 * math.exp(self.B / Tv)
        mu = self.rho * nu
        if self.lam > 0:
            mu /= 1 + (self.lam * nu / self.nu0 * abs(w) * self.rt / self.gap) ** self.m
        return self.geometry * mu * w

    def heat(self, T1, T2, T3, P):
        return [
            (self.K12 * (T2 - T1) + self.K13 * (T3 - T1) + P) / self.C1,
            (self.K12 * (T1 - T2) + self.K23 * (T3 - T2)) / self.C2,
            (self.K13 * (T1 - T3) + self.K23 * (T2 - T3) + self.Ka * (self.Ta - T3)) / self.C3,
        ]

    def dynamic(self, t, y):
        return self.dynamic_full(y)[0]

    def dynamic_full(self, y):
        l, V1, V2, T1, T2, T3 = y
        R = self.radius(l)
        w = (V1 - V2) / R
        M = self.torque(w, T1, T2)
        dW = self.Wx * l / self.L
        m1 = self.m_tow + self.m_added + dW / G
        m2 = (self.W2 - dW) / G
        W1 = self.m_tow * G
        buoyancy = (1 + self.lift) * (W1 + self.W2)
        D = 0.5 * self.rho_air * self.CdA * V1 * abs(V1)
        j = self.J / R**2
        q = self.J * (self.Ro**2 - self.Ri**2) * w**2 / (2 * self.L * R**2) + M / R
        a = buoyancy - W1 - dW - D - q
        b = q - (self.W2 - dW)
        det = (m1 + j) * (m2 + j) - j * j
        A1 = ((m2 + j) * a + j * b) / det
        A2 = (j * a + (m1 + j) * b) / det
        T = j * (A1 - A2) + q
        rates = [V1 - V2, A1, A2] + self.heat(T1, T2, T3, M * w)
        return rates, [T1, T, w, M * w, V1 - V2]

    def steady(self, t, y):
        return self.steady_full(y)[0]

    def steady_full(self, y):
        l, T1, T2, T3 = y
        R = self.radius(l)
        tension = self.W2 - self.Wx * l / self.L
        wanted = tension * R
        w0 = wanted / self.torque(1.0, T1, T2) if self.lam == 0 else None
        if w0 is None:
            lo, hi = 1e-9, 1.0
            while self.torque(hi, T1, T2) < wanted:
                hi *= 2
            w0 = brentq(lambda w: self.torque(w, T1, T2) - wanted, lo, hi, xtol=1e-15, rtol=1e-15)
        P = wanted * w0
        return [w0 * R] + self.heat(T1, T2, T3, P), [T1, tension, w0, P, w0 * R]

    def run(self, model):
        dynamic = model == "dynamic"
        rhs, full = (self.dynamic, self.dynamic_full) if dynamic else (self.steady, self.steady_full)
        if dynamic:
            W1 = self.m_tow * G
            v0 = math.sqrt(self.lift * (W1 + self.W2) / (0.5 * self.rho_air * self.CdA))
            y0 = [0.0, v0, v0, self.T0, self.T0, self.T0]
            atol = [1e-11, 1e-12, 1e-12] + [1e-9] * 3
        else:
            y0 = [0.0, self.T0, self.T0, self.T0]
            atol = [1e-11] + [1e-9] * 3

        def end(t, y):
            return y[0] - self.L

        end.terminal = True
        end.direction = 1
        s = solve_ivp(rhs, (0, LIMIT), y0, method="Radau", rtol=1e-11, atol=atol, events=end,
                      dense_output=True, first_step=1e-5)
        assert s.success, s.message
        values = np.array([full(s.y[:, k])[1] for k in range(s.t.size)])
        peaks = []
        for q in range(5):
            k = int(values[:, q].argmax())
            best = values[k, q]
            lo, hi = s.t[max(k - 1, 0)], s.t[min(k + 1, s.t.size - 1)]
            r = minimize_scalar(lambda t: -full(s.sol(t))[1][q], bounds=(lo, hi), method="bounded",
                                options=dict(xatol=1e-9 * max(hi, 1e-3)))
            peaks.append(max(best, -r.fun))
        T = s.y[-3:, -1]
        return dict(
            deployed=bool(s.status == 1), time_s=s.t[-1], final_velocity_m_per_s=values[-1, 4],
            peak_fluid_temperature_k=peaks[0], peak_tension_n=peaks[1],
            peak_reel_speed_rad_per_s=peaks[2], peak_power_w=peaks[3], peak_velocity_m_per_s=peaks[4],
            final_fluid_temperature_k=T[0], final_rotor_temperature_k=T[1],
            final_housing_temperature_k=T[2],
        )


def uneven(seed):
    rng = np.random.default_rng(seed)
    return [float(g) for g in 0.062 * IN + 0.003 * IN * rng.uniform(-2, 2, 14)]


F = fahrenheit
CASES = [
    dict(),
    dict(T0=F(0.0)), dict(T0=F(40.0)), dict(T0=F(80.0)), dict(T0=F(100.0)),
    dict(nu0=0.03, T0=F(100.0)), dict(nu0=0.03, T0=F(60.0)), dict(nu0=0.05, T0=F(100.0)),
    dict(nu0=0.06, T0=F(80.0)), dict(nu0=0.08, T0=F(100.0)), dict(nu0=0.1, T0=F(20.0)),
    dict(nu0=0.25), dict(nu0=0.6, T0=F(0.0)), dict(nu0=1.0, T0=F(60.0)),
    dict(nu0=2.0, T0=F(0.0)), dict(nu0=2.0, T0=F(100.0)),
    dict(eps=0.3), dict(eps=-0.3, T0=F(90.0)), dict(gaps=uneven(1), f=0.85),
    dict(gaps=uneven(2), f=1.2, eps=0.15, C1=3500.0, K12=500.0),
    dict(Ka=25.0, Ta=F(0.0)), dict(Ka=200.0, Ta=F(-60.0), nu0=1.0),
    dict(lam=0.02, m=0.8), dict(lam=0.1, m=0.6, T0=F(100.0)), dict(lam=0.01, m=0.9, nu0=0.25),
    dict(lam=0.05, m=0.7, nu0=2.0, eps=0.1), dict(lam=0.004, m=0.85, nu0=0.04, T0=F(90.0)),
    dict(lam=0.002, m=0.8), dict(lam=0.004, m=0.75, T0=F(20.0), eps=-0.1),
    dict(J=0.0), dict(J=300.0, m_added=0.0, lift=0.0), dict(W2=9000 * LBF, Wx=0.0, L=300 * FT),
]
NAMES = dict(
    nu0="fluid.nominal_viscosity", T0="initial.temperature", eps="fluid.averaging_offset",
    f="fluid.shear_factor", C1="thermal.fluid_capacity", K12="thermal.fluid_rotor_conductance",
    Ka="thermal.air_conductance", Ta="thermal.air_temperature", lam="fluid.cross_time_constant",
    m="fluid.cross_exponent", J="reel.inertia", m_added="balloon.added_mass",
    lift="balloon.free_lift", W2="payload.weight", Wx="payload.extracted_weight",
    L="reel.line_length",
)


def main():
    out = []
    for case in CASES:
        for model in ("dynamic", "quasi-steady"):
            overrides = {NAMES[k]: v for k, v in case.items() if k != "gaps"}
            overrides |= {f"brake.gap[{k + 1}]": g for k, g in enumerate(case.get("gaps", []))}
            result = Rig(**case).run(model)
            out.append(dict(model=model, overrides=overrides, outcome=result))
            print(model, case, result["time_s"], file=sys.stderr, flush=True)
    about = f"SciPy {scipy.__version__} solve_ivp Radau, rtol 1e-11; made by descents.py"
    path = pathlib.Path(__file__).with_name("descents.json")
    path.write_text(json.dumps(dict(about=about, cases=out), indent=1) + "\n")


main()
