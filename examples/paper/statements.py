"""What the paper states in words beside what was computed, with a plain verdict for each statement."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from examples.paper.common import PROPOSED, REFERENCE, Chapter, Done, solve
from stribeck.mouth.cells import percent
from stribeck.mouth.document import Table
from stribeck.scenario import Scenario
from stribeck.simulation import Solution

CONFIRMED, REMARK, NOT = "confirmed", "confirmed with a remark", "not confirmed"
_AT_1E6, _AT_1E7, _AT_1E8 = PROPOSED


@dataclass(frozen=True)
class Statement:
    """A statement of the paper, what was computed about it, and the verdict that follows from the numbers."""

    where: str
    says: str
    found: str
    verdict: str


def chapter(done: Done) -> Chapter:
    """The table of statements."""
    statements = [make(done) for make in _STATEMENTS]
    rows = [[s.where, s.says, s.found, s.verdict] for s in statements]
    text = (
        "Each verdict follows from the numbers beside it: 'confirmed' where they bear the statement out as it stands, with a "
        "remark where they do so only in part.",
    )
    numbers = {s.says: s.verdict for s in statements}
    return Chapter(
        "statements", "What the paper states, and what was computed", text,
        [Table(["where", "the paper says", "computed", "verdict"], rows, prose=True)], (), numbers,
    )  # fmt: skip


def _presliding(done: Done) -> Statement:
    off = done["presliding"].numbers["deviation_of_peak"]
    result = f"largest deviation of y, share of the peak: {', '.join(percent(off[k]) for k in PROPOSED)} for k_v = 1e6, 1e7, 1e8"
    only_large = off[_AT_1E6] > 1.0 > off[_AT_1E7]
    close = off[_AT_1E7] < 0.05
    remark = "" if close else "; at 1e7 it is visible in any plot, and it grows for as long as the force is held"
    verdict = CONFIRMED if only_large and close else REMARK if only_large else NOT
    says = "Presliding: a satisfactory approximation is reached only for very large k_v, of the order of 1e7 s/m or larger."
    return Statement("Section 4, Fig. 4", says, result + remark, verdict)


def _returns(done: Done) -> Statement:
    creep = done["presliding"].numbers["creep"]
    speeds = ", ".join(f"{1e6 * creep[k]:.3g}" for k in (REFERENCE, *PROPOSED))
    result = f"under the held 0.95 F_s: {speeds} µm/s at the end of the hold for lugre and k_v = 1e6, 1e7, 1e8"
    rests = all(abs(creep[k]) < 2 * abs(creep[REFERENCE]) + 1e-9 for k in PROPOSED)
    says = "Presliding: the body does not acquire any translational movement in its true sense."
    return Statement(
        "Section 4",
        says,
        f"{result}: under the proposed law the body keeps moving, for as long as the force is held",
        CONFIRMED if rests else NOT,
    )


def _stick_slip(done: Done) -> Statement:
    off, before = done["stick_slip"].numbers["deviation_of_peak"], done["presliding"].numbers["deviation_of_peak"]
    result = f"largest deviation of y, share of the peak: {', '.join(percent(off[k]) for k in PROPOSED)}"
    closer = all(off[k] < 0.1 * before[k] for k in PROPOSED)
    only_first = off[_AT_1E6] > 0.01 > off[_AT_1E7]
    says = "Stick-slip: much closer than in presliding; the difference is visible only for k_v = 1e6 s/m."
    return Statement(
        "Section 4, Fig. 6", says, result, CONFIRMED if closer and only_first else REMARK if closer else NOT
    )


def _sine(done: Done) -> Statement:
    numbers = done["sine_force"].numbers
    off = numbers["deviation_of_peak_v"]
    result = f"largest deviation of v, share of the peak: {', '.join(percent(off[k]) for k in PROPOSED)}"
    says = "Sinusoidal force: the models are hardly distinguishable for each value of k_v."
    small = max(off.values()) < 0.02
    return Statement("Section 4, Fig. 7", says, result, CONFIRMED if small else REMARK if off[_AT_1E7] < 0.02 else NOT)


def _hunting(done: Done) -> Statement:
    numbers = done["limit_cycle"].numbers
    a, period = numbers["amplitude"], numbers["period"]
    same = all(
        abs(a[k] / a[REFERENCE] - 1) < 0.01 and abs(period[k] / period[REFERENCE] - 1) < 0.01 for k in PROPOSED[1:]
    )
    result = (
        f"amplitude {', '.join(f'{1e3 * a[k]:.2f}' for k in (REFERENCE, *PROPOSED))} mm, "
        f"period {', '.join(f'{period[k]:.2f}' for k in (REFERENCE, *PROPOSED))} s for lugre and k_v = 1e6, 1e7, 1e8"
    )
    says = "Both models clearly predict limit cycles, hardly distinguishable for k_v = 1e7 s/m or greater."
    return Statement("Section 4, Fig. 9", says, result, CONFIRMED if same else NOT)


def _falls(done: Done) -> Statement:
    numbers = done["break_away"].numbers
    forces, rates = numbers["forces"][REFERENCE], numbers["rates"]
    lowest = min(range(len(forces)), key=forces.__getitem__)
    result = f"{forces[0]:.4f} N at {rates[0]:g} N/s, down to {forces[lowest]:.4f} N at {rates[lowest]:g} N/s"
    rises = lowest < len(forces) - 1
    result += f", then up again to {forces[-1]:.4f} N at {rates[-1]:g} N/s" if rises else ""
    says = "The break-away force becomes smaller as the rate of the applied force is increased."
    return Statement("Section 4, Fig. 10", says, result, REMARK if rises else CONFIRMED)


def _close(done: Done) -> Statement:
    below = done["break_away"].numbers["largest_shortfall"]
    result = f"lower than lugre's by at most {', '.join(f'{1e3 * below[k]:.2f}' for k in PROPOSED)} mN"
    says = "Break-away: for k_v of about 1e7 s/m or larger the proposed law resembles the original very closely."
    return Statement("Section 4, Fig. 10", says, result, CONFIRMED if below[_AT_1E7] < 1e-3 else NOT)


def passivity_cycle(k_v: float) -> dict[str, float]:
    """Charge the bristles of lugre_sobczyk to 1 µm, move back slowly until z = 0: energy in and out, J (Table 1)."""
    forward, back, unit = 10 / k_v, -1 / k_v, k_v / 1e7  # m/s, and the time's scale
    law = {"name": "lugre_sobczyk", "parameters": "canudas1995", "k_v": k_v}

    def run(t: list[float], v: list[float], step: float) -> Solution:
        signal = {"kind": "points", "t": t, "value": v}
        return solve(
            Scenario(
                name="passivity_cycle", law=law, drive={"kind": "velocity", "signal": signal},
                solve={"t_end": t[-1]}, output={"step": step, "energy": True},
            )
        )  # fmt: skip

    step = 1e-3 * unit
    charge = run([0.0, 5.0 * unit], [forward, forward], step)
    full = float(charge.t[int((charge["z"] >= 1e-6).argmax())])
    whole = run([0.0, full, full, full + 60.0 * unit], [forward, forward, back, back], step)
    at_full = round(full / step)
    empty = at_full + int((whole["z"][at_full:] <= 0).argmax())
    energy = whole["E_in"]
    return {
        "put_in": float(energy[at_full]), "drawn_out": float(energy[at_full] - energy[empty]), "time": float(whole.t[empty]),
    }  # fmt: skip


def _passive(done: Done) -> Statement:
    cycle = passivity_cycle(1e6)
    result = (
        f"charging to z = 1 µm takes {1e9 * cycle['put_in']:.1f} nJ; moving back at 1 µm/s until z = 0 again gives "
        f"{1e9 * cycle['drawn_out']:.1f} nJ, after {cycle['time']:.1f} s in all (k_v = 1e6 s/m)"
    )
    says = "The proposed law is passive from velocity to friction force (property iii)."
    return Statement("Section 3.2", says, result, NOT if cycle["drawn_out"] > cycle["put_in"] else CONFIRMED)


_STATEMENTS: tuple[Callable[[Done], Statement], ...] = (
    _presliding, _returns, _stick_slip, _sine, _hunting, _falls, _close, _passive,
)  # fmt: skip
