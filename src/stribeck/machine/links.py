"""Springs and dampers between bodies."""

from __future__ import annotations

from types import SimpleNamespace

from stribeck.constants import Constant
from stribeck.expressions.ops import Value, clip
from stribeck.machine.element import Element

Own = tuple[Value, ...]


class LinkElement(Element):
    """A spring and damper, with play between two flanks if ``gap`` is given.

    A link of one's own is derived from this class, declares its constants, and overrides ``force`` and
    ``stored_energy`` (and ``rates``, with ``states``). What it dissipates follows.
    """

    kind = "link"
    stiffness = Constant("N/m", "stiffness, on the side of `to`", at_least=0, rotary_unit="N m/rad")
    damping = Constant("N s/m", "damping", at_least=0, optional=True, rotary_unit="N m s/rad")
    gap = Constant("m", "total play", at_least=0, optional=True, rotary_unit="rad")

    @staticmethod
    def stretch(p: SimpleNamespace, d: Value) -> Value:
        """What the spring is stretched by: d, less the play."""
        return d if p.gap is None else d - clip(d, -p.gap / 2, p.gap / 2)

    @classmethod
    def force(cls, p: SimpleNamespace, d: Value, w: Value, x: Own = ()) -> Value:
        """The force f: it acts as -ratio f on `from` and as f on `to`; with play as Modelica's ElastoBacklash, whose
        damper acts in contact only and never pulls."""
        f_c = p.stiffness * cls.stretch(p, d)
        if p.damping is None:
            return f_c
        if p.gap is None:
            return f_c + p.damping * w
        return f_c + clip(p.damping * w, -abs(f_c), abs(f_c))

    @classmethod
    def stored_energy(cls, p: SimpleNamespace, d: Value, x: Own = ()) -> Value:
        """The spring's energy, J."""
        return p.stiffness * cls.stretch(p, d) ** 2 / 2


Link = LinkElement  # its first name, which elements of users may import
