"""Reference values for tests/laws: tails and quantiles of the special functions and of every law.

mpmath with 60 digits and more (incomplete functions from series of positive terms, so that no
digits cancel); SciPy for a second opinion on a part of them, which this script checks itself.
A tail at a double x is rounded to a double p; the quantile of that p is x + (p_rounded - p)/f(x),
whose error is of second order in 1e-16.

    python quantiles.py        # writes quantiles.json beside itself; needs mpmath, scipy (and gmpy2 to be quick)
"""

import json
import pathlib

import mpmath as mp
from scipy import special, stats

mp.mp.dps = 60
EPS = mp.mpf(10) ** -60


# --- special functions -------------------------------------------------------------------------


def gamma_prefix(a, x):
    return mp.exp(a * mp.log(x) - x - mp.loggamma(a + 1))


def gamma_tails(a, x):
    """P and Q of the gamma law, each to some 50 digits."""
    with mp.workdps(420):
        a, x = mp.mpf(a), mp.mpf(x)
        stop = mp.mpf(10) ** -400
        term = total = mp.mpf(1)
        n = 0
        while True:
            n += 1
            term *= x / (a + n)
            total += term
            if term < stop * total and n > x - a:
                break
        lower = gamma_prefix(a, x) * total
        return lower, 1 - lower


def beta_tails(a, b, x):
    """I and 1 - I of the beta law."""
    with mp.workdps(420):
        a, b, x = mp.mpf(a), mp.mpf(b), mp.mpf(x)
        y = 1 - x
        if x > y:
            upper, lower = beta_tails(b, a, y)
            return lower, upper
        stop = mp.mpf(10) ** -400
        term = total = mp.mpf(1)
        n = 0
        while True:
            term *= (a + b + n) / (a + 1 + n) * x
            n += 1
            total += term
            if term < stop * total * y and (a + b + n) / (a + 1 + n) * x < 1:
                break
        ln_b = mp.loggamma(a) + mp.loggamma(b) - mp.loggamma(a + b)
        lower = mp.exp(a * mp.log(x) + b * mp.log(y) - ln_b) / a * total
        return lower, 1 - lower


def corrected(x, tail, density, sign):
    """The exact quantile of the double nearest to `tail`."""
    rounded = mp.mpf(float(tail))
    return float(mp.mpf(x) + sign * (rounded - tail) / density)


SMALLEST = 1e-290


def case(x, lower, upper, density, **shape):
    row = dict(shape, x=x, lower=float(lower), upper=float(upper))
    # A tail that rounds to nearly one no longer says where it is.
    if SMALLEST < lower < 0.99:
        row["quantile_lower"] = corrected(x, lower, density, 1)
    if SMALLEST < upper < 0.99:
        row["quantile_upper"] = corrected(x, upper, density, -1)
    return row


def gamma_cases():
    rows = []
    for a in (0.01, 0.1, 0.5, 0.999, 1.0, 1.7, 2.3, 12.9, 40.0, 300.5, 999.0, 1001.0, 5e4, 1e7):
        root = a**0.5
        points = {a + k * root for k in (-25, -8, -3, -1, -0.1, 0, 0.1, 1, 3, 8, 25)}
        if a < 50:
            points |= {a * k for k in (1e-12, 1e-6, 1e-3, 0.1, 0.3, 2.5, 5)} | {a + 50, a + 200, 0.7, 1.6, 3.0}
        if a < 1:
            points |= {1e-100, 1e-250}
        for x in sorted(points):
            if x <= 0:
                continue
            lower, upper = gamma_tails(a, x)
            density = gamma_prefix(mp.mpf(a), mp.mpf(x)) * a / mp.mpf(x)
            rows.append(case(x, lower, upper, density, a=a))
    return rows


def beta_cases():
    rows = []
    shapes = [
        (0.01, 0.01), (0.01, 5.0), (0.5, 0.5), (0.5, 3.0), (3.0, 0.5), (0.1, 1e4), (1.0, 1.0), (2.5, 4.0),
        (1.0, 1e7), (3.0, 999998.0), (1.0, 100.0), (51.0, 50.0), (11.0, 990.0), (400.0, 600.5), (900.0, 1e6),
        (1100.0, 1200.0), (4e4, 6e4), (1500.0, 1e7), (5e6, 5e6), (852.0, 3.0), (1e4, 0.3),
    ]
    for a, b in shapes:
        mean = a / (a + b)
        sd = (mean * (1 - mean) / (a + b + 1)) ** 0.5
        points = {mean + k * sd for k in (-20, -6, -3, -1, -0.1, 0, 0.1, 1, 3, 6, 12, 20)}
        if a < 1000:
            points |= {mean * k for k in (1e-9, 1e-4, 0.01, 0.1, 0.4)}
        if a < 1:
            points |= {1e-100, 1e-250}
        if a + b < 20:
            points |= {0.25, 0.5, 0.75, 0.96875}
        for x in sorted(points):
            if not 0 < x < 1 or float(x) in (0.0, 1.0):
                continue
            lower, upper = beta_tails(a, b, x)
            if lower < 1e-305 and upper < 1e-305:
                continue
            am, bm, xm = mp.mpf(a), mp.mpf(b), mp.mpf(x)
            density = mp.exp((am - 1) * mp.log(xm) + (bm - 1) * mp.log(1 - xm) - mp.log(mp.beta(am, bm)))
            if density < 1e-305:
                continue
            rows.append(case(x, lower, upper, density, a=a, b=b))
    return rows


def normal_cases():
    rows = []
    for k in range(-372, 373, 6):
        z = k / 10 + 0.003
        zm = mp.mpf(z)
        lower, upper = mp.ncdf(zm), mp.erfc(zm / mp.sqrt(2)) / 2
        rows.append(dict(case(z, lower, upper, mp.npdf(zm)), ln_lower=float(mp.log(lower) if z < 0 else mp.log1p(-upper))))
    for z in (-200.0, -1e4, -38.2):
        t = mp.mpf(-z)
        rows.append({"x": z, "ln_lower": float(mp.log(mp.erfc(t / mp.sqrt(2)) / 2))})
    for p in (0.5 - 1e-9, 0.5 - 1e-15, 0.0749, 0.075, 0.0751, 1e-17, 4.3e-18, 4.2e-18, 1e-300, 0.3, 0.4999, 1e-9):
        z = float(special.ndtri(p))
        zm = mp.findroot(lambda t: mp.erfc(-t / mp.sqrt(2)) / 2 / p - 1, z)
        rows.append({"x": float(zm), "lower": None, "p": p})
    return rows


def student_cases():
    rows = []
    for df in (0.7, 1.0, 2.0, 5.0, 30.0, 999.0, 1e5):
        for t in (1e-9, 0.01, 0.5, 0.999, 1.0, 2.0, 4.5, 10.0, 30.0, 1e4):
            d, s = mp.mpf(df), mp.mpf(t)
            x = d / (d + s * s)
            if x > mp.mpf(1) / 2:
                upper = beta_tails(mp.mpf(1) / 2, d / 2, 1 - x)[1] / 2
            else:
                upper = beta_tails(d / 2, mp.mpf(1) / 2, x)[0] / 2
            if upper < 1e-290:
                continue
            density = mp.exp(-(d + 1) / 2 * mp.log(1 + s * s / d)) / (mp.sqrt(d) * mp.beta(d / 2, mp.mpf(1) / 2))
            rows.append(dict(case(t, 1 - upper, upper, density), df=df))
    return rows


def binomial_cases():
    rows = []
    for k, n, p in [(0, 10, 0.3), (3, 10, 0.3), (9, 10, 0.3), (2, 2000, 0.001), (5, 1000, 0.0273), (50, 100, 0.5),
                    (3, 10**6, 1e-6), (40_321, 100_000, 0.4), (0, 852, 0.0027)]:
        with mp.workdps(60):
            pm = mp.mpf(p)
            if n <= 2000:
                term = [mp.binomial(n, j) * pm**j * (1 - pm) ** (n - j) for j in range(n + 1)]
                cdf, survival, here = mp.fsum(term[: k + 1]), mp.fsum(term[k + 1 :]), term[k]
            else:
                survival, cdf = beta_tails(k + 1, n - k, p)
                here = mp.exp(mp.log(mp.binomial(n, k)) + k * mp.log(pm) + (n - k) * mp.log(1 - pm))
        rows.append(dict(k=k, n=n, p=p, cdf=float(cdf), survival=float(survival), probability=float(here)))
    return rows


# --- laws ----------------------------------------------------------------------------------------


def normal_tails(z):
    return mp.erfc(-z / mp.sqrt(2)) / 2, mp.erfc(z / mp.sqrt(2)) / 2


class Family:
    """A law in mpmath: tails and density at x; SciPy's frozen twin supplies starting points."""

    def __init__(self, name, parameters, twin, tails, density, support=(-mp.inf, mp.inf)):
        self.name, self.parameters, self.twin = name, parameters, twin
        self.tails, self.density, self.support = tails, density, support


def normal(mean, sd):
    m, s = mp.mpf(mean), mp.mpf(sd)
    return Family("normal", [mean, sd], stats.norm(mean, sd), lambda x: normal_tails((x - m) / s),
                  lambda x: mp.npdf((x - m) / s) / s)


def lognormal(log_mean, log_sd):
    m, s = mp.mpf(log_mean), mp.mpf(log_sd)
    return Family("lognormal", [log_mean, log_sd], stats.lognorm(log_sd, scale=float(mp.exp(m))),
                  lambda x: normal_tails((mp.log(x) - m) / s), lambda x: mp.npdf((mp.log(x) - m) / s) / (s * x),
                  (mp.mpf(0), mp.inf))


def uniform(a, b):
    l, u = mp.mpf(a), mp.mpf(b)
    return Family("uniform", [a, b], stats.uniform(a, b - a), lambda x: ((x - l) / (u - l), (u - x) / (u - l)),
                  lambda x: 1 / (u - l), (l, u))


def triangular(a, c, b):
    l, m, u = mp.mpf(a), mp.mpf(c), mp.mpf(b)

    def tails(x):
        if x <= m and m > l:
            p = (x - l) ** 2 / ((u - l) * (m - l))
            return p, 1 - p
        q = (u - x) ** 2 / ((u - l) * (u - m))
        return 1 - q, q

    def density(x):
        return 2 / (u - l) * ((x - l) / (m - l) if x <= m and m > l else (u - x) / (u - m))

    return Family("triangular", [a, c, b], stats.triang((c - a) / (b - a), a, b - a), tails, density, (l, u))


def beta(a, b, lower, upper):
    l, w = mp.mpf(lower), mp.mpf(upper) - mp.mpf(lower)
    am, bm = mp.mpf(a), mp.mpf(b)
    norm = mp.log(mp.beta(am, bm))
    return Family("beta", [a, b, lower, upper], stats.beta(a, b, lower, upper - lower),
                  lambda x: beta_tails(a, b, (x - l) / w),
                  lambda x: mp.exp((am - 1) * mp.log((x - l) / w) + (bm - 1) * mp.log((l + w - x) / w) - norm) / w,
                  (l, l + w))


def weibull(shape, scale, location):
    k, s, l = mp.mpf(shape), mp.mpf(scale), mp.mpf(location)
    y = lambda x: (x - l) / s
    return Family("weibull", [shape, scale, location], stats.weibull_min(shape, location, scale),
                  lambda x: (-mp.expm1(-y(x) ** k), mp.exp(-y(x) ** k)),
                  lambda x: k / s * y(x) ** (k - 1) * mp.exp(-y(x) ** k), (l, mp.inf))


def gumbel(location, scale, minimum):
    l, s = mp.mpf(location), mp.mpf(scale)
    sign = -1 if minimum else 1

    def tails(x):
        e = mp.exp(-sign * (x - l) / s)
        pair = mp.exp(-e), -mp.expm1(-e)
        return pair[::sign]

    def density(x):
        t = sign * (x - l) / s
        if t < -100:
            return mp.mpf(0)  # below exp(-1e43)
        return mp.exp(-t - mp.exp(-t)) / s

    twin = (stats.gumbel_l if minimum else stats.gumbel_r)(location, scale)
    return Family("gumbel_minimum" if minimum else "gumbel", [location, scale], twin, tails, density)


def gamma(shape, scale, location):
    a, s, l = mp.mpf(shape), mp.mpf(scale), mp.mpf(location)
    return Family("gamma", [shape, scale, location], stats.gamma(shape, location, scale),
                  lambda x: gamma_tails(a, (x - l) / s),
                  lambda x: mp.exp((a - 1) * mp.log((x - l) / s) - (x - l) / s - mp.loggamma(a)) / s, (l, mp.inf))


def exponential(mean, location):
    m, l = mp.mpf(mean), mp.mpf(location)
    return Family("exponential", [mean, location], stats.expon(location, mean),
                  lambda x: (-mp.expm1(-(x - l) / m), mp.exp(-(x - l) / m)), lambda x: mp.exp(-(x - l) / m) / m,
                  (l, mp.inf))


LAWS = [
    normal(0.0015748, 7.62e-5), normal(-3.0, 1.0), lognormal(0.0, 0.0798723), lognormal(1.0555234405475835, 0.5),
    lognormal(-2.0, 1.5), uniform(-1.5, 4.0), triangular(1.0, 2.0, 4.0), triangular(0.0, 0.0, 1.0),
    triangular(-1.0, 3.0, 3.0), beta(2.5, 4.0, 0.0, 1.0), beta(0.4, 0.7, -2.0, 3.0), beta(3.2, 1.8, 10.0, 30.0),
    weibull(2.5, 4.0, 0.0), weibull(0.7, 2.0, 1.0), weibull(12.0, 300.0, 0.0),
    gumbel(1342.4813773590069, 272.89388043178664, False), gumbel(3.0, 0.5, True),
    gamma(2.3, 1.7, 0.0), gamma(0.3, 2.0, 5.0), gamma(80.0, 0.1, 0.0), exponential(3.0, 0.0), exponential(0.5, -1.0),
]

TRUNCATED = [
    (normal(0.0015748, 7.62e-5), 0.0013462, 0.0018034), (normal(288.7056, 5.5556), 255.3722, 310.9278),
    (normal(0.0, 1.0), -2.0, 1.0), (normal(0.0, 1.0), 6.0, 9.0), (normal(0.0, 1.0), -9.0, -6.0),
    (normal(0.0, 1.0), 20.0, None), (normal(0.0, 1.0), None, -30.0), (normal(0.0, 1.0), 1.0, 1.001),
    (normal(5.0, 2.0), None, 7.0), (lognormal(0.0, 0.08), 0.8, 1.25), (lognormal(0.0, 0.5), 8.0, None),
    (uniform(0.0, 10.0), 2.0, 3.0), (triangular(1.0, 2.0, 4.0), 1.5, 3.0), (triangular(1.0, 2.0, 4.0), 3.0, None),
    (beta(2.5, 4.0, 0.0, 1.0), 0.3, 0.9), (beta(2.5, 4.0, 0.0, 1.0), 0.95, None), (weibull(2.5, 4.0, 0.0), 3.0, 12.0),
    (weibull(0.7, 2.0, 1.0), None, 4.0), (gumbel(3.0, 0.5, False), 2.0, 9.0), (gumbel(3.0, 0.5, True), -4.0, 2.0),
    (gamma(2.3, 1.7, 0.0), 1.0, 30.0), (gamma(0.3, 2.0, 5.0), None, 6.0), (gamma(80.0, 0.1, 0.0), 15.0, None),
    (exponential(3.0, 0.0), 60.0, 90.0),
]

TAILS = (1e-280, 1e-100, 1e-30, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3, 0.025, 0.2, 0.4)


def law_case(family, lower=None, upper=None):
    low = family.support[0] if lower is None else max(mp.mpf(lower), family.support[0])
    high = family.support[1] if upper is None else min(mp.mpf(upper), family.support[1])
    whole = lower is None and upper is None
    f_low = mp.mpf(0) if low == family.support[0] else family.tails(low)[0]
    s_low = mp.mpf(1) if low == family.support[0] else family.tails(low)[1]
    f_high = mp.mpf(1) if high == family.support[1] else family.tails(high)[0]
    s_high = mp.mpf(0) if high == family.support[1] else family.tails(high)[1]
    mass = f_high - f_low if f_high < 0.5 else s_low - s_high
    points = set()
    for t in TAILS:
        if whole or f_low + t * mass < 0.5:
            points.add(float(family.twin.ppf(float(f_low + t * mass))))
        if whole or s_high + t * mass < 0.5:
            points.add(float(family.twin.isf(float(s_high + t * mass))))
    if not whole:
        a = float(low) if mp.isfinite(low) else min(p for p in points if p == p and abs(p) < 1e300)
        b = float(high) if mp.isfinite(high) else max(p for p in points if p == p and abs(p) < 1e300)
        points |= {a + (b - a) * share for share in (1e-6, 0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 1 - 1e-6)}
    rows = []
    for x in sorted(p for p in points if p == p):
        xm = mp.mpf(x)
        if not low < xm < high:
            continue
        below, above = family.tails(xm)
        p = (below - f_low) / mass if below < 0.5 else 1 - (above - s_high) / mass
        q = (above - s_high) / mass if above < 0.5 else 1 - (below - f_low) / mass
        density = family.density(xm) / mass
        if density == 0:
            continue
        rows.append(dict(case(x, p, q, density), ln_density=float(mp.log(density))))
    # Nodes that round onto an end, where a density may be infinite, carry less than 1e-14 there.
    weight = lambda g: mp.quad(lambda x: g(x) if low < x < high else mp.mpf(0), cuts)
    with mp.workdps(50):
        # Pieces: far out towards an infinite end, but not crowding a finite one, which may be singular.
        cuts = [low]
        for r in rows:
            end, tail = (low, r["lower"]) if r["lower"] < r["upper"] else (high, r["upper"])
            if tail > (1e-31 if mp.isinf(end) else 0.15):
                cuts.append(mp.mpf(r["x"]))
        cuts.append(high)
        # An infinite end is replaced by the outermost point, whose tail is below 1e-90.
        xs = [mp.mpf(r["x"]) for r in rows]
        cuts = sorted({min(xs) if mp.isinf(c) and c < 0 else max(xs) if mp.isinf(c) else c for c in cuts})
        if family.name == "triangular" and low < family.parameters[1] < high:
            cuts = sorted({*cuts, mp.mpf(family.parameters[1])})
        # The quadrature stops by an absolute error: the density is normalised inside it.
        mean = weight(lambda x: x * family.density(x) / mass)
        sd = mp.sqrt(weight(lambda x: (x - mean) ** 2 * family.density(x) / mass))
    if whole:
        # SciPy's closed forms as a second opinion on the quadrature.
        assert abs(float(mean) - family.twin.mean()) < 1e-8 * family.twin.std(), family.name
        assert abs(float(sd) / family.twin.std() - 1) < 1e-8, (family.name, float(sd), family.twin.std())
    return dict(family=family.name, parameters=family.parameters, lower=lower, upper=upper,
                mean=float(mean), sd=float(sd), rows=rows)


def main():
    reference = {
        "about": __doc__.split("\n")[0],
        "normal": normal_cases(),
        "gamma": gamma_cases(),
        "beta": beta_cases(),
        "student": student_cases(),
        "binomial": binomial_cases(),
        "laws": [law_case(family) for family in LAWS] + [law_case(*case) for case in TRUNCATED],
    }
    # SciPy's opinion where it is known to be good.
    for row in reference["gamma"]:
        if row["lower"] > 1e-200 and row["a"] < 100:
            assert abs(special.gammainc(row["a"], row["x"]) / row["lower"] - 1) < 1e-11, row
    for row in reference["beta"]:
        if row["lower"] > 1e-200 and row["a"] + row["b"] < 100:
            assert abs(special.betainc(row["a"], row["b"], row["x"]) / row["lower"] - 1) < 1e-11, row
    path = pathlib.Path(__file__).with_name("quantiles.json")
    text = json.dumps(reference, indent=None, separators=(",", ":")).replace("},{", "},\n{")
    path.write_text(text + "\n")
    print({key: len(value) for key, value in reference.items() if key != "about"})


if __name__ == "__main__":
    main()
