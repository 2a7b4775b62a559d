"""Driven rig runs by SciPy, on an implementation of the model of its own.

Writes driven_runs.json: for each case a record (times, values; linear between them), the design's overrides,
and line, force, speed and temperatures at each time. DOP853 at rtol 1e-12, restarted at every kink.

Usage: python driven_runs.py > driven_runs.json
"""

import json
import math

import numpy as np
import scipy
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

IN, FT, LBF = 0.0254, 0.3048, 4.4482216152605
BASE = dict(
    n=7, ro=8.5 * IN, ri=3 * IN, d=0.062 * IN, rho=970.0, nu0=0.125, A=0.003, B=1740.0, f=1.0, eps=0.0, lam=0.0, m=0.8,
    L=500 * FT, Ro=11 * IN, Ri=5.5 * IN, C1=3990.0, C2=21100.0, C3=14600.0, K12=680.0, K13=47.5, K23=9.5,
    Ka=0.0, Ta=(60 + 459.67) / 1.8, T0=(60 + 459.67) / 1.8,
)
PATHS = {
    "fluid.shear_factor": "f", "fluid.averaging_offset": "eps", "fluid.cross_time_constant": "lam",
    "fluid.cross_exponent": "m", "initial.temperature": "T0", "thermal.fluid_rotor_conductance": "K12",
    "thermal.air_conductance": "Ka", "fluid.nominal_viscosity": "nu0",
}


def torque(p, omega, t1, t2):
    tv = t1 + p["eps"] * (t1 - t2)
    nu = p["f"] * p["A"] * p["nu0"] * math.exp(p["B"] / tv)
    inverse = 2 * p["n"] / p["d"]
    mu = p["rho"] * nu
    if p["lam"] > 0:
        rt = 0.8 * (p["ro"] ** 5 - p["ri"] ** 5) / (p["ro"] ** 4 - p["ri"] ** 4)
        dh = 2 * p["n"] / inverse
        mu /= 1 + (p["lam"] * nu / p["nu0"] * abs(omega) * rt / dh) ** p["m"]
    return math.pi / 2 * (p["ro"] ** 4 - p["ri"] ** 4) * inverse * mu * omega


def speed_of_torque(p, wanted, t1, t2):
    if p["lam"] == 0:
        return wanted / torque(p, 1.0, t1, t2)
    high = 1.0
    while torque(p, high, t1, t2) < wanted:
        high *= 2
    return brentq(lambda w: torque(p, w, t1, t2) - wanted, 0, high, xtol=1e-15, rtol=1e-14)


def reading(p, drive, value, y):
    line, t1, t2, _ = y
    radius = math.sqrt(p["Ro"] ** 2 - (p["Ro"] ** 2 - p["Ri"] ** 2) * line / p["L"])
    if drive == "force":
        omega = speed_of_torque(p, value * radius, t1, t2)
        return omega, value, omega * radius
    omega = value / radius
    return omega, torque(p, omega, t1, t2) / radius, value


def rates(p, drive, value, y):
    omega, force, speed = reading(p, drive, value, y)
    power = force * speed
    _, t1, t2, t3 = y
    return [
        speed,
        (p["K12"] * (t2 - t1) + p["K13"] * (t3 - t1) + power) / p["C1"],
        (p["K12"] * (t1 - t2) + p["K23"] * (t3 - t2)) / p["C2"],
        (p["K13"] * (t1 - t3) + p["K23"] * (t2 - t3) + p["Ka"] * (p["Ta"] - t3)) / p["C3"],
    ]


def follow(p, drive, times, values, offsets):
    y = [0.0, *(p["T0"] + o for o in offsets)]
    rows = []
    for k, (t, v) in enumerate(zip(times, values)):
        _, force, speed = reading(p, drive, v, y)
        rows.append([y[0], force, speed, *y[1:]])
        if k + 1 == len(times):
            break
        slope = (values[k + 1] - v) / (times[k + 1] - t)
        right = lambda s, z: rates(p, drive, v + slope * (s - t), z)
        got = solve_ivp(right, (t, times[k + 1]), y, method="DOP853", rtol=1e-12, atol=1e-10)
        assert got.success, got.message
        y = [float(x) for x in got.y[:, -1]]
        if y[0] > p["L"]:
            break
    return rows


def wobble(level, times, share):
    # A driver who follows a gauge: a slow drift, a swing of some seconds, and jitter from a fixed recurrence.
    out, jitter = [], 0.37
    for t in times:
        jitter = 3.9 * jitter * (1 - jitter)
        out.append(level * (1 + share * (0.5 * math.sin(0.9 * t) + 0.3 * math.sin(0.13 * t + 1) + 0.4 * (jitter - 0.5))))
    return out


def main():
    every = [float(t) for t in np.arange(0, 190.5, 1.0)]
    uneven = [0.0]
    while uneven[-1] < 180:
        uneven.append(round(uneven[-1] + [0.3, 1.0, 2.4, 0.7, 1.6][len(uneven) % 5], 3))
    warm, cold = (100 + 459.67) / 1.8, (20 + 459.67) / 1.8
    cases = [
        ("force", every, wobble(5200 * LBF, every, 0.2), {}, [0, 0, 0]),
        ("force", uneven, wobble(4500 * LBF, uneven, 0.5), {"initial.temperature": warm}, [0, 0, 0]),
        ("force", every, wobble(5200 * LBF, every, 0.2),
         {"fluid.cross_time_constant": 0.0008, "fluid.averaging_offset": 0.15, "fluid.shear_factor": 1.1}, [0, 0, 0]),
        ("speed", every, wobble(2.2 * FT, every, 0.2), {}, [0, 0, 0]),
        ("speed", uneven, wobble(2.0 * FT, uneven, 0.5),
         {"initial.temperature": cold, "thermal.fluid_rotor_conductance": 500.0}, [0, 0, 0]),
        ("speed", every, wobble(2.2 * FT, every, 0.2), {"fluid.cross_time_constant": 0.02}, [6.0, 25.0, -3.0]),
    ]
    out = []
    for drive, times, values, overrides, offsets in cases:
        p = dict(BASE)
        p.update({PATHS[path]: value for path, value in overrides.items()})
        rows = follow(p, drive, times, values, offsets)
        out.append(dict(drive=drive, overrides=overrides, offsets=offsets, times=times, values=values, rows=rows))
    print(json.dumps(dict(tool=f"SciPy {scipy.__version__} DOP853 rtol 1e-12", cases=out)))


main()
