"""Whether anybody has seen the Stribeck curve on which F_s and v_s hang."""

from __future__ import annotations

NO_CURVE = "F_s comes out near F_c and v_s is open: friction that rises towards lower speeds would look alike"


def no_curve_seen(lowest_F_s: float | None, highest_F_c: float | None) -> bool:
    """Whether F_s reaches down to F_c, beside a v_s that nothing tells: ends of their intervals, N (N m); None: open.

    The optimum then has no curve, any v_s fits as well, and no profile crosses to where the curve may be.
    """
    return lowest_F_s is None or highest_F_c is None or lowest_F_s <= highest_F_c
