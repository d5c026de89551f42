"""The solution of a scenario: its columns, events, statistics and status."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from stribeck.arrays import Array
from stribeck.constants import Column
from stribeck.errors import needed, printable
from stribeck.laws.base import Law
from stribeck.scenario import Scenario
from stribeck.simulation.result import Result, unknown_column

if TYPE_CHECKING:
    import pandas
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from stribeck.mouth.document import Document


class Solution:
    """A simulated scenario.

    ``solution.t`` holds the times in s and ``solution["y"]`` a column as an array of the same length. The columns are
    ``y``, ``v``, ``z``, ``F`` and those of the drive and of the output options (:attr:`columns`).

    Attributes:
        scenario: the simulated scenario.
        status: ``"done"``, or ``"failed"``; the rows up to a failure are kept.
        reason: why it failed, else None.
        events: ``{"slip": times, "stick": times}`` in s: \\|v\\| rises, or falls, through v_s.
        states: the states at the rows, an array (rows, states) in the order of ``scenario.system.states``.
        held: outputs and shown memory of sampled controllers at the rows, by name.
        stats: accepted and rejected steps, evaluations, the solver, and the seconds of solving and building.
    """

    def __init__(self, scenario: Scenario, result: Result) -> None:
        self.scenario = scenario
        self.reason = result.reason
        self.status = "done" if result.reason is None else "failed"
        self.stats, self._remarks = result.stats, result.remarks
        count = len(scenario.system.states)
        self.states, names = result.states[:, :count], (*scenario.system.held, *scenario.system.shown)
        self.held: dict[str, Array] = dict(zip(names, result.states[:, count:].T, strict=True))
        self.events = _events(scenario, result.events)
        self.counts = np.zeros((len(scenario.system.watched), 4), np.int64)  # of each event
        for _, what in result.events:
            self.counts[what >> 2, what & 3] += 1

    @cached_property
    def t(self) -> Array:
        """Times of the rows (s), multiples of ``output.step``."""
        return np.arange(len(self.states), dtype=float) * self.scenario.output.step

    @cached_property
    def columns(self) -> tuple[Column, ...]:
        """The columns after t, each with name, unit and meaning."""
        return self.scenario.system.columns

    @cached_property
    def _columns(self) -> dict[str, Array]:
        states = {state.name: self.states[:, i] for i, state in enumerate(self.scenario.system.states)}
        with np.errstate(all="ignore"):
            values = self.scenario.columns(self.t, states, self.held)
        rows = (np.broadcast_to(np.asarray(values[c.name], float), self.t.shape) for c in self.columns)
        return {column.name: np.array(x) for column, x in zip(self.columns, rows, strict=True)}

    def __getitem__(self, name: str) -> Array:
        if name == "t":
            return self.t
        if name not in self._columns:
            raise unknown_column(name, ["t", *self._columns])
        return self._columns[name]

    def __contains__(self, name: object) -> bool:
        return name in self.keys()

    def __iter__(self) -> Iterator[str]:
        return iter(self.keys())

    def keys(self) -> tuple[str, ...]:
        """The names of the columns, t first: ``dict(solution)`` holds the arrays by name."""
        return ("t", *(column.name for column in self.columns))

    @property
    def success(self) -> bool:
        """Whether the run reached its end."""
        return self.reason is None

    @property
    def inaccurate(self) -> bool:
        """Whether the run reached its end, but not the promised accuracy."""
        return self.success and bool(self._remarks)

    @property
    def message(self) -> str:
        """Why the run failed, or the promised accuracy that it did not reach; otherwise that it is done."""
        return self.reason or "; ".join(self._remarks) or f"done: t = {self.scenario.end:g} s reached"

    def __repr__(self) -> str:
        columns = ", ".join(self.keys())
        return f"<Solution of '{self.scenario.name}': {self.status}, {len(self.t)} rows, columns {columns}>"

    def plot(self, column: str | None = None, ax: Axes | None = None) -> Figure:
        """A matplotlib figure: all panels, or one column over time.

        Args:
            column: the column; with ``ax`` the first one unless given.
            ax: the axes to draw into; new ones unless given.
        """
        from stribeck.simulation import drawing

        if column is None and ax is None:
            return drawing.figure_of({self.scenario.label: self})
        if ax is None:
            from matplotlib.figure import Figure as NewFigure

            ax = NewFigure(layout="constrained").subplots()
        drawing.curves(ax, {self.scenario.label: self}, "t", column or self.columns[0].name)
        figure = ax.get_figure(root=True)
        assert figure is not None
        return figure

    def _repr_html_(self) -> str:
        from stribeck.mouth import plots
        from stribeck.simulation import drawing

        with plots.style():
            svg = plots.svg(drawing.figure_of({self.scenario.label: self}))
        return f"<p>{escape(printable(repr(self)))}<br>{escape(printable(self.message))}</p>{svg[svg.index('<svg') :]}"

    def document(self) -> Document:
        """The run as a document, for the terminal and for a page."""
        from stribeck.simulation import said

        return said.run(self)

    def to_pandas(self) -> pandas.DataFrame:
        """The columns as a pandas data frame, t first.

        Raises:
            MissingExtra: if pandas is not installed.
        """
        with needed("to_pandas()"):
            import pandas

        return pandas.DataFrame({"t": self.t, **self._columns})

    @property
    def peaks(self) -> dict[str, float]:
        """The largest magnitude of each column over the rows."""
        return {c.name: float(np.max(np.abs(self[c.name]), initial=0.0)) for c in self.columns}

    @property
    def final(self) -> dict[str, float]:
        """The last row."""
        return {name: float(self[name][-1]) for name in ("t", *self._columns)} if len(self.t) else {}

    @property
    def laws(self) -> dict[str, object]:
        """The law with its constants (``law``), or of a machine that of each contact (``contacts``)."""
        machine = self.scenario.elements
        if machine.unnamed:
            return {"law": _law_entry(self.scenario.law)}
        named = {name: machine.laws[contact.law_path] for name, contact in machine.contacts.items()}
        return {"contacts": {name: {"law": _law_entry(law)} for name, law in named.items()}}

    def summary(self) -> dict[str, object]:
        """The JSON of ``stribeck run --json``, without the files."""
        return {
            "status": self.status,
            "reason": self.reason,
            "scenario": self.scenario.name,
            **self.laws,
            "rows": len(self.t),
            "steps": self.stats,
            "events": _as_lists(self.events),
            "peaks": self.peaks,
            "final": self.final,
        }


def _law_entry(law: Law) -> dict[str, object]:
    return {"name": law.name, "constants": {**law.values, **law.choices}}


def _as_lists(events: Mapping[str, Any]) -> dict[str, object]:
    return {name: _as_lists(x) if isinstance(x, dict) else x.tolist() for name, x in events.items()}


def _events(scenario: Scenario, instants: list[tuple[float, int]]) -> dict[str, Any]:
    """The times of the events; of a machine by element, of a single body without its name."""
    watched = scenario.system.watched
    if scenario.elements.unnamed:
        times = {"slip": [t for t, what in instants if not what & 1], "stick": [t for t, what in instants if what & 1]}
        return {name: np.array(each) for name, each in times.items()}
    events: dict[str, dict[str, list[float]]] = {name: {kind: [] for kind in kinds} for name, kinds in watched}
    for t, what in sorted(instants):
        name, kinds = watched[what >> 2]
        events[name][kinds[what & 3]].append(t)
    return {name: {kind: np.array(x) for kind, x in each.items()} for name, each in events.items()}
