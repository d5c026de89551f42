"""Make the synthetic velocity record of the example 'measured': slow, to and fro, with noise and quantisation."""

from pathlib import Path

import numpy as np

HERE = Path(__file__).parent.parent / "src" / "stribeck" / "examples"


def main() -> None:
    """Write measured_velocity.csv: 10 s at 100 Hz, noise 20 um/s, quantised to 5 um/s as an encoder would."""
    rng = np.random.default_rng(1)
    t = np.arange(1001) / 100
    v = 4e-3 * np.sin(2 * np.pi * 0.2 * t) * (1 - np.exp(-t)) * (1 + 0.5 * np.sin(2 * np.pi * 0.05 * t))
    v = np.round((v + 2e-5 * rng.standard_normal(len(t))) / 5e-6) * 5e-6
    rows = "".join(f"{a:.2f},{b:.6f}\n" for a, b in zip(t, v, strict=True))
    (HERE / "measured_velocity.csv").write_text("time_s,velocity_m_per_s\n" + rows)


if __name__ == "__main__":
    main()
