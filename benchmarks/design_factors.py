"""By how much each compensation that `stribeck design` compared lowers the error after a reversal, on a machine of any kind:
what it said, and what another solver finds, on equations written apart (tests/machine/independent.py).

    stribeck design MACHINE.toml --out DIR
    python benchmarks/design_factors.py MACHINE.toml DIR [--out FILE]

Takes minutes: SciPy goes from sample to sample in plain Python.
"""

from __future__ import annotations

import argparse
import json
import sys
import tomllib
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).parent.parent
sys.path.insert(0, str(ROOT))

from tests.machine import independent  # noqa: E402
from tests.simulation.independent import friction  # noqa: E402

WAVES = 4  # as `design` simulates them; the first lets transients die out
SHARE = 0.2  # by which a factor may differ
Data = dict[str, Any]


class Leading(independent.Machine):
    """With lead dF/dt, and the steady force of any law."""

    @staticmethod
    def steady(law: str, p: Data, v: float) -> float:
        """z from where its rate is 0: rates fall as z grows."""
        rate = friction(law, p)
        low, high = 0.0, 4 * p["F_s"] / p["sigma_0"]
        for _ in range(100):
            middle = (low + high) / 2
            low, high = (middle, high) if rate(v, middle)[0] > 0 else (low, middle)
        return float(rate(v, low)[1])

    def output(self, n: str, c: Data, reference: Any, y: float, v: float, integral: float, z_hat: float) -> Any:
        """dF/dt by differences, the reference's acceleration taken for the motor's."""
        u, rate, push, dz = super().output(n, c, reference, y, v, integral, z_hat)
        table = c.get("compensation", {})
        if table.get("lead"):
            law, p = self.law_of(c)
            of, h, k = friction(law, p), 1e-6 * p["v_s"], 1e-6 * p["F_s"] / p["sigma_0"]
            by_v = (of(v + h, z_hat)[1] - of(v - h, z_hat)[1]) / (2 * h)
            by_z = (of(v, z_hat + k)[1] - of(v, z_hat - k)[1]) / (2 * k)
            u += table.get("share", 1.0) * table["lead"] * (by_v * reference[2] + by_z * of(v, z_hat)[0])
        return u, rate, push, dz


def reversal(data: Data, controller: str, moves: Data, given: Data) -> float:
    """The largest error within an eighth of a period after the reversals of the standard sine, but its first wave."""
    data, T = deepcopy(data), moves["period"]
    table = data["controllers"][controller]
    table.pop("compensation", None), table.pop("dither", None)
    table |= deepcopy(given) | {"signal": {"kind": "sine", "amplitude": moves["amplitude"], "frequency": 1 / T}}
    data["solve"]["t_end"], data["output"] = WAVES * T, {"step": T / 500}
    found = independent.solve(data, 1e-8)
    t, measured = np.asarray(found["t"]), table.get("measures") or table["on"]
    e = np.asarray(found[f"{controller}.r"]) - np.asarray(found[f"{measured}.y"])
    near = ((t / T - 0.25) % 0.5 <= 0.125) & (t >= T)
    return float(np.abs(e[near]).max())


def main() -> None:
    """Each compensation, a row as it comes."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("machine", type=Path)
    parser.add_argument("design", type=Path, help="what `stribeck design MACHINE --out DIR` wrote")
    parser.add_argument("--controller", help="the first unless given")
    parser.add_argument("--out", type=Path)
    options = parser.parse_args()
    data = tomllib.loads(options.machine.read_text())
    controller = options.controller or next(iter(data["controllers"]))
    found = json.loads((options.design / "summary.json").read_text())
    independent.Machine = Leading
    rows: list[Data] = []
    for c in found["compensations"]:
        shaken = {n: c["dither"][n] for n in ("kind", "amplitude", "frequency")} if "dither" in c else None
        given = {"compensation": c["table"]} if "table" in c else {"dither": shaken} if shaken else {}
        error = reversal(data, controller, found["moves"], given)
        before = rows[0]["found"] if rows else error
        said, got = found["compensations"][0]["reversal_error"] / c["reversal_error"], before / error
        rows.append(
            {"kind": c["kind"], "share": c["share"], "said": c["reversal_error"], "found": error, "factor_said": said,
             "factor_found": got, "agrees": bool(abs(got / said - 1) <= SHARE)}
        )  # fmt: skip
        print(json.dumps(rows[-1]), flush=True)
        if options.out:
            options.out.write_text(json.dumps({"machine": data["name"], "factors": rows}, indent=1) + "\n")
    print(f"{sum(r['agrees'] for r in rows)} of {len(rows)} factors within 20 %")


if __name__ == "__main__":
    main()
