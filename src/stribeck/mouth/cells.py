"""Numbers as text: the only place where a value of a document becomes words."""

from __future__ import annotations

import math

from stribeck.errors import unbroken
from stribeck.mouth.document import Amount, Cell, Ends, Head, Share, Table, Uncertain

_PREFIXES = ((1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"), (1e-12, "p"))
_NOT_ABOVE_ONE = ("m", "s", "rad", "V")  # nobody reads kilometers, kiloseconds or kiloradians off a plot
_PREFIXED = (*_NOT_ABOVE_ONE, "N", "Pa", "J", "W", "A", "Hz")
_EXACT = 1e-12  # relative: what a factor of a unit or of percent leaves of a number that was short
_LEAST = 0.5  # what the largest number of an axis is at least, in its unit


def prefixed(unit: str, largest: float) -> tuple[float, str]:
    """The factor and the unit in which numbers up to ``largest`` are short: mm for what is below half a meter."""
    base = unit.partition("/")[0].partition(" ")[0].partition("^")[0]
    if base not in _PREFIXED or not 0 < largest < math.inf:
        return 1.0, unit
    top = 1.0 if base in _NOT_ABOVE_ONE else _PREFIXES[0][0]
    fitting = [(factor, name) for factor, name in _PREFIXES if factor <= top]
    factor, name = next(((f, n) for f, n in fitting if largest >= _LEAST * f), fitting[-1])
    return factor, name + unit


def human(x: float, unit: str, count: int = 3) -> str:
    """A number of so many digits in a unit that keeps it short: ``0.0642`` m is ``64.2 mm``."""
    factor, name = prefixed(unit, abs(x))
    return f"{significant(x / factor, count)} {name}".rstrip()


def significant(x: float, count: int) -> str:
    """A number with so many digits, zeros at the end too: ``4.10`` for 4.0997. One that is exact is short: ``4.1``."""
    short = f"{x:.{count}g}"
    if math.isfinite(x) and not math.isclose(float(short), x, rel_tol=_EXACT):
        short = f"{x:#.{count}g}".replace(".e", "e").removesuffix(".")
    return _plain(short)


def _plain(text: str) -> str:
    """A number without a power of ten that seven digits do not need: 4460 rather than 4.46e+03."""
    return f"{float(text):.7g}" if "e+" in text else text


def in_prefix(unit: str, first: float, *others: float) -> tuple[float | str, ...]:
    """Numbers in the prefix that keeps the first one short, and the unit with it: the end of a row."""
    factor, name = prefixed(unit, abs(first))
    return (*(x / factor for x in (first, *others)), name or "1")


def digits(x: float | None, count: int = 6) -> str:
    """A number with so many digits; ``-`` where there is none."""
    return "-" if x is None or math.isnan(x) else _plain(f"{x:.{count}g}")


def rounded_up(x: float) -> str:
    """Four digits, rounded up: for what must be at least so large."""
    if not x:
        return "0"
    unit = 10.0 ** (math.floor(math.log10(x)) - 3)
    return f"{math.ceil(x / unit * (1 - 1e-12)) * unit:.4g}"  # 1e-12: the rounding of x / unit itself


def percent(share: float | None) -> str:
    """A share as a percentage with three digits."""
    return "-" if share is None or not math.isfinite(share) else f"{significant(100 * share, 3)} %"


def _in_places(x: float, size: float) -> str:
    """A number with the places that two digits of ``size`` have."""
    if not math.isfinite(x) or not size:
        return f"{x:.4g}"
    places = 1 - math.floor(math.log10(size))
    near = round(x, places) + 0.0  # without the sign of a zero
    text = f"{near:.7g}"
    if "e" in text:
        return f"{x:.{max(math.floor(math.log10(abs(x))) + places, 0)}e}"
    return f"{near:.{places}f}" if places >= 0 else text


def _half(value: float, interval: tuple[float, ...]) -> float:
    """The half width of an interval about a value, on its shorter side; 0 where it has none but rounding."""
    return min((abs(value - x) for x in interval if math.isfinite(x) and not math.isclose(x, value)), default=0.0)


def _interval(cell: Ends) -> str:
    """An interval: of one that is open at an end the bound that is left.

    Each end has the places of its own distance from the value, so that 323 has no four zeros beside 0.0003.
    """
    if cell.ends is None:
        return "-"
    sizes = (min(abs(x) or math.inf, _half(cell.value, (x,)) or _half(cell.value, cell.ends)) for x in cell.ends)
    low, high = (None if math.isinf(x) else _in_places(x, size) for x, size in zip(cell.ends, sizes, strict=True))
    if low is None or high is None:
        return f"> {low}" if low is not None else f"< {high}" if high is not None else "open"
    return f"{low} ... {high}"


def text(cell: Cell, count: int = 6) -> str:
    """The text of a cell, on one line; a plain number has so many digits."""
    return unbroken(_raw(cell, count))


def _raw(cell: Cell, count: int) -> str:
    if isinstance(cell, Amount):
        return "-" if cell.value is None or math.isnan(cell.value) else human(cell.value, cell.unit, cell.digits)
    if isinstance(cell, Share):
        return percent(cell.value)
    if isinstance(cell, Uncertain):
        return f"{'~' if cell.doubtful else ''}{_in_places(cell.value, _half(cell.value, cell.interval))}"
    if isinstance(cell, Ends):
        return _interval(cell)
    if isinstance(cell, str | int):
        return str(cell)
    return digits(cell, count=count)


def texts(table: Table, where: str) -> tuple[list[str], list[list[str]], list[bool]]:
    """The titles and rows that a table shows in a place, as text, and which columns hold words and stand to the left."""
    given = [c if isinstance(c, Head) else Head(c) for c in table.columns]
    shown = [i for i, column in enumerate(given) if where in column.on]
    rows = [[text(row[i], given[i].digits) for i in shown if i < len(row)] for row in table.rows]
    words = [any(not _is_number(row[i]) for row in table.rows if i < len(row)) for i in shown]
    return [unbroken(given[i].title) for i in shown], rows, words


def _is_number(cell: Cell) -> bool:
    """Whether a cell stands to the right: a number, nothing, or text that begins as one and has no words."""
    if not isinstance(cell, str):
        return True
    head = cell.removesuffix("%").strip().lstrip("+-~\N{MINUS SIGN}")
    return head in ("", "open", "given", "any", "nan", "inf") or (head[0].isdigit() and " " not in head)
