"""Aliases for untyped data: flint's polynomials (it ships no types), and data that becomes JSON."""

from __future__ import annotations

from typing import Any

Polynomial = Any  # flint's fmpq_mpoly, or one coefficient of it, an fmpq
Json = Any  # numbers, text, None, and lists and mappings of these
Numbers = Any  # a number or an array for NumPy
