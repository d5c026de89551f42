"""What a command writes, as lines that are kept: numbers are short, long tables are summed up, code is digested."""

import csv
import hashlib
import io
import itertools
import json
import math
import re
import zipfile
from html.parser import HTMLParser

import numpy as np

CODE = (".c", ".h", ".py", ".js", ".v", ".cc", ".xml", ".inc", ".rst")
DECIMAL = re.compile(r"(?<![\w.])\d+\.?\d*(e[-+]?\d+)?(?![\w.])")
WHOLE = False  # whether code and long parts are shown whole
LONGEST_TABLE, LONGEST_LIST, WIDE = 12, 12, 150  # rows, numbers, columns
LONGEST_PART = 6000  # characters of a part of JSON: of longer ones, such as a certificate's proof, the digest is kept


def file(path, data, digits):
    """The lines that stand for a file of this name."""
    end = "." + path.rpartition(".")[2]
    if end in (".fmu", ".zip", ".npz"):
        parts = zipfile.ZipFile(io.BytesIO(data))
        names = [n for n in sorted(parts.namelist()) if not n.endswith("/")]
        return [f"| {line}" for n in names for line in [f"-- {n}", *file(n, parts.read(n), digits)]]
    if end == ".parquet":
        return parquet(data, digits)
    try:
        text = data.decode()
    except UnicodeDecodeError:
        return ["(binary)"]
    if end == ".html":
        return page(text, digits)
    if end in (".json", ".ipynb"):
        return tree(json.loads(text), digits)
    if end == ".svg":
        return re.findall(r"<!--(.*?)-->", text, re.S)[-1:] or ["(drawn)"]
    if end == ".csv":
        head, *rows = csv.reader(line for line in text.splitlines() if not line.startswith("#"))
        notes = [line for line in text.splitlines() if line.startswith("#")]
        return notes + columns(head, list(itertools.zip_longest(*rows, fillvalue="")), digits)
    if path.endswith("modelDescription.xml"):
        return text.splitlines()
    return digest(text) if end in CODE else [DECIMAL.sub(lambda m: short(m[0], digits), x) for x in text.splitlines()]


def digest(text):
    """A line for each paragraph of code: its digest, how many lines, and the first; numbers to nine digits."""
    if WHOLE:
        return text.splitlines()
    rounded = DECIMAL.sub(lambda m: short(m[0], 9), text)
    blocks = [block for block in re.split(r"\n\s*\n", rounded) if block.strip()]
    sums = [hashlib.sha256(block.encode()).hexdigest()[:8] for block in blocks]
    firsts = [next(line.strip() for line in block.splitlines() if line.strip())[:70] for block in blocks]
    return [f"{s} {len(b.splitlines()):4} {first}" for s, b, first in zip(sums, blocks, firsts, strict=True)]


def short(number, digits):
    """A number that a text holds, with so many digits at most; whole numbers as they are."""
    if (
        re.fullmatch(r"[-+]?\d+", number)
        or digits is None
        or len(re.sub(r"\D", "", number.partition("e")[0])) <= digits
    ):
        return number
    return f"{float(number):.{digits}g}"


def tree(data, digits, depth=0):
    """JSON with short numbers, each part on one line where it is short, and long lists of numbers summed up."""
    lines, indent = [], " " * depth
    for i, (key, value) in enumerate(data.items() if isinstance(data, dict) else enumerate(data)):
        name = f"{indent}{key}: " if isinstance(data, dict) else f"{indent}{i}: "
        if isinstance(value, dict) and "root_id" in value:
            value = "a figure of Bokeh"  # its names count what was made before, and depend on its release
        if isinstance(value, list) and len(value) > LONGEST_LIST and all(isinstance(x, int | float) for x in value):
            lines.append(name + summed(value, digits))
            continue
        flat = json.dumps(rounded(value, digits), ensure_ascii=False)
        if len(flat) > LONGEST_PART and depth >= 2 and not WHOLE:
            lines.append(f"{name}{len(flat)} characters {hashlib.sha256(flat.encode()).hexdigest()[:8]}")
            continue
        if len(name + flat) <= WIDE or not isinstance(value, dict | list) or not value:
            lines.append(name + flat)
        else:
            lines += [name.rstrip(), *tree(value, digits, depth + 1)]
    return lines


def rounded(value, digits):
    if isinstance(value, dict):
        return {key: rounded(x, digits) for key, x in value.items()}
    if isinstance(value, list):
        return [rounded(x, digits) for x in value]
    return float(f"{value:.{digits}g}") if isinstance(value, float) and digits and math.isfinite(value) else value


def summed(values, digits=None):
    """Many numbers in one line."""
    x = np.asarray(values, float)
    finite = x[np.isfinite(x)]
    if not len(finite):
        return f"{len(x)} numbers, none finite"
    first, last, low, high, mean = (
        f"{v:.{digits or 12}g}" for v in (finite[0], finite[-1], finite.min(), finite.max(), finite.mean())
    )
    return f"{len(x)} numbers: {first} .. {last}, from {low} to {high}, mean {mean}"


def columns(head, values, digits):
    """A table: its rows, or where there are many the sum of each column."""
    if values and len(values[0]) > LONGEST_TABLE:
        lines = []
        for name, column in zip(head, values, strict=True):
            try:
                lines.append(f"{name}: {summed([float(x or 'nan') for x in column], digits)}")
            except ValueError:
                lines.append(f"{name}: {len(column)} texts: {column[0]} .. {column[-1]}")
        return lines
    rows = [
        [short(str(x), digits) if re.match(r"[-+]?\d", str(x)) else str(x) for x in row]
        for row in zip(*values, strict=True)
    ]
    return [" | ".join(row) for row in [head, *rows]]


def parquet(data, digits):
    import pyarrow.parquet as pq

    table = pq.read_table(io.BytesIO(data))
    units = ((field.metadata or {}).get(b"unit", b"").decode() for field in table.schema)
    named = zip(table.column_names, table.schema.types, units, strict=True)
    return [f"{n} ({kind}) {unit}".rstrip() for n, kind, unit in named] + columns(
        table.column_names, [column.to_pylist() for column in table.columns], digits
    )


SKIPPED = ("style", "script", "svg", "pre")  # what a page prints as code stands in a file too


class _Page(HTMLParser):
    """A page's text, a line for each paragraph and row; scripts that hold data as their lines."""

    def __init__(self, digits):
        super().__init__()
        self.lines, self.words, self.skip, self.data, self.digits = [], "", 0, False, digits

    def end(self, mark=""):
        if text := " ".join(self.words.split()):
            self.lines.append(mark + text)
        self.words = ""

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        self.data = tag == "script" and given.get("type") == "application/json" and given.get("id") == "data"
        self.skip += tag in SKIPPED and not self.data
        if tag in ("p", "tr", "h1", "h2", "h3", "li", "div", "figure", "table", "section", "label", "button", "br"):
            self.end()
        if tag in ("input", "section", "select", "option"):
            self.words += f" <{tag} " + " ".join(f"{k}={v}" for k, v in given.items() if k != "class") + "> "

    def handle_endtag(self, tag):
        if tag == "script" and self.data:
            self.data = False
            return
        self.skip -= tag in SKIPPED
        if tag in ("td", "th"):
            self.words += " | "
        elif tag in ("p", "tr", "h1", "h2", "h3", "li", "figcaption", "div", "button", "label"):
            self.end("# " if tag in ("h1", "h2", "h3") else "")

    def handle_comment(self, text):
        if text.startswith("figure"):
            self.end()
            self.lines += text.splitlines()

    def handle_data(self, text):
        if self.data:
            self.lines += tree(json.loads(text), self.digits)
        elif not self.skip:
            self.words += text


def page(text, digits):
    reader = _Page(digits)
    reader.feed(text.replace("<wbr>", ""))
    reader.end()
    elsewhere = re.findall(r'(?:src|href)="(?!#)([^"]+)"|url\((?!#)([^)]+)\)|@import', text)
    ids = re.findall(r'\bid="([^"]+)"', text)
    return reader.lines + [f"from elsewhere: {x}" for x in elsewhere] + ["one id twice"] * (len(ids) > len(set(ids)))


def figure(drawn):
    """What a figure of Matplotlib shows, without drawing it: axes, labels, and the ends of its curves."""
    lines = ["figure"]
    for axis in drawn.axes:
        lines.append(f"  axis: {axis.get_title(loc='left')}; {axis.get_xlabel()} ({axis.get_xscale()}); "
                     f"{axis.get_ylabel()} ({axis.get_yscale()})")  # fmt: skip
        for line in axis.lines:
            x, y = (np.asarray(v, float) for v in line.get_data())
            seen = np.isfinite(x) & np.isfinite(y)
            x, y = x[seen], y[seen]
            ends = ", ".join(f"{v:.4g}" for v in (x[0], x[-1], y[0], y[-1], y.min(), y.max())) if len(x) else "nothing"
            lines.append(f"    line {line.get_label() if line.get_label()[:1] != '_' else ''}: {ends}")
        lines += [f"    text {t.get_text()}" for t in axis.texts]
        lines += [f"    {len(axis.collections)} areas, {len(axis.patches)} patches"] * bool(
            axis.collections or axis.patches
        )
        if (legend := axis.get_legend()) is not None:
            lines.append("    legend " + ", ".join(t.get_text() for t in legend.get_texts()))
    return lines
