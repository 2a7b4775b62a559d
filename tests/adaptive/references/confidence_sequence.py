"""Ends of the confidence sequence in 30 digits, for the table in src/reliability/confidence_sequence.rs.

python3 tests/adaptive/references/confidence_sequence.py   (mpmath)
"""

from mpmath import beta, mp, mpf

mp.dps = 30
KAPPA, SHARE = 1000, mpf("0.1")


def martingale(p, m, n):
    likelihood = p**m * (1 - p) ** (n - m)
    own = beta(KAPPA * p + m, KAPPA * (1 - p) + n - m) / beta(KAPPA * p, KAPPA * (1 - p))
    return ((1 - SHARE) * own + SHARE * beta(m + 1, n - m + 1)) / likelihood


def end(m, n, outside, risk):
    """Bisection between m/n and `outside`, geometric where both are positive and far apart."""
    inside = mpf(m) / n
    for _ in range(300):
        least, most = min(inside, outside), max(inside, outside)
        middle = (least * most) ** mpf("0.5") if least > 0 and most > 4 * least else (least + most) / 2
        if martingale(middle, m, n) < 1 / risk:
            inside = middle
        else:
            outside = middle
    return inside


for m, n in [(0, 10), (0, 100), (0, 1000), (0, 4096), (1, 100), (10, 1000), (41, 4096), (50, 100), (1000, 100000)]:
    risk = mpf("0.05")
    tiny = mpf(10) ** -20
    lower = mpf(0) if m == 0 else end(m, n, tiny, risk)
    upper = end(m, n, 1 - tiny, risk)
    print(f"({m}, {n}, {mp.nstr(lower, 17)}, {mp.nstr(upper, 17)}),")
