"""The polynomials of runtime/vector.c: through Chebyshev's nodes, in 50 digits, rounded; and the error that they leave.

python tools/polynomials.py
"""

from __future__ import annotations

from collections.abc import Callable

import mpmath as mp

mp.mp.dps = 50
_POINTS = 999


def interpolated(function: Callable[[mp.mpf], mp.mpf], low: mp.mpf, high: mp.mpf, degree: int) -> list[float]:
    """The coefficients of the polynomial through the nodes, lowest first."""
    nodes = [
        (low + high) / 2 + (high - low) / 2 * mp.cos(mp.pi * (2 * k + 1) / (2 * degree + 2)) for k in range(degree + 1)
    ]
    powers = mp.matrix([[x**j for j in range(degree + 1)] for x in nodes])
    return [float(x) for x in mp.lu_solve(powers, mp.matrix([function(x) for x in nodes]))]


def told(name: str, found: list[float], error: Callable[[mp.mpf, mp.mpf], mp.mpf], low: mp.mpf, high: mp.mpf) -> None:
    """Print the coefficients and the largest error at many points."""
    worst = mp.mpf(0)
    for k in range(_POINTS):
        x = low + (high - low) * (k + mp.mpf(1) / 2) / _POINTS
        worst = max(worst, abs(error(x, sum(mp.mpf(a) * x**j for j, a in enumerate(found)))))
    print(f"{name}: relative error {mp.nstr(worst, 2)} before rounding\n    {found}")


def main() -> None:
    """exp(r) = 1 + r + r^2 P(r) for |r| <= log(2)/2; atan(y) = y + y q P(q), q = y^2, for |y| <= tan(pi/8)."""
    end = mp.log(2) / 2 * mp.mpf("1.0001")
    found = interpolated(lambda r: (mp.exp(r) - 1 - r) / r**2 if r else mp.mpf(1) / 2, -end, end, 9)
    told("exp", found, lambda r, p: (1 + r + r * r * p) / mp.exp(r) - 1, -end, end)
    end = mp.tan(mp.pi / 8) ** 2 * mp.mpf("1.0001")
    found = interpolated(lambda q: (mp.atan(mp.sqrt(q)) / mp.sqrt(q) - 1) / q, mp.mpf(0), end, 10)
    told("atan", found, lambda q, p: (1 + q * p) / (mp.atan(mp.sqrt(q)) / mp.sqrt(q)) - 1, mp.mpf(0), end)


if __name__ == "__main__":
    main()
