"""The Dahl law."""

from __future__ import annotations

from types import SimpleNamespace

from stribeck.expressions.ops import Value, sqrt
from stribeck.laws.base import BristleLaw, Claims, Scales


class Dahl(BristleLaw):
    """The Dahl law: hysteresis in presliding, Coulomb friction in sliding; no Stribeck effect."""

    name = "dahl"
    source = "Dahl, A solid friction model, TOR-0158(3107-18)-1, The Aerospace Corporation, 1968"
    claims = Claims(unique=True, bounded=True, smooth=False, passive=True, drift_free=False)
    v_d = None
    delta = None
    uses = ("sigma_0", "F_c")
    relations = ()

    @staticmethod
    def dz_dt(p: SimpleNamespace, v: Value, z: Value) -> Value:
        return v - p.sigma_0 / p.F_c * abs(v) * z

    @staticmethod
    def friction(p: SimpleNamespace, v: Value, z: Value, dz_dt: Value) -> Value:
        """The bristles' elastic force alone."""
        return p.sigma_0 * z

    @staticmethod
    def z_bound(p: SimpleNamespace) -> Value:
        """F_c/sigma_0."""
        return p.F_c / p.sigma_0

    @staticmethod
    def scales(p: SimpleNamespace) -> Scales:
        """F_c/sigma_0, the speed at which 1 kg on the bristle spring passes it, and F_c."""
        return Scales(p.F_c / p.sigma_0, p.F_c / sqrt(p.sigma_0), p.F_c)
