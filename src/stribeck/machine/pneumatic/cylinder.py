"""A two-chamber pneumatic cylinder with a servo-valve (Perondi & Guenther 2002; Guenther et al. 2006)."""

from __future__ import annotations

from types import SimpleNamespace

from stribeck.expressions.ops import Value, atan, clip, cos, sin, where

Own = tuple[Value, ...]  # the pressures
_LEAST_GAIN = 1.0  # Pa/s by opening, against a division by zero; an open valve gives some 1e6


class Cylinder:
    """A piston between two chambers of gas, which a valve fills from the supply and empties to the atmosphere."""

    @staticmethod
    def acceleration(p: SimpleNamespace, u: Value, F: Value, x: Own) -> Value:
        """dv/dt in m/s^2 under the chambers' pressures and the friction force F (the paper's eq. 10)."""
        p_1, p_2 = x
        return (p.area * (p_1 - p_2) - F) / p.mass

    @staticmethod
    def rates(p: SimpleNamespace, y: Value, v: Value, u: Value, F: Value, x: Own) -> Own:
        """dp_1/dt and dp_2/dt at the valve voltage u, Pa/s; with ``p.supply_droop`` if the supply is not constant."""
        p_1, p_2 = x
        q_1, q_2 = Cylinder.flows(p, p_1, p_2, u, getattr(p, "supply_droop", 0.0))
        return Cylinder.pressure_rates(p, y, v, p_1, p_2, q_1, q_2)

    @staticmethod
    def volumes(p: SimpleNamespace, y: Value) -> tuple[Value, Value]:
        """The volumes of the chambers, m^3."""
        return p.area * y + p.dead_volume_1, p.area * (p.stroke - y) + p.dead_volume_2

    @staticmethod
    def opening(u: Value) -> Value:
        """The valve's opening at the voltage u, arctan(2 u)."""
        return atan(2 * u)

    @staticmethod
    def flows(p: SimpleNamespace, p_1: Value, p_2: Value, u: Value, droop: Value = 0.0) -> tuple[Value, Value]:
        """The mass flows into the chambers, kg/s; ``droop`` is the supply's loss of pressure by flow, Pa s/kg."""
        o = Cylinder.opening(u)

        def filling(o: Value, inside: Value) -> Value:
            flow = p.beta_fill * o
            return flow * (p.supply_pressure - inside) / (1 + droop * flow)

        def emptying(o: Value, inside: Value) -> Value:
            return p.beta_empty * o * (inside - p.atmospheric_pressure)

        q_1 = where(u >= 0, filling(o, p_1), emptying(o, p_1))
        q_2 = where(u >= 0, -emptying(o, p_2), filling(-o, p_2))
        return q_1, q_2

    @staticmethod
    def pressure_rates(
        p: SimpleNamespace, y: Value, v: Value, p_1: Value, p_2: Value, q_1: Value, q_2: Value
    ) -> tuple[Value, Value]:
        """dp_1/dt and dp_2/dt, Pa/s."""
        volume_1, volume_2 = Cylinder.volumes(p, y)
        gas = p.heat_ratio * p.gas_constant * p.temperature
        sweep = p.heat_ratio * p.area * v
        return (gas * q_1 - sweep * p_1) / volume_1, (gas * q_2 + sweep * p_2) / volume_2

    @staticmethod
    def unforced(p: SimpleNamespace, y: Value, v: Value, p_1: Value, p_2: Value) -> Value:
        """h_hat of the paper's eq. 11: the rate of p_1 - p_2 with the valve closed, Pa/s."""
        rate_1, rate_2 = Cylinder.pressure_rates(p, y, v, p_1, p_2, 0.0, 0.0)
        return rate_1 - rate_2

    @staticmethod
    def voltage(p: SimpleNamespace, y: Value, p_1: Value, p_2: Value, u_hat: Value, u_max: Value) -> Value:
        """The valve voltage within +-u_max that adds u_hat (Pa/s) to the rate of p_1 - p_2, or the nearest possible."""
        volume_1, volume_2 = Cylinder.volumes(p, y)
        gas = p.heat_ratio * p.gas_constant * p.temperature
        fill_1 = p.beta_fill * (p.supply_pressure - p_1) / volume_1
        fill_2 = p.beta_fill * (p.supply_pressure - p_2) / volume_2
        empty_1 = p.beta_empty * (p_1 - p.atmospheric_pressure) / volume_1
        empty_2 = p.beta_empty * (p_2 - p.atmospheric_pressure) / volume_2
        gain = gas * where(u_hat >= 0, fill_1 + empty_2, fill_2 + empty_1)
        # if a chamber is above the supply, the gain can change sign: the valve then stays at its limit
        o = u_hat / where(gain > _LEAST_GAIN, gain, _LEAST_GAIN)
        o = clip(o, -Cylinder.opening(u_max), Cylinder.opening(u_max))
        return clip(sin(o) / cos(o) / 2, -u_max, u_max)  # rounding must not exceed the limit, above all in float
