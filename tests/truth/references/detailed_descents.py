"""Detailed descents by finite volumes and SciPy's BDF: an implementation of the equations of its own.

Writes detailed_descents.json beside this file. Run:  python3 detailed_descents.py   (needs numpy and scipy; minutes).
The film's half is cut into nz cells at each of nr rings; both are second order, so two grids are extrapolated
(Richardson), and a third says how far that can be trusted. Overrides are in SI; outcomes too.
"""
import json
import math
import pathlib

import numpy as np
import scipy
from scipy.integrate import solve_ivp

G = 9.80665
IN, FT, LBF, CST = 0.0254, 0.3048, 4.4482216152605, 1e-6


def fahrenheit(t):
    return (t + 459.67) / 1.8


BASE = dict(
    gaps=[0.062 * IN] * 14, ro=8.5 * IN, ri=3 * IN, rho=970.0, nu0=125000 * CST, A=0.003, B=1740.0,
    f=1.0, lam=0.0, m=0.8, L=500 * FT, Ro=11 * IN, Ri=5.5 * IN, J=30.0, W2=6000 * LBF, Wx=2000 * LBF,
    m_tow=1000.0, m_added=2000.0, CdA=500.0, rho_air=0.30, lift=0.05, C1=3990.0, C2=21100.0,
    C3=14600.0, K13=47.5, K23=9.5, Ka=0.0, Ta=fahrenheit(60.0), T0=fahrenheit(60.0), kf=0.16,
    km=45.0, cv=3.6e6, alpha=0.0,
)
PATHS = {
    "fluid.nominal_viscosity": "nu0", "initial.temperature": "T0", "metal.conductivity": "km",
    "metal.heat_capacity": "cv", "fluid.cross_time_constant": "lam", "fluid.cross_exponent": "m",
    "fluid.expansion": "alpha", "fluid.conductivity": "kf", "thermal.air_conductance": "Ka",
}
CASES = [
    ("detailed-quasi-steady", {}),
    ("detailed-dynamic", {}),
    ("detailed-quasi-steady", {"metal.conductivity": 16.0, "metal.heat_capacity": 4.0e6}),
    ("detailed-quasi-steady", {"metal.conductivity": 167.0, "metal.heat_capacity": 2.43e6}),
    ("detailed-dynamic", {"initial.temperature": fahrenheit(0.0)}),
    ("detailed-dynamic", {"fluid.nominal_viscosity": 0.06, "initial.temperature": fahrenheit(100.0)}),
    ("detailed-quasi-steady", {"fluid.cross_time_constant": 1e-3}),
    ("detailed-dynamic", {"fluid.cross_time_constant": 3e-3, "fluid.cross_exponent": 0.7}),
    ("detailed-dynamic", {"fluid.expansion": 9.5e-4, "thermal.air_conductance": 30.0}),
]


class Brake:
    def __init__(self, nr, nz, overrides):
        self.__dict__.update(BASE)
        for path, value in overrides.items():
            setattr(self, PATHS[path], value)
        self.nr, self.nz = nr, nz
        n2 = len(self.gaps)
        self.d = n2 / sum(1 / g for g in self.gaps)
        self.area = math.pi * (self.ro**2 - self.ri**2)
        self.n2 = n2
        self.edges = np.linspace(self.ri, self.ro, nr + 1)
        self.r = 0.5 * (self.edges[1:] + self.edges[:-1])
        self.ring = math.pi * (self.edges[1:] ** 2 - self.edges[:-1] ** 2)
        self.share = self.ring / self.area
        # Means over a cell of r² and r^3 against its area, so that torque and heat are exact in a uniform fluid.
        self.r2 = 0.5 * (self.edges[1:] ** 2 + self.edges[:-1] ** 2)
        self.dz = 0.5 * self.d / nz
        self.cf = self.C1 / (n2 * self.area * self.d)
        self.cm = self.C2 / (n2 * self.area)
        self.tm = self.cm / self.cv

    def split(self, y):
        film = y[: self.nr * self.nz].reshape(self.nr, self.nz)
        return film, y[self.nr * self.nz : self.nr * (self.nz + 1)], y[-1]

    def shear(self, film, omega):
        """Stress at each ring over r, and shear rates over the film, at a reel speed."""
        mu0 = self.rho * self.f * self.A * self.nu0 * np.exp(self.B / film - self.alpha * (film - 298.15))
        newton = omega / self.d / np.mean(1 / mu0, axis=1)  # stress over r of the fluid without thinning
        thin = 1.0
        if self.lam > 0:
            group = self.lam / (self.rho * self.nu0) * newton * self.r
            thin = 1 / (1 + group**self.m)
        rates = newton[:, None] / mu0  # shear rate over r
        return newton * thin, rates

    def torque(self, film, omega):
        stress, _ = self.shear(film, omega)
        return self.n2 * np.sum(self.ring * self.r2 * stress)

    def heat(self, film, metal, housing, omega):
        stress, rates = self.shear(film, omega)
        source = (self.r2 * stress)[:, None] * rates
        mean1 = np.sum(self.share * film.mean(axis=1))
        mean2 = np.sum(self.share * metal)
        h13 = self.K13 * (mean1 - housing) / (self.n2 * self.area * self.d)
        h23 = self.K23 * (mean2 - housing) / (self.n2 * self.area)
        flux = np.empty((self.nr, self.nz + 1))  # towards the middle
        flux[:, 0] = self.kf * (metal - film[:, 0]) / (0.5 * self.dz)
        flux[:, 1:-1] = self.kf * (film[:, :-1] - film[:, 1:]) / self.dz
        flux[:, -1] = 0.0
        dfilm = ((flux[:, :-1] - flux[:, 1:]) / self.dz + source - h13) / self.cf
        radial = np.zeros(self.nr + 1)
        step = self.r[1] - self.r[0]
        radial[1:-1] = self.km * self.tm * 2 * math.pi * self.edges[1:-1] * (metal[:-1] - metal[1:]) / step
        dmetal = (-2 * flux[:, 0] + (radial[:-1] - radial[1:]) / self.ring - h23) / self.cm
        dhousing = (self.K13 * (mean1 - housing) + self.K23 * (mean2 - housing)
                    + self.Ka * (self.Ta - housing)) / self.C3
        return dfilm.ravel(), dmetal, dhousing, mean1, mean2

    def hottest(self, film):
        # The middle by symmetry, then the rim from the last rings.
        middle = (9 * film[:, -1] - film[:, -2]) / 8
        return (15 * middle[-1] - 10 * middle[-2] + 3 * middle[-3]) / 8

    def radius(self, l):
        return math.sqrt(self.Ro**2 - (self.Ro**2 - self.Ri**2) * l / self.L)

    def speed(self, film, torque):
        omega = torque / self.torque(film, 1.0) if self.lam == 0 else None
        if omega is not None:
            return omega
        lo, hi = math.log(1e-6), math.log(1e6)
        y = math.log(torque / self.torque(film, 1.0))
        for _ in range(200):
            miss = math.log(self.torque(film, math.exp(y)) / torque)
            slope = (math.log(self.torque(film, math.exp(y + 1e-6)) / torque) - miss) / 1e-6
            step = miss / slope
            y -= step
            if abs(step) < 1e-14:
                break
        return math.exp(min(max(y, lo), hi))

    def quasi_steady(self, t, y):
        film, metal, housing = self.split(y[1:])
        radius = self.radius(y[0])
        omega = self.speed(film, (self.W2 - self.Wx * y[0] / self.L) * radius)
        df, dm, dh, *_ = self.heat(film, metal, housing, omega)
        return np.concatenate(([omega * radius], df, dm, [dh]))

    def dynamic(self, t, y):
        l, v1, v2 = y[:3]
        film, metal, housing = self.split(y[3:])
        radius = self.radius(l)
        omega = (v1 - v2) / radius
        torque = self.torque(film, 1.0) * omega if self.lam == 0 else math.copysign(
            self.torque(film, max(abs(omega), 1e-300)), omega)
        out = self.Wx * l / self.L
        m1 = self.m_tow + self.m_added + out / G
        m2 = (self.W2 - out) / G
        w1 = self.m_tow * G
        buoyancy = (1 + self.lift) * (w1 + self.W2)
        drag = 0.5 * self.rho_air * self.CdA * v1 * abs(v1)
        j = self.J / radius**2
        q = self.J * (self.Ro**2 - self.Ri**2) * omega**2 / (2 * self.L * radius**2) + torque / radius
        a = np.linalg.solve([[m1 + j, -j], [-j, m2 + j]], [buoyancy - w1 - out - drag - q, q - (self.W2 - out)])
        df, dm, dh, *_ = self.heat(film, metal, housing, max(abs(omega), 1e-300))
        return np.concatenate(([v1 - v2, a[0], a[1]], df, dm, [dh]))

    def run(self, model):
        field = np.full(self.nr * (self.nz + 1) + 1, self.T0)
        if model == "detailed-dynamic":
            w1 = self.m_tow * G
            rise = math.sqrt(self.lift * (w1 + self.W2) / (0.5 * self.rho_air * self.CdA))
            y0, rhs, first = np.concatenate(([0.0, rise, rise], field)), self.dynamic, 3
        else:
            y0, rhs, first = np.concatenate(([0.0], field)), self.quasi_steady, 1
        end = lambda t, y: y[0] - self.L
        end.terminal = True
        sol = solve_ivp(rhs, (0, 1800), y0, method="BDF", rtol=1e-8, atol=1e-7, events=end)
        assert sol.status == 1, sol.message
        hottest = max(self.hottest(self.split(y[first:])[0]) for y in sol.y.T)
        y = sol.y_events[0][0]
        film, metal, housing = self.split(y[first:])
        *_, mean1, mean2 = self.heat(film, metal, housing, 1.0)
        velocity = rhs(0, y)[0]
        return np.array([sol.t_events[0][0], velocity, max(hottest, self.hottest(film)), mean1, mean2, housing])


def main():
    names = ["time_s", "final_velocity_m_per_s", "peak_fluid_temperature_k", "final_fluid_temperature_k",
             "final_rotor_temperature_k", "final_housing_temperature_k"]
    cases = []
    for model, overrides in CASES:
        coarse, middle, fine = (Brake(*grid, overrides).run(model) for grid in [(8, 5), (16, 10), (32, 20)])
        before = middle + (middle - coarse) / 3
        best = fine + (fine - middle) / 3
        doubt = np.max(np.abs(best / before - 1))
        print(model, overrides, best, f"{doubt:.1e}", flush=True)
        cases.append(dict(model=model, overrides=overrides, outcome=dict(zip(names, best.tolist())), doubt=doubt))
    about = f"finite volumes, SciPy {scipy.__version__} solve_ivp BDF, rtol 1e-8; made by detailed_descents.py"
    path = pathlib.Path(__file__).with_suffix(".json")
    path.write_text(json.dumps(dict(about=about, cases=cases), indent=1) + "\n")


if __name__ == "__main__":
    main()
