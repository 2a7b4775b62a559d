"""The members of the default study, the reference outcomes, and what an error is."""
import csv
import pathlib
import subprocess

import numpy as np

import equations as eq

OUTCOMES = ["time_s", "final_velocity_m_per_s", "peak_fluid_temperature_k"]
INPUTS = [f"brake_gap_{k}_m" for k in range(1, 15)] + [
    "fluid_shear_factor", "fluid_averaging_offset", "thermal_fluid_capacity_j_per_k",
    "thermal_rotor_capacity_j_per_k", "thermal_housing_capacity_j_per_k",
    "thermal_fluid_rotor_conductance_w_per_k", "thermal_fluid_housing_conductance_w_per_k",
    "thermal_rotor_housing_conductance_w_per_k", "initial_temperature_k",
]


def run_reeldown(reeldown, work, model, count):
    """Inputs and tight outcomes of the first members, from reeldown itself at tolerance 1e-9."""
    import pyarrow.parquet as pq

    out = pathlib.Path(work) / f"run-{model}"
    command = [
        str(reeldown), "run", "--samples", str(count), "--out", str(out), "--quiet",
        "--set", "sensitivity.base_samples=0", "--set", "trade.samples=0",
        "--set", "numerics.tolerance=1e-9", "--set", f'model="{model}"',
    ]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode not in (0, 3, 4):  # 3 and 4 are verdicts
        raise RuntimeError(f"{' '.join(command)}: {done.stderr.strip()}")
    table = pq.read_table(out / "outcomes.parquet")
    if not all(table["deployed"].to_pylist()):
        raise RuntimeError("a member did not deploy; the peers' programs assume that all do")
    names = table.schema.names
    varied = names[names.index("sample") + 1 : names.index(OUTCOMES[0])]
    if varied != INPUTS:
        raise RuntimeError(f"the default study varies other inputs than this script knows: {varied}")
    inputs = np.column_stack([table[name].to_numpy() for name in INPUTS])
    outcomes = np.column_stack([table[name].to_numpy() for name in OUTCOMES])
    return inputs, outcomes


def parameters(inputs):
    """The nine numbers of `equations` for each row of inputs."""
    per_gap = (1.0 / inputs[:, :14]).sum(axis=1)
    return np.ascontiguousarray(
        np.column_stack([eq.TORQUE * per_gap * inputs[:, 14], inputs[:, 15:]])
    )


def write_csv(path, inputs):
    with open(path, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(INPUTS)
        writer.writerows([[repr(float(value)) for value in row] for row in inputs])


def worst_error(outcomes, reference):
    """Worst relative error over members and the three outcomes (temperature in kelvin)."""
    error = np.abs(outcomes - reference[: len(outcomes)]) / np.abs(reference[: len(outcomes)])
    return float(np.nan_to_num(error, nan=np.inf).max())


def hermite_peak(t, T, dT):
    """Largest value of the piecewise cubic through values and slopes; rows are descents."""
    h = np.diff(t, axis=-1)
    a, b = dT[..., :-1] * h, dT[..., 1:] * h
    rise = T[..., 1:] - T[..., :-1]
    # T = T0 + a s + (3 rise - 2 a - b) s^2 + (a + b - 2 rise) s^3; its slope is zero at a root in (0, 1).
    c2, c3 = 3 * rise - 2 * a - b, a + b - 2 * rise
    with np.errstate(all="ignore"):
        root = np.sqrt(np.maximum(c2 * c2 - 3 * a * c3, 0.0))
        s = a / (root - c2)  # the maximum, in the form without cancellation
    inside = np.isfinite(s) & (s > 0) & (s < 1) & (dT[..., :-1] > 0) & (dT[..., 1:] < 0)
    s = np.where(inside, s, 0.0)
    interior = T[..., :-1] + s * (a + s * (c2 + s * c3))
    return np.maximum(np.nanmax(T, axis=-1), np.nanmax(interior, axis=-1))


def finish(model, end_s, y, rates, peak, slope=None):
    """Outcomes from the state at a moment close to the end of the line, by one Newton step to the end."""
    speed = rates[:, 0]
    late = (eq.L - y[:, 0]) / speed
    if model == eq.DYNAMIC:
        slope = rates[:, 1] - rates[:, 2]
    return np.column_stack([end_s + late, speed + late * slope, peak])
