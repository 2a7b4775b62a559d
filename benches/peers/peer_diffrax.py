"""diffrax under `vmap` and `jit` in double precision on the processor.

Its event under vmap would be paid for by every lane, so it is told where each descent ends, as
numbalsoda is, and takes one Newton step to the end of the line.
"""
import os

import diffrax
import jax
import numpy as np

jax.config.update("jax_enable_x64", True)
import jax.numpy as jnp

import equations as eq
import members

BATCH = int(os.environ.get("PEERS_DIFFRAX_BATCH", 500))
GRID = 33


def solver(model, method):
    heat, dynamic, quasi_steady = eq.equations(jnp.exp, jnp.sqrt, jnp.abs)
    rates_of = dynamic if model == eq.DYNAMIC else quasi_steady
    scales = jnp.array(eq.SCALES[model])

    def rhs(t, y, p):
        return jnp.stack(rates_of(*y, p))

    def fluid(t, y, p):
        return jnp.stack([y[-3], rhs(t, y, p)[-3]])

    moments = np.linspace(0.3, 1.0, GRID)

    def one(p, y0, end_s, rtol):
        solution = diffrax.diffeqsolve(
            diffrax.ODETerm(rhs), method, 0.0, end_s, 1e-3, y0, args=p,
            stepsize_controller=diffrax.PIDController(rtol=rtol, atol=rtol * scales),
            saveat=diffrax.SaveAt(subs=[
                diffrax.SubSaveAt(t1=True), diffrax.SubSaveAt(ts=moments * end_s, fn=fluid),
            ]),
            max_steps=16384,
        )
        last, warm = solution.ys
        y = last[0]
        rates = rhs(0.0, y, p)
        slope = jnp.zeros(())
        if model != eq.DYNAMIC:
            slope = jax.jvp(lambda z: rhs(0.0, z, p)[0], (y,), (rates,))[1]
        return y, rates, slope, warm

    many = jax.jit(jax.vmap(one, in_axes=(0, 0, 0, None)))

    def solve(p, end_s, rtol):
        start = np.array([eq.start(model, row) for row in p])
        out = []
        for k in range(0, len(p), BATCH):
            part = slice(k, k + BATCH)
            y, rates, slope, warm = map(np.asarray, many(p[part], start[part], end_s[part], rtol))
            t = np.outer(end_s[part], moments)
            peak = members.hermite_peak(t, warm[..., 0], warm[..., 1])
            out.append(members.finish(model, end_s[part], y, rates, peak, slope))
        return np.concatenate(out)

    return solve


def peers():
    for method, model, targets in [
        (diffrax.Kvaerno3(), eq.DYNAMIC, [1e-5]), (diffrax.Kvaerno5(), eq.DYNAMIC, [1e-5, 1e-6]),
        (diffrax.Tsit5(), eq.QUASI_STEADY, [1e-6]), (diffrax.Dopri8(), eq.QUASI_STEADY, [1e-6]),
    ]:
        yield dict(name=f"diffrax {type(method).__name__}", version=diffrax.__version__, model=model,
                   targets=targets, note=f"jax {jax.__version__}, vmap over {BATCH}, told the end",
                   batch=BATCH, solve=solver(model, method))
