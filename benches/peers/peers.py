"""Measures other integrators on the members that `cargo bench --bench peers` writes, in the same run.

    python3 benches/peers/peers.py            # makes a virtual environment, installs the peers, measures

SciPy's LSODA (its own event at the end of the line) and numbalsoda's LSODA (right-hand side compiled by numba;
a second of time, then line length as the independent variable, as it has no events) integrate the dynamic model at
tolerances down to the error asked for. The error is the worst relative one of time, final velocity and final
fluid temperature over the members, against the reference integrator at 1e-10. One thread each.
"""

import datetime
import glob
import json
import os
import platform
import shutil
import subprocess
import sys
import tempfile
import time
import venv

PEERS = ["numpy", "scipy", "numba"]
NUMBALSODA = "numbalsoda==0.3.4"
ERRORS = [1e-4, 1e-5]


def install_numbalsoda(home, python):
    """Builds numbalsoda's LSODA, which is C++; the rest of the package wants a Fortran compiler and is not used."""
    source = os.path.join(home, "source")
    download = [python, "-m", "pip", "download", "-q", "--no-deps", "--no-binary", ":all:", "--no-build-isolation"]
    subprocess.run([*download, "-d", source, NUMBALSODA], check=False)
    (archive,) = glob.glob(os.path.join(source, "*.tar.gz"))
    shutil.unpack_archive(archive, source)
    (tree,) = glob.glob(os.path.join(source, "numbalsoda-*", ""))
    (site,) = glob.glob(os.path.join(home, "lib", "python*", "site-packages"))
    package = os.path.join(site, "numbalsoda")
    os.makedirs(package, exist_ok=True)
    shutil.copy(os.path.join(tree, "numbalsoda", "driver.py"), package)
    with open(os.path.join(package, "__init__.py"), "w") as file:
        file.write("from .driver import lsoda, lsoda_sig\n")
    files = [os.path.join(tree, "src", name) for name in ("LSODA.cpp", "wrapper.cpp")]
    flags = ["-O3", "-march=native", "-shared", "-fPIC", "-std=c++17"]
    subprocess.run(["c++", *flags, *files, "-o", os.path.join(package, "liblsoda.so")], check=True)


def in_environment():
    """Re-runs this script inside an environment that has the peers."""
    home = os.path.join(tempfile.gettempdir(), "reeldown-peers")
    python = os.path.join(home, "bin", "python")
    if not os.path.exists(python):
        venv.create(home, with_pip=True)
        subprocess.run([python, "-m", "pip", "install", "-q", *PEERS], check=True)
        install_numbalsoda(home, python)
    os.execv(python, [python, os.path.abspath(__file__), "--measure", *sys.argv[1:]])


def measure():
    import numba
    import numpy as np
    import scipy
    from numba import carray, cfunc, njit
    from numbalsoda import lsoda, lsoda_sig
    from scipy.integrate import solve_ivp

    if len(sys.argv) > 2:
        path = sys.argv[2]
    else:
        path = os.path.join(tempfile.gettempdir(), "reeldown-peers.json")
        subprocess.run(["cargo", "bench", "--bench", "peers", "--", path], check=True)
    with open(path) as file:
        run = json.load(file)
    members = np.array(run["coefficients"])
    exact = np.array(run["exact"])

    @njit
    def rates(c, l, v1, v2, t1, t2, t3):
        p = c[1] - c[2] * l
        v = v1 - v2
        w = v / np.sqrt(p)
        torque = c[4] * np.exp(c[5] / (t1 + c[6] * (t1 - t2))) * w
        extracted = c[14] * l
        m1 = c[15] + extracted / c[20]
        m2 = (c[13] - extracted) / c[20]
        j = c[3] / p
        q = 0.5 * j * c[2] * w * w + torque / np.sqrt(p)
        f1 = c[16] - extracted - c[17] * v1 * abs(v1) - q
        f2 = q - (c[13] - extracted)
        d = m1 * m2 + j * (m1 + m2)
        power = torque * w
        return (
            v,
            (m2 * f1 + j * (f1 + f2)) / d,
            (m1 * f2 + j * (f1 + f2)) / d,
            (power - c[10] * (t1 - t2) - c[11] * (t1 - t3)) / c[7],
            (c[10] * (t1 - t2) - c[12] * (t2 - t3)) / c[8],
            (c[11] * (t1 - t3) + c[12] * (t2 - t3)) / c[9],
        )

    @cfunc(lsoda_sig)
    def in_time(t, u_, du_, p_):
        u, du, c = carray(u_, (6,)), carray(du_, (6,)), carray(p_, (21,))
        du[0], du[1], du[2], du[3], du[4], du[5] = rates(c, u[0], u[1], u[2], u[3], u[4], u[5])

    @cfunc(lsoda_sig)
    def in_length(l, u_, du_, p_):
        u, du, c = carray(u_, (6,)), carray(du_, (6,)), carray(p_, (21,))
        v, a1, a2, r1, r2, r3 = rates(c, l, u[1], u[2], u[3], u[4], u[5])
        du[0], du[1], du[2] = 1.0 / v, a1 / v, a2 / v
        du[3], du[4], du[5] = r1 / v, r2 / v, r3 / v

    time_pointer, length_pointer = in_time.address, in_length.address

    @njit
    def ensemble(members, rtol):
        out = np.empty((members.shape[0], 3))
        for k in range(members.shape[0]):
            c = members[k].copy()
            start = np.array([0.0, c[18], c[18], c[19], c[19], c[19]])
            first, _ = lsoda(time_pointer, start, np.array([0.0, 1.0]), c, rtol, rtol * 1e-2)
            state = first[-1].copy()
            line = state[0]
            state[0] = 1.0
            rest, _ = lsoda(length_pointer, state, np.array([line, c[0]]), c, rtol, rtol * 1e-2)
            end = rest[-1]
            out[k] = np.array([end[0], end[1] - end[2], end[3]])
        return out

    def scipy_one(c, rtol):
        start = [0.0, c[18], c[18], c[19], c[19], c[19]]
        end = lambda t, u: u[0] - c[0]
        end.terminal = True
        solution = solve_ivp(
            lambda t, u: rates(c, *u), (0.0, 1800.0), start, "LSODA", events=end, rtol=rtol, atol=rtol * 1e-2
        )
        u = solution.y_events[0][0]
        return [solution.t_events[0][0], u[1] - u[2], u[3]]

    def scipy_ensemble(members, rtol):
        return np.array([scipy_one(c, rtol) for c in members])

    def seek(name, run_ensemble, count, repeats):
        """The loosest tolerance with each error, and the speed there."""
        found = {}
        for wanted in ERRORS:
            for rtol in 10.0 ** -np.arange(3.0, 12.0, 0.5):
                run_ensemble(members[:1], rtol)
                best = np.inf
                for _ in range(repeats):
                    begin = time.perf_counter()
                    got = run_ensemble(members[:count], rtol)
                    best = min(best, time.perf_counter() - begin)
                error = np.abs(got / exact[:count] - 1.0).max()
                if error <= wanted:
                    found[wanted] = (name, error, count / best, rtol)
                    break
        return found

    ours = {}
    for wanted in ERRORS:
        fits = [row for row in run["reeldown"] if row["error"] <= wanted]
        best = max(fits, key=lambda row: row["descents_per_s"])
        ours[wanted] = ("reeldown " + run["instruction_set"], best["error"], best["descents_per_s"], best["tolerance"])
    rows = [
        ours,
        seek(f"numbalsoda LSODA (numba {numba.__version__})", ensemble, len(members), 10),
        seek(f"SciPy {scipy.__version__} LSODA", scipy_ensemble, 16, 1),
    ]
    print(f"{datetime.date.today()}, {platform.processor() or platform.machine()}, Python {platform.python_version()}, one thread\n")
    print("| error asked for | integrator | measured error | descents/s | reeldown is |")
    print("| --- | --- | --- | --- | --- |")
    for wanted in ERRORS:
        for row in rows:
            if wanted in row:
                name, error, speed, _ = row[wanted]
                print(f"| {wanted:.0e} | {name} | {error:.1e} | {speed:,.0f} | {ours[wanted][2] / speed:,.0f} × |")


if __name__ == "__main__":
    if len(sys.argv) > 1 and sys.argv[1] == "--measure":
        measure()
    else:
        in_environment()
