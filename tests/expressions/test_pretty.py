"""Equations for people."""

from math import inf

import pytest

from stribeck.expressions import ops, pretty
from stribeck.expressions.graph import symbol

x, y = symbol("x"), symbol("sigma_0")
LATEX, TEXT = {"x": "x", "sigma_0": r"\sigma_{0}"}, {"x": "x", "sigma_0": "σ₀"}
CASES = r"\begin{cases}x & \text{if } x < \sigma_{0} \\ 1 & \text{else}\end{cases}"


@pytest.mark.parametrize(
    ("expr", "text", "latex"),
    [
        (x - y * x, "x - σ₀ x", r"x - \sigma_{0} x"),
        (x - (y - x), "x - (σ₀ - x)", r"x - \left(\sigma_{0} - x\right)"),
        (x * x * y, "x² σ₀", r"x^{2} \sigma_{0}"),
        (x**3 / y**2, "x³/σ₀²", r"\frac{x^{3}}{\sigma_{0}^{2}}"),
        ((x + y) ** 2, "(x + σ₀)²", r"\left(x + \sigma_{0}\right)^{2}"),
        (2 / ops.pi * ops.atan(x), "(2/π) arctan(x)", r"\frac{2}{\pi} \arctan\left(x\right)"),
        (ops.exp(-x), "exp(-x)", "e^{-x}"),
        (0.25 * abs(x), "0.25 |x|", r"0.25 \left|x\right|"),
        (x / (y * x), "x/(σ₀ x)", r"\frac{x}{\sigma_{0} x}"),
        (ops.where(x < y, x, 1.0), "x if x < σ₀, else 1", CASES),
        (-(x + y), "-(x + σ₀)", r"-\left(x + \sigma_{0}\right)"),
        (x**y, "x^σ₀", r"x^{\sigma_{0}}"),
        (ops.floor(x) - 1, "floor(x) - 1", r"\left\lfloor x \right\rfloor - 1"),
        (x - inf, "x - inf", r"x - \infty"),
    ],
)
def test_reads_as_written(expr, text, latex):
    assert pretty.write(expr, TEXT, latex=False) == text
    assert pretty.write(expr, LATEX, latex=True) == latex


@pytest.mark.parametrize(
    ("name", "text", "latex"),
    [("z_ba", "z_ba", "z_{ba}"), ("g1", "g₁", "g_{1}"), ("delta", "δ", r"\delta"), ("mass", "mass", r"\mathrm{mass}")],
)
def test_names(name, text, latex):
    assert pretty.name(name, latex=False) == text
    assert pretty.name(name, latex=True) == latex
