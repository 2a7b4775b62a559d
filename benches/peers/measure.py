"""Measures the peers of one module in a process of its own: `measure.py MODULE WORK_DIRECTORY BUDGET_S`.

A module offers `peers()`: dictionaries of name, version, model, note, targets, `solve(p, end_s, rtol)` with
p the members' parameters and end_s the reference's reel-down times, and optionally `batch`, the number
of members it takes at once. Prints one JSON object a line.
"""
import importlib
import json
import pathlib
import statistics
import sys
import time
import traceback

import numpy as np

import members

QUARTER_DECADE = 10 ** -0.25
REPEATS = 3


def timed(peer, data, count, rtol):
    p, reference = data[peer["model"]]
    wall, busy = time.perf_counter(), time.process_time()
    outcomes = peer["solve"](p[:count], reference[:count, 0], rtol)
    busy = time.process_time() - busy
    wall = time.perf_counter() - wall
    return members.worst_error(outcomes, reference), wall, busy


def whole_batches(peer, count, limit):
    batch = peer.get("batch", 1)
    return int(min(limit // batch * batch, max(1, round(count / batch)) * batch))


def measure(peer, data, target, budget_s):
    limit = len(data[peer["model"]][0])
    timed(peer, data, whole_batches(peer, 2, limit), 1e-5)  # compiles and warms up
    count = whole_batches(peer, 2, limit)
    _, _, busy = timed(peer, data, count, target)
    # The scan sees fewer members than the measurement: it has some ten runs in the time of one.
    scan = whole_batches(peer, count * 0.1 * budget_s / max(busy, 1e-6), limit)
    rtol, tried = target * 10, 0
    while tried < 20:
        error, _, busy = timed(peer, data, scan, rtol)
        tried += 1
        if error <= target:
            break
        rtol *= QUARTER_DECADE ** (2 if error > 4 * target else 1)
    count = whole_batches(peer, scan * 0.25 * budget_s / max(busy, 1e-6), limit)
    for _ in range(8):
        error, *_ = timed(peer, data, count, rtol)
        if error <= target:
            break
        rtol *= QUARTER_DECADE
    runs = [timed(peer, data, count, rtol) for _ in range(REPEATS)]
    return dict(
        rtol=rtol, members=count, error=max(run[0] for run in runs), met=error <= target,
        wall_s=statistics.median(run[1] for run in runs) / count,
        processor_s=statistics.median(run[2] for run in runs) / count,
    )


def main():
    module, work, budget_s = sys.argv[1], pathlib.Path(sys.argv[2]), float(sys.argv[3])
    stored = np.load(work / "members.npz")
    data = {model: (stored["p"], stored[model]) for model in ("dynamic", "quasi-steady")}
    for peer in importlib.import_module(module).peers():
        for target in peer["targets"]:
            row = {key: peer[key] for key in ("name", "version", "model", "note")} | dict(target=target)
            try:
                row |= measure(peer, data, target, budget_s)
            except Exception as problem:  # a peer that fails is a row of the table
                traceback.print_exc()
                row["failure"] = f"{type(problem).__name__}: {str(problem).strip().splitlines()[0][:200] if str(problem).strip() else ''}"
            print(json.dumps(row), flush=True)


if __name__ == "__main__":
    main()
