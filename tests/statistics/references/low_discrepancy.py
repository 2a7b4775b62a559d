"""Unscrambled Sobol' and Halton points of SciPy, as exact fractions, for tests/statistics/low_discrepancy.rs.

Run: python low_discrepancy.py > low_discrepancy.json   (NumPy and SciPy; a minute or two)
"""

import json
import sys

import numpy as np
import scipy
from scipy.stats import qmc

SOBOL_DIMENSION = 64
SOBOL_WALKED = [1, 2, 3, 7, 15, 16, 100, 1023, 1024, 65536, 699050, (1 << 20) + 12345, (1 << 30) + 12345]
SOBOL_FAR = [(1 << 40) + 987654321, (1 << 49) + 123456789012345]
HALTON_DIMENSION = 64
HALTON = [0, 1, 2, 3, 10, 100, 65535, 1000003, (1 << 31) - 5]


def walked(dimension, indices):
    """SciPy's own points: its generator is moved forward to each index.

    With 32 bits, enough for indices below 2**32: SciPy cannot move a wider generator forward.
    """
    sampler = qmc.Sobol(d=dimension, scramble=False, bits=32)
    points, at = [], 0
    for index in indices:
        sampler.fast_forward(index - at)
        points.append(sampler.random(1)[0])
        at = index + 1
    return points


def far(dimension, index):
    """A point too far to walk to, from SciPy's direction numbers in Gray-code order."""
    directions = qmc.Sobol(d=dimension, scramble=False, bits=53)._sv
    gray, word = index ^ (index >> 1), np.zeros(dimension, dtype=np.uint64)
    for bit in range(53):
        if gray >> bit & 1:
            word ^= directions[:, bit].astype(np.uint64)
    return word.astype(np.float64) * 2.0**-53


def main():
    points = walked(SOBOL_DIMENSION, SOBOL_WALKED)
    for index, point in zip(SOBOL_WALKED, points):
        assert np.array_equal(point, far(SOBOL_DIMENSION, index)), index
    points += [far(SOBOL_DIMENSION, index) for index in SOBOL_FAR]
    halton = []
    for index in HALTON:
        sampler = qmc.Halton(d=HALTON_DIMENSION, scramble=False)
        # fast_forward would make and keep every point on the way; the next index is all the state.
        sampler.num_generated = index
        halton.append(list(sampler.random(1)[0]))
    # The Gray code of 699050 is twenty ones: every initial direction number takes part.
    wide = walked(1024, [699050])[0]
    json.dump(
        {
            "source": f"SciPy {scipy.__version__}, scipy.stats.qmc, scramble=False",
            "sobol": [{"index": i, "point": list(p)} for i, p in zip(SOBOL_WALKED + SOBOL_FAR, points)],
            "sobol_1024": {"index": 699050, "point": list(wide)},
            "halton": [{"index": i, "point": p} for i, p in zip(HALTON, halton)],
        },
        sys.stdout,
        indent=None,
        separators=(",", ":"),
    )


main()
