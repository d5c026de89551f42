"""Springs and dampers between bodies."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from pydantic import BeforeValidator, Field

from stribeck.constants import Column, kind_of, show
from stribeck.expressions.graph import Expr, wrap
from stribeck.expressions.ops import Value, clip, sign, where
from stribeck.machine.element import GROUND, NONE, BetweenBodies, BodyOrGround, FarEnd, Own, force_unit, ratio_constant
from stribeck.machine.equations import Events
from stribeck.machine.signal import SignalTable
from stribeck.machine.table import Problem, Refers, quantity, refused

if TYPE_CHECKING:
    from stribeck.machine.assembly import Assembly
    from stribeck.machine.machine import Elements

FLANKS: Events = ("flank_up", "flank_up_left", "flank_down", "flank_down_left")


def _start(value: object, info: object) -> object:
    if isinstance(value, SignalTable):
        return FarEnd(signal=value)
    if isinstance(value, dict):
        return FarEnd.model_validate(value, context=getattr(info, "context", None))
    if not isinstance(value, str | FarEnd):
        raise refused(f"must be a body's name, or a table with the signal of a far end, not {kind_of(value)}", value)
    return value


class Link(BetweenBodies, family=True):
    """A spring and damper, with backlash between two flanks if ``gap`` is given.

    A link of your own derives from this class, declares its constants, and overrides ``force`` and ``stored_energy``
    (and ``rates``, with ``states``). What it dissipates follows.
    """

    section, plain = "links", "link"
    kind: str = "link"
    start: Annotated[str | FarEnd, Refers(("bodies",)), BeforeValidator(_start)] = Field(
        alias="from", description="a body, or { signal = ... }, the position of a far end"
    )
    end: BodyOrGround = Field(GROUND, alias="to", description="a body, or 'ground'")
    stiffness: float = quantity("N/m", "stiffness", at_least=0, rotary_unit="N m/rad")
    damping: float | None = quantity(
        "N s/m", "damping; 0 unless given", at_least=0, off_at_zero=True, rotary_unit="N m s/rad"
    )
    gap: float | None = quantity("m", "total backlash; 0 unless given", at_least=0, off_at_zero=True, rotary_unit="rad")
    ratio: float | None = ratio_constant(
        "factor of the motion of `from`, d = ratio y_from - y_to: stiffness, damping and gap refer to `to`; 1 unless given"
    )

    def wrong(self) -> list[Problem]:
        """A far end that nothing is tied to."""
        text = "must be a body, as a far end is the other side"
        return [("to", f"{show(self.end)}: {text}")] if self.far is not None and self.end == GROUND else []

    def stretch(self, d: Value) -> Value:
        """The elongation of the spring: d minus the backlash."""
        return d if self.gap is None else d - clip(d, -self.gap / 2, self.gap / 2)

    def elastic(self, d: Value) -> Value:
        """The force of the spring alone."""
        return self.stiffness * self.stretch(d)

    def force(self, d: Value, w: Value, x: Own = NONE) -> Value:
        """The force f, which acts as -ratio f on `from` and as f on `to`.

        Backlash is modeled as in Modelica's ElastoBacklash: the damper acts in contact only and never pulls.
        """
        f_c = self.elastic(d)
        if self.damping is None:
            return f_c
        if self.gap is None:
            return f_c + self.damping * w
        f_d = self.damping * w  # limited to |f_c|; within the backlash both are 0, and so is the derivative by w
        return f_c + where(abs(f_d) < abs(f_c), f_d, sign(w) * abs(f_c))

    def rates(self, d: Value, w: Value, x: Own) -> Own:
        """The time derivatives of its own states."""
        return NONE

    def stored_energy(self, d: Value, x: Own = NONE) -> Value:
        """The spring's energy, J."""
        return self.stiffness * self.stretch(d) ** 2 / 2

    def equations(self, a: Assembly) -> None:
        """Act on both ends; what is not stored is dissipated."""
        d, w, ratio = a.along(self)
        x = {s.name: a.state(self, s.name) for s in self.states}
        f = a.show(self.name_of("f"), self.force(d, w, x))
        if self.far is not None and a.system.unnamed:  # a file of schema 1 ends at its body: into that work is put
            a.k[self.name_of("x")] = wrap(a.reference(self.far).value)
            a.push(self.end, f)
            a.power_in = a.power_in + f * a.motion(self.end)[1]
            return
        rates = {n: wrap(rate) for n, rate in self.rates(d, w, x).items()}
        a.rates |= {self.name_of(n): rate for n, rate in rates.items()}
        a.act(self, ratio, f)
        a.account(lambda d: self.stored_energy(d, x), d, w, f, {x[n]: rate for n, rate in rates.items()}, self.far)

    def watches(self, a: Assembly) -> tuple[Events, Expr] | None:
        """The flanks of the backlash."""
        return None if self.gap is None else (FLANKS, a.along(self)[0])

    def level(self) -> Value:
        """Half of the backlash."""
        return None if self.gap is None else self.gap / 2

    def columns(self, m: Elements) -> list[Column]:
        """Its force."""
        return [Column(self.name_of("f"), force_unit(self.turning(m)), "force of the link")]

    def heading(self, m: Elements) -> str:
        """See :class:`Element`."""
        return f"Link {self.name}: {self.between()}."
