#!/usr/bin/env python3
"""Measures reeldown and its peers on the same descents, in one run on one core: see README.md."""
import argparse
import datetime
import json
import os
import pathlib
import platform
import shlex
import shutil
import subprocess
import sys
import venv

HERE = pathlib.Path(__file__).resolve().parent
PACKAGES = ["numpy", "scipy", "numba", "pyarrow", "jax", "diffrax", "scikit-sundae"]
REQUIRED = {"numpy", "scipy", "numba", "pyarrow"}
MODULES = {
    "peer_scipy": "SciPy", "peer_lsoda": "numbalsoda LSODA", "peer_cvode": "CVODE", "peer_diffrax": "diffrax",
}
TARGETS = [("dynamic", 1e-5), ("dynamic", 1e-6), ("quasi-steady", 1e-6)]
# Tolerances of reeldown, from the loosest that can meet a target to the tightest that a peer's error asks for.
LADDER = {
    "dynamic": ["4e-5", "2e-5", "1.8e-5", "1.6e-5", "1.4e-5", "1.2e-5", "1e-5", "7e-6", "5e-6", "3.5e-6",
                "2.5e-6", "2.2e-6", "2e-6", "1.8e-6", "1.6e-6", "1.4e-6", "1e-6", "7e-7", "5e-7", "3.5e-7", "2e-7"],
    "quasi-steady": ["5e-6", "4e-6", "3.5e-6", "3e-6", "2.5e-6", "2e-6", "1.4e-6", "1e-6", "7e-7", "5e-7",
                     "3.5e-7", "2e-7", "1e-7"],
}
ONE_THREAD = {
    "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1", "NUMBA_NUM_THREADS": "1",
    "NPROC": "1", "XLA_FLAGS": "--xla_cpu_multi_thread_eigen=false", "JAX_PLATFORMS": "cpu",
    "PYTHONDONTWRITEBYTECODE": "1",
}


def arguments():
    cache = pathlib.Path(os.environ.get("XDG_CACHE_HOME", pathlib.Path.home() / ".cache"))
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--reeldown", default="target/release/reeldown", help="the program")
    parser.add_argument("--cargo", default="cargo", help="how to call cargo for the kernel's bench")
    parser.add_argument("--kernel", help="the bench kernel_rate, if it is built already")
    parser.add_argument("--cache", type=pathlib.Path, default=cache / "reeldown-peers")
    parser.add_argument("--members", type=int, default=10_000)
    parser.add_argument("--budget", type=float, default=4.0, help="seconds that set a measurement's size")
    parser.add_argument("--core", type=int, default=max(os.sched_getaffinity(0)))
    parser.add_argument("--only", choices=list(MODULES), action="append")
    parser.add_argument("--out", type=pathlib.Path, default=HERE / "results.md")
    parser.add_argument("--timeout", type=float, default=180.0, help="seconds for one peer's module")
    return parser.parse_args()


def note(text):
    print(text, file=sys.stderr, flush=True)


def last_line(text):
    lines = [line.strip() for line in text.strip().splitlines() if line.strip()]
    told = [line for line in lines if "error" in line.lower() and not line.lower().startswith("note")]
    return (told or lines or ["no message"])[-1][:200]


def pip(python, *words):
    command = [python, "-m", "pip", *words, "--quiet", "--disable-pip-version-check"]
    return subprocess.run(command, capture_output=True, text=True)


def install(cache):
    """An environment of its own; the packages that could not be had, with the reason."""
    python = cache / "venv" / "bin" / "python"
    if not python.exists():
        note(f"making {python.parents[1]}")
        venv.create(python.parents[1], with_pip=True)
    missing = {}
    for package in PACKAGES:
        if pip(python, "show", package).returncode == 0:
            continue
        note(f"installing {package}")
        done = pip(python, "install", "--only-binary", ":all:", package)
        if done.returncode:
            if package in REQUIRED:
                sys.exit(f"cannot install {package}: {last_line(done.stderr)}")
            missing[package] = last_line(done.stderr)
    settings, reason = numbalsoda(str(python), cache)
    if reason:
        missing["numbalsoda"] = reason
    return str(python), settings, missing


def numbalsoda(python, cache):
    """numbalsoda as a package, or else its C++ part from its own sources: the rest of it needs Fortran."""
    if pip(python, "show", "numbalsoda").returncode == 0:
        return {}, None
    built = cache / "lsoda"
    if not (built / "version").exists():
        note("installing numbalsoda")
        if shutil.which("gfortran"):
            done = pip(python, "install", "numbalsoda")
            if done.returncode == 0:
                return {}, None
        source = cache / "source"
        shutil.rmtree(source, ignore_errors=True)
        words = ["download", "--no-deps", "--no-binary", "numbalsoda", "-d", str(source), "numbalsoda"]
        done = pip(python, *words)
        archives = list(source.glob("numbalsoda-*.tar.gz"))
        if not archives:
            return {}, last_line(done.stderr)
        shutil.unpack_archive(archives[0], source)
        tree = archives[0].with_name(archives[0].name.removesuffix(".tar.gz"))
        built.mkdir(parents=True, exist_ok=True)
        command = ["c++", "-O3", "-march=native", "-std=c++11", "-fPIC", "-shared", "-o",
                   str(built / "liblsoda.so"), str(tree / "src/LSODA.cpp"), str(tree / "src/wrapper.cpp")]
        try:
            done = subprocess.run(command, capture_output=True, text=True)
        except OSError as problem:
            return {}, f"no Fortran compiler for the package, no C++ compiler for its LSODA: {problem}"
        if done.returncode:
            return {}, last_line(done.stderr)
        shutil.copy(tree / "numbalsoda/driver.py", built)
        (built / "version").write_text(tree.name.split("-")[1])
    return dict(PEERS_LSODA_SOURCE=str(built), PEERS_LSODA_VERSION=(built / "version").read_text()), None


def pinned(core, command):
    return (["taskset", "-c", str(core)] if shutil.which("taskset") else []) + command


def prepare(python, work, options, environment):
    """Members and reference on disk; how well SciPy's Radau confirms it."""
    program = (
        "import json, sys, numpy as np, members, peer_scipy\n"
        "reeldown, work, count = sys.argv[1], sys.argv[2], int(sys.argv[3])\n"
        "inputs, dynamic = members.run_reeldown(reeldown, work, 'dynamic', count)\n"
        "again, steady = members.run_reeldown(reeldown, work, 'quasi-steady', count)\n"
        "assert (inputs == again).all(), 'the two runs have different members'\n"
        "p = members.parameters(inputs)\n"
        "members.write_csv(work + '/members.csv', inputs)\n"
        "stored = {'p': p, 'dynamic': dynamic, 'quasi-steady': steady}\n"
        "np.savez(work + '/members.npz', **stored)\n"
        "sample = np.linspace(0, len(p) - 1, 8).astype(int)\n"
        "print(json.dumps({m: members.worst_error(peer_scipy.confirm(p[sample], m, 8), stored[m][sample])"
        " for m in ('dynamic', 'quasi-steady')}))\n"
    )
    command = [python, "-c", program, options.reeldown, str(work), str(options.members)]
    environment = environment | {"PYTHONPATH": str(HERE)}
    done = subprocess.run(command, capture_output=True, text=True, env=environment)
    if done.returncode:
        sys.exit(f"no reference: {done.stderr.strip()}")
    agreement = json.loads(done.stdout)
    if max(agreement.values()) > 1e-8:
        sys.exit(f"SciPy's Radau does not confirm the reference: {agreement}")
    return agreement


def kernel(options):
    """The kernel's bench as a program."""
    if options.kernel:
        return options.kernel
    command = shlex.split(options.cargo) + [
        "bench", "--no-run", "--bench", "kernel_rate", "--message-format=json",
    ]
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, cwd=HERE.parents[1])
    for line in done.stdout.splitlines():
        message = json.loads(line) if line.startswith("{") else {}
        if message.get("executable") and message["target"]["name"] == "kernel_rate":
            return message["executable"]
    sys.exit("the bench kernel_rate does not build")


def measure_reeldown(program, python, work, core, environment):
    """Rates of every tolerance of the ladder, each with its measured error."""
    cases = [f"{model}:{tolerance}" for model, ladder in LADDER.items() for tolerance in ladder]
    command = pinned(core, [program, str(work / "members.csv"), str(work), *cases])
    done = subprocess.run(command, capture_output=True, text=True, env=environment)
    if done.returncode:
        sys.exit(f"kernel_rate: {done.stderr.strip()}")
    rows = [json.loads(line) for line in done.stdout.splitlines()]
    judge = (
        "import json, sys, numpy as np, members\n"
        "work, cases = sys.argv[1], sys.argv[2:]\n"
        "stored = np.load(work + '/members.npz')\n"
        "print(json.dumps([members.worst_error(np.fromfile(f'{work}/{m}-{t}.f64').reshape(-1, 3), stored[m])"
        " for m, t in (case.split(':') for case in cases)]))\n"
    )
    environment = environment | {"PYTHONPATH": str(HERE)}
    done = subprocess.run([python, "-c", judge, str(work), *cases], capture_output=True, text=True, env=environment)
    if done.returncode:
        sys.exit(f"the kernel's outcomes cannot be judged: {done.stderr.strip()}")
    for row, error in zip(rows, json.loads(done.stdout), strict=True):
        row["error"] = error
    return rows


def measure_peer(module, python, work, options, environment):
    """Rows of one module, in a process of its own; what it did not get to is a row with the reason."""
    note(f"measuring {MODULES[module]}")
    command = pinned(options.core, [python, str(HERE / "measure.py"), module, str(work), str(options.budget)])
    with open(work / f"{module}.out", "w") as out, open(work / f"{module}.err", "w") as err:
        try:
            code = subprocess.run(command, stdout=out, stderr=err, env=environment, timeout=options.timeout).returncode
            reason = None if code == 0 else f"exit code {code}: " + last_line((work / f"{module}.err").read_text())
        except subprocess.TimeoutExpired:
            reason = f"not finished after {options.timeout:.0f} s"
    rows = [json.loads(line) for line in (work / f"{module}.out").read_text().splitlines() if line.startswith("{")]
    if reason:
        rows.append(dict(name=MODULES[module], version="", note="", model=None, failure=reason))
    return rows


def processor():
    try:
        for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def whole(number):
    return f"{float(f'{number:.3g}'):,.0f}".replace(",", " ")


def table(own, peers, model, target):
    meets = [row for row in own if row["model"] == model and row["error"] <= target]
    lines = [
        f"## {model.capitalize()} model, worst error at most {target:.0e}", "",
        "| program | version | how | members | worst error | descents/s/core | reeldown at no larger error | ratio |",
        "| --- | --- | --- | ---: | ---: | ---: | ---: | ---: |",
    ]
    best = min(meets, key=lambda row: row["processor_s"], default=None)
    if best:
        lines.append(
            f"| **reeldown** | {best['version']} | {best['instruction_set']}, {best['steps']:.1f} steps a descent, "
            f"tolerance {best['tolerance']:.1e} | {best['members']} | {best['error']:.1e} "
            f"| **{whole(1 / best['processor_s'])}** | | 1 |"
        )
    else:
        lines.append("| **reeldown** | | no tolerance of the ladder meets the error | | | | | |")
    rows = [row for row in peers if row["model"] == model and row["target"] == target]
    for row in sorted(rows, key=lambda row: row.get("processor_s", float("inf"))):
        head = f"| {row['name']} | {row['version']} | {row['note']} "
        if "failure" in row:
            lines.append(head + f"| | failed: {row['failure']} | | | |".replace("\n", " "))
            continue
        # Never compare with a reeldown less exact than the peer was.
        equal = [own_row for own_row in own if own_row["model"] == model and own_row["error"] <= row["error"]]
        match = min(equal, key=lambda row: row["processor_s"], default=None)
        ratio = row["processor_s"] / match["processor_s"] if match else None
        lines.append(
            head + f"| {row['members']} | {row['error']:.1e}{'' if row['met'] else ' (missed)'} "
            f"| {whole(1 / row['processor_s'])} | "
            + (f"{whole(1 / match['processor_s'])} ({match['error']:.1e}) | {float(f'{ratio:.3g}'):g} |" if match else "not measured | |")
        )
    return lines + [""]


def report(options, own, peers, missing, agreement, loads, shares):
    when = datetime.datetime.now().astimezone().strftime("%Y-%m-%d %H:%M %Z")
    lines = [
        "# reeldown and its peers", "",
        f"Made by `benches/peers/run.py` on {when}: {processor()}, {os.cpu_count()} cores, {platform.system()} "
        f"{platform.machine()}; everything on core {options.core}, one thread each. Load average "
        f"{loads[0]:.2f} before and {loads[1]:.2f} after; the measured threads had "
        f"{100 * min(shares):.0f} to {100 * max(shares):.0f} % of the core.", "",
        f"The first {options.members} members of the default study. The error is the worst relative one over the members "
        "measured and over time, final velocity and peak fluid temperature (kelvin), against reeldown at tolerance "
        "1e-9, which SciPy's Radau at rtol 1e-11 confirms on 8 members to "
        f"{agreement['dynamic']:.0e} (dynamic) and {agreement['quasi-steady']:.0e} (quasi-steady). Rates are of "
        "processor time, medians, without compilation. How each peer is used, and where it is favoured, is told "
        "in README.md.", "",
    ]
    for model, target in TARGETS:
        lines += table(own, peers, model, target)
    failures = dict(missing) | {row["name"]: row["failure"] for row in peers if row["model"] is None}
    if failures:
        lines += ["## Not measured, or not completely", ""]
        lines += [f"- {name}: {reason}" for name, reason in failures.items()] + [""]
    return "\n".join(lines)


def main():
    options = arguments()
    options.reeldown = str(pathlib.Path(options.reeldown).resolve())
    environment = {**os.environ, **ONE_THREAD}
    python, settings, missing = install(options.cache)
    environment |= settings
    work = options.cache / "work"
    shutil.rmtree(work, ignore_errors=True)
    work.mkdir(parents=True)
    program = kernel(options)
    note("members and reference")
    agreement = prepare(python, work, options, environment)
    version = subprocess.run([options.reeldown, "--version"], capture_output=True, text=True).stdout.split()[-1]

    before = os.getloadavg()[0]
    note("measuring reeldown")
    own = measure_reeldown(program, python, work, options.core, environment)
    peers = []
    for module in options.only or MODULES:
        peers += measure_peer(module, python, work, options, environment)
    note("measuring reeldown again")
    again = measure_reeldown(program, python, work, options.core, environment)
    for row, other in zip(own, again, strict=True):
        row["version"] = version
        for key in ("wall_s", "processor_s"):
            row[key] = (row[key] + other[key]) / 2
    done = own + [row for row in peers if "processor_s" in row]
    for row in own:
        row["processor_s"] = row["processor_s"] or row["wall_s"]  # where the system does not tell
    shares = [min(1.0, row["processor_s"] / row["wall_s"]) for row in done]
    text = report(options, own, peers, missing, agreement, (before, os.getloadavg()[0]), shares)
    options.out.write_text(text)
    print(text)


if __name__ == "__main__":
    main()
