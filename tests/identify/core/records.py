"""Records of a slider with known friction, made with NumPy alone."""

import numpy as np

from stribeck.identify.log import Log

TRUTH = {"mass": 2.0, "F_c": 5.0, "F_s": 8.0, "v_s": 0.05, "sigma_2": 12.0, "offset": 0.7}
RATES = (0.11, 0.31, 0.67)  # Hz


def record(
    seed=0, *, step=0.002, end=20.0, slow=1.0, extra=lambda t, y, v, a: 0.0, noise=0.05, way=0.1, rates=RATES, **changed
):  # fmt: skip
    """A log of several sines; ``extra``: a further force; ``slow``: the share of the time in slow motion."""
    draw, p = np.random.default_rng(seed), {**TRUTH, **changed}
    t, rates = step * np.arange(round(end / step)), 2 * np.pi * np.array(rates) * slow
    waves = np.outer(t, rates) + draw.uniform(0, 2 * np.pi, len(rates))
    y = way * np.sin(waves).sum(1)
    v = way * (rates * np.cos(waves)).sum(1)
    a = -way * (rates**2 * np.sin(waves)).sum(1)
    level = p["F_c"] + (p["F_s"] - p["F_c"]) * np.exp(-((v / p["v_s"]) ** 2))
    force = p["mass"] * a + np.sign(v) * level + p["sigma_2"] * v + p["offset"] + extra(t, y, v, a)
    force = force + noise * draw.standard_normal(len(t))
    return Log(t, y, v, a, force, np.zeros(len(t), np.int32))


def joined(*logs, names=()):
    """Logs of several files as one."""
    columns = {
        n: np.concatenate([getattr(each, n) for each in logs])
        for n in ("time", "position", "velocity", "acceleration", "force")
    }
    run = np.repeat(np.arange(len(logs), dtype=np.int32), [len(each) for each in logs])
    return Log(**columns, run=run, step=logs[0].step, files=tuple(names or (f"run {i}" for i in range(len(logs)))))
