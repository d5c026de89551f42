"""Columns of static models: the same as computed one by one, with fewer of them filtered."""

from __future__ import annotations

import numpy as np
import pytest

from stribeck import laws
from stribeck.arrays import Array
from stribeck.identify.data.filters import shifted
from stribeck.identify.features.sliding import Sliding
from stribeck.identify.log import Log
from stribeck.identify.models.columns import Columns
from stribeck.identify.models.static_problem import thinning
from stribeck.identify.models.terms import column

TYPICAL = {"F_c": 2.0, "F_s": 3.0, "v_s": 0.02, "sigma_2": 5.0}
TERMS = ("mass", "offset", "stiffness", "F_c_by_position")


def record() -> Log:
    """Two runs of a sum of sines."""
    t = 1e-3 * np.arange(1500)
    x = 0.02 * np.sin(9 * t) + 0.003 * np.sin(40 * t)
    v = np.gradient(x, 1e-3)
    return Log(t, x, v, np.gradient(v, 1e-3), 2 * np.sign(v) + x, (t > 0.9).astype(np.int32), step=1e-3)


def directly(log: Log, law: Sliding, delay: float, shape: dict[str, float]) -> dict[str, Array]:
    """Every column by itself, each run moved by the delay."""

    def moved(x: Array) -> Array:
        return np.concatenate([shifted(x[rows], delay / log.step) for rows in log.runs()])

    v, reduce = moved(log.velocity), thinning(log, 5)
    speeds, table = law.table(shape, max(log.velocity.max(), -log.velocity.min()), list(law.linear))
    curves = {name: np.interp(v, speeds, values) for name, values in table.items()}
    found = {name: reduce(x) for name, x in curves.items()}
    found |= {name: reduce(moved(column(name, log, {}))) for name in ("mass", "stiffness")}
    found["F_c_by_position"] = reduce((curves["F_c"] + curves["F_s"]) * moved(log.position))
    return found | {"offset": reduce(np.ones(len(log)))}


@pytest.mark.parametrize("delay", [0.0, 3e-3, -2.3e-3, 1e-3 * (1 - 1e-16)])
@pytest.mark.parametrize("k_v", [None, 300.0])
def test_columns_are_those_computed_one_by_one(delay: float, k_v: float | None) -> None:
    log, given = record(), {} if k_v is None else {"k_v": k_v}
    law = Sliding(laws.find("stribeck"), given, TYPICAL)
    columns = Columns(log, law, thinning(log, 5))
    for v_s in (0.02, 0.05, 0.02):  # the second time from what was kept
        found = columns.at({"v_s": v_s, "delay": delay, **given}, TERMS)
        for name, x in directly(log, law, delay, {"v_s": v_s, **given}).items():
            np.testing.assert_allclose(found[name], x, rtol=0, atol=1e-9 * np.max(abs(x)), err_msg=name)


def test_another_curve_filters_only_what_is_new() -> None:
    log, calls = record(), []
    reduce = thinning(log, 5)

    def counted(x: Array) -> Array:
        calls.append(1)
        return reduce(x)

    columns = Columns(log, Sliding(laws.find("stribeck"), {}, TYPICAL), counted)
    columns.at({"v_s": 0.02}, TERMS)
    calls.clear()
    columns.at({"v_s": 0.03}, TERMS)
    assert len(calls) == 1  # the bend; sign, viscous friction, its growth and the rig's columns are as they were
    columns.at({"v_s": 0.03, "delay": 2.2e-3}, ("mass", "stiffness"))
    calls.clear()
    columns.at({"v_s": 0.03, "delay": 2.3e-3}, ("mass", "stiffness"))
    assert len(calls) == 2  # sign and bend; all else is put together from whole rows
