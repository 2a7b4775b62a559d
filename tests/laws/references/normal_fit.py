"""Rational approximations of the standard normal law for src/numerics/special/normal.rs.

Weighted linear least squares, iterated on the denominator, in 50 digits on Chebyshev nodes. Prints
each pair of coefficient tables and the largest relative error with the coefficients as doubles.

    python normal_fit.py      # needs mpmath
"""

import mpmath as mp

mp.mp.dps = 50


def polynomial(coefficients, x):
    return sum(mp.mpf(c) * x**k for k, c in enumerate(coefficients))


def fit(name, f, high, numerator, denominator, nodes, forth=lambda x: x, back=lambda y: y):
    """f on [0, high] as a quotient of polynomials of the two degrees, Chebyshev nodes in forth(x)."""
    high = mp.mpf(high)
    top = forth(high)
    xs = [back(top / 2 * (1 + mp.cos(mp.pi * (k + mp.mpf(1) / 2) / nodes))) for k in range(nodes)]
    fs = [f(x) for x in xs]
    below = [mp.mpf(1)] + [mp.mpf(0)] * denominator
    for _ in range(6):
        matrix, right = mp.matrix(nodes, numerator + 1 + denominator), mp.matrix(nodes, 1)
        for i, (x, value) in enumerate(zip(xs, fs)):
            t = x / high
            weight = 1 / (value * polynomial(below, t))
            for k in range(numerator + 1):
                matrix[i, k] = weight * t**k
            for k in range(1, denominator + 1):
                matrix[i, numerator + k] = -weight * value * t**k
            right[i] = weight * value
        solution, _ = mp.qr_solve(matrix, right)
        below = [mp.mpf(1)] + [solution[numerator + k] for k in range(1, denominator + 1)]
    above = [float(solution[k] / high**k) for k in range(numerator + 1)]
    below = [float(c / high**k) for k, c in enumerate(below)]
    points = [back(top * k / 299) for k in range(300)]
    error = max(abs(polynomial(above, x) / polynomial(below, x) / f(x) - 1) for x in points)
    print(name, "relative error", mp.nstr(error, 3))
    print("numerator  ", above)
    print("denominator", below)


def magnitude(p):
    """The z >= 0 whose upper tail is p."""
    p = mp.mpf(p)
    if p > mp.mpf("1e-3"):
        return mp.sqrt(2) * mp.erfinv(1 - 2 * p)
    r = mp.sqrt(-2 * mp.log(p))
    z = r - mp.log(r * mp.sqrt(2 * mp.pi)) / r
    for _ in range(60):
        tail = mp.erfc(z / mp.sqrt(2)) / 2
        step = (mp.log(tail) - mp.log(p)) * tail / mp.npdf(z)
        z += step
        if abs(step) < mp.mpf(10) ** -44:
            break
    return z


def central(c):
    """z/q, q = 1/2 - p, as a function of c = 0.425^2 - q^2."""
    square = mp.mpf("0.180625") - c
    if square <= mp.mpf(10) ** -30:
        return mp.sqrt(2 * mp.pi)
    q = mp.sqrt(square)
    return mp.sqrt(2) * mp.erfinv(2 * q) / q


def mills(t):
    return mp.exp(t * t / 2) * mp.erfc(t / mp.sqrt(2)) / 2


if __name__ == "__main__":
    fit("CENTRAL", central, "0.180625", 7, 7, 50)
    # The tails in sqrt(-ln p), from 1.6 and from 6.
    fit("TAIL", lambda t: magnitude(mp.exp(-((t + mp.mpf(1.6)) ** 2))), "4.9", 8, 8, 60)
    fit("FAR", lambda t: magnitude(mp.exp(-((t + 6) ** 2))), "21.4", 7, 7, 60)
    fit("MILLS", mills, "39", 9, 10, 80, lambda t: t / (t + 3), lambda y: 3 * y / (1 - y))
