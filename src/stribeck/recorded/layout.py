"""Detection of a text file's table: encoding, first line, head, separator, units and marks of thousands."""

from __future__ import annotations

import csv
import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import numpy as np

from stribeck.arrays import Array
from stribeck.recorded.units import si_unit

MISSING = (  # cells without a number, as pyarrow reads them by default; spreadsheets and instruments write them
    "", "#N/A", "#N/A N/A", "#NA", "-1.#IND", "-1.#QNAN", "-NaN", "-nan", "1.#IND", "1.#QNAN", "N/A", "NA", "NULL", "NaN",
    "n/a", "nan", "null",
)  # fmt: skip
_NUMBER = re.compile(r"[+-]?((\d+\.?\d*|\.\d+)(e[+-]?\d+)?|inf|infinity|nan)", re.ASCII | re.IGNORECASE)
_THOUSANDS = re.compile(r"[+-]?\d{1,3}(,\d{3})+(\.\d*)?", re.ASCII)
_LONGEST_PREAMBLE = 200  # lines before the head of a text file: settings of instruments have at most some dozens


def encoding_of(path: Path) -> str:
    """The encoding of a file: UTF-16 by its mark, UTF-8 if its beginning is valid, otherwise Latin-1 (old spreadsheets)."""
    with path.open("rb") as file:
        start = file.read(1 << 16)
    if start.startswith((b"\xff\xfe", b"\xfe\xff")):
        return "utf-16"
    try:
        start.decode("utf-8")
    except UnicodeDecodeError as error:
        return "utf-8-sig" if error.start > len(start) - 4 else "latin-1"
    return "utf-8-sig"


def split_cells(line: str, separator: str) -> list[str]:
    """The cells of a line, without quotation marks around them."""
    return next(csv.reader([line], delimiter=separator), [""])


def is_thousands(cell: str, separator: str) -> bool:
    """Whether a cell is a number whose thousands a comma marks, as in a quoted "1,000" between commas."""
    return separator == "," and _THOUSANDS.fullmatch(cell) is not None


def number(cell: str, decimal: str) -> float:
    """The number of a cell, nan if it is missing: what pyarrow reads, and not all that Python's float does (1_000).

    Raises:
        ValueError: the cell holds something else.
    """
    if cell in MISSING:
        return math.nan
    text = cell.strip(" \t")
    text = text.translate({ord(","): ".", ord("."): ","}) if decimal == "," else text
    if not _NUMBER.fullmatch(text):
        raise ValueError(cell)
    return float(text)


def table_begins(lines: Sequence[str]) -> tuple[int, bool, str]:
    """The first line of the table, whether that is its head, and the separator.

    Instruments write titles, dates and settings first. The table begins with the first lines of numbers that have equally
    many cells, or with the head above them. Lines between words and these rows that hold numbers in another count are rows
    with a fault. ``lines`` are those that hold something (:func:`is_blank`).
    """
    for i, line in enumerate(lines[:_LONGEST_PREAMBLE]):
        separator = _separator(line)
        cells = split_cells(line, separator)
        if not _is_row(cells):
            continue
        below = lines[i + 1 : i + 3]
        if any(len(split_cells(other, separator)) != len(cells) for other in below):
            continue
        if below and _are_words(split_cells(below[0], separator)):
            continue  # the names, below a title of numbers
        rows = [cells, *(split_cells(other, separator) for other in below)]
        counts = {len(cells), len(cells) - (not any(row[-1].strip() for row in rows))}  # rows may end in a separator
        first = _below_words(lines, i, separator)
        heads = [j for j in range(first - 1, max(first - 3, -1), -1) if len(split_cells(lines[j], separator)) in counts]
        if len(heads) == 2 and _names_and_units(lines[first - 2], lines[first - 1], separator):
            return first - 2, True, separator
        if heads and heads[0] == first - 1:
            head = _above_bad_rows(lines, first - 1, separator, len(split_cells(lines[first - 1], separator)))
            return head, True, separator
        while i and _is_row(above := split_cells(lines[i - 1], separator)) and len(above) > 1:
            i -= 1  # several numbers are no title, but a row with a fault
        return i, False, separator
    separator = _separator(lines[0])
    return 0, not all(_is_number(cell) for cell in split_cells(lines[0], separator)), separator


def commas_twice(lines: Sequence[str], first: int) -> bool:
    """Whether rows from the line ``first`` on have two cells for each name, the effect of decimal commas."""
    names, row = (len(line.split(",")) for line in (lines[first - 1], lines[first]))
    return names > 1 and row == 2 * names and "." not in lines[first]


# A mark before exactly three digits, such as that of 1,004 or 1.004, may be that of decimals or of thousands. It is that of
# decimals if the mark stands otherwise anywhere in the file, as in 0,004 or 1,5: one program writes one decimal mark. In a
# column, a whole number of a thousand or more without a mark shows the same of that column.
_GROUPED = re.compile(r"[+-]?[1-9]\d{0,2}\.\d{3}", re.ASCII)


def decimals_shown(x: Array) -> bool:
    """Whether numbers of a column show that the mark in its cells is that of decimals."""
    x = abs(x[np.isfinite(x)])
    x = x[x != np.rint(x)]
    return bool(np.any((x < 1) | (x > 1000) | (abs(1e3 * x - np.rint(1e3 * x)) > 1e-6)))


def thousands_without_mark(x: Array) -> bool:
    """Whether a column has a whole number of a thousand or more: its cell has no mark."""
    x = abs(x[np.isfinite(x)])
    return bool(np.any(x >= 1000))


def mark_of(cell: str, decimal: str) -> Literal["either", "decimals", "none"]:
    """The role of the assumed decimal mark in a cell: either, decimals or none."""
    text = cell.strip()
    if decimal not in text:
        return "none"
    text = text.replace(decimal, ".", 1)
    return "either" if _GROUPED.fullmatch(text) else "decimals" if _NUMBER.fullmatch(text) else "none"


def is_blank(line: str) -> bool:
    """Whether a line holds nothing, or separators alone: no name and no unit."""
    return not line.strip("\t;, \r\n")


def _is_row(cells: Sequence[str]) -> bool:
    """Whether cells are numbers or empty, and not all empty."""
    return all(_is_number(c) or not c.strip() for c in cells) and any(map(_is_number, cells))


def _below_words(lines: Sequence[str], row: int, separator: str) -> int:
    """The first of the rows of any width up to ``row``, if words are directly above it; otherwise ``row``."""
    first = row
    while first and _is_row(split_cells(lines[first - 1], separator)):
        first -= 1
    return first if first and _are_words(split_cells(lines[first - 1], separator)) else row


def _above_bad_rows(lines: Sequence[str], head: int, separator: str, count: int) -> int:
    """The line of the names, if the supposed head contains numbers and a line of words is above it.

    The supposed head is then a row with an invalid cell.
    """
    for j in range(head, -1, -1):
        cells = split_cells(lines[j], separator)
        if len(cells) != count:
            break
        if not any(map(_is_number, cells)):
            return j
    return head


def _separator(line: str) -> str:
    """The separator of a line: tab or semicolon, otherwise a comma, which may also be the decimal mark."""
    return next((s for s in "\t;" if s in line), ",")


def is_units(line: str, separator: str, count: int) -> bool:
    """Whether a line below the names contains their units: short words other than numbers, such as s, mm, [N]."""
    cells = [cell.strip().strip('"') for cell in split_cells(line, separator)]
    return len(cells) == count and any(cells) and all(len(c) <= 8 and not _is_number(c) for c in cells)


def _names_and_units(above: str, below: str, separator: str) -> bool:
    """Whether of two lines above the rows the first holds the names and the second their units.

    A line with a number is more often a title than one of names: the line below then holds known units, or is the names.
    """
    names, words = split_cells(above, separator), split_cells(below, separator)
    known = all(not word.strip() or si_unit(word.strip('"[]() ')) for word in words)
    return is_units(below, separator, len(names)) and (known or not any(map(_is_number, names)))


def _are_words(cells: Sequence[str]) -> bool:
    """Whether each cell holds something that is neither a number nor a mark of a missing one."""
    return all(cell.strip() not in MISSING and not _is_number(cell) for cell in cells)


def _is_number(text: str) -> bool:
    try:
        float(text.replace(",", "."))
    except ValueError:
        return False
    return True
