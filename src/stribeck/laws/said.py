"""What a law says of itself: its equations, its constants, its source."""

from __future__ import annotations

from stribeck.constants import rotary_words
from stribeck.laws.base import Law
from stribeck.laws.render import equations
from stribeck.mouth.document import PAGE, Chapter, Table


def chapter(law: Law, key: str = "law", of: str = "") -> Chapter:
    """A law: its equations and its constants; ``of``: words for where it acts."""
    declared = law.constants()
    words = rotary_words if law.rotary else str
    rows = [
        (n, f"{x:g}" if isinstance(x, float) else str(x), declared[n].unit_for(law.rotary) or "1", words(declared[n].meaning))
        for n, x in (law.p.numbers | law.p.words).items()
    ]  # fmt: skip
    about = " ".join((type(law).__doc__ or "").split())
    return Chapter(
        key,
        f"The law{of}: {law.name}" if of else f"The law {law.name}",
        [about, f"Source: {law.source}."],
        [Table(["constant", "value", "unit", "meaning"], rows, prose=True)],
        code="\n".join(each.text for each in equations(type(law), law.form)),
        on=PAGE,
    )
