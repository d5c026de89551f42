"""``--part cascade``: the controller of a pneumatic servo as C99, sampled as the simulation samples it."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

from stribeck.constants import Constant
from stribeck.control.cascade import F_HAT, MEASURED, E, PressureCascade, S
from stribeck.control.observer import START, Z_HAT
from stribeck.drives.base import Column, course
from stribeck.errors import InputError, arg
from stribeck.export.c.ccode import WORDS, c_condition, pair, render, statements
from stribeck.export.request import Request, ascii_only, made_by, valued
from stribeck.expressions.graph import Expr, derivative, ordered, symbol, symbols, wrap
from stribeck.expressions.names import Names
from stribeck.laws.base import STATIC_ABOVE_COULOMB
from stribeck.laws.render import equations
from stribeck.machine.system import MachineSystem
from stribeck.plants.cylinder import Cylinder
from stribeck.scenario import Scenario
from stribeck.scenario.cascade import CascadeSettings, cascade_of

PATH = (
    Column("y", "m", "desired position"),
    Column("v", "m/s", "its first derivative"),
    Column("a", "m/s^2", "its second derivative"),
    Column("jerk", "m/s^3", "its third derivative"),
)
INPUTS = (
    Column("y", "m", "position"),
    Column("v", "m/s", "velocity"),
    *(replace(column, meaning=f"absolute {column.meaning}") for column in Cylinder.states),
    Column("acceleration", "m/s^2", "acceleration"),
)
OUTPUTS = (
    replace(Cylinder.takes, meaning="valve voltage, within +-u_max; a positive one fills chamber 1"),
    F_HAT,
    Column("p_d", "Pa", "desired pressure difference p_1 - p_2"),
    E,
    S,
)
_ABOUT = {
    "drive": "gains and limit",
    "model": "the cylinder, as the controller takes it to be",
    "observer": "the friction law",
    "adaptation": "adaptation of the friction law",
    "signal": "the desired path",
}
_EQUATIONS = (
    "e = y - y_d, s = de/dt + lambda e",
    "area p_d = -K_D s + mass (d2y_d/dt2 - lambda de/dt) + F_hat                       (12)",
    "u_hat = -h_hat - (area/rho) s - K_p (p_1 - p_2 - p_d) + dp_d/dt, and u from u_hat (13)",
    "F_hat, dz_hat/dt: the friction law at v and z_hat, with -K sigma_0 s added to the rate (14, 15)",
)


@dataclass(frozen=True)
class ControllerCode:
    """The controller of a request's scenario, and what the templates ask of it."""

    request: Request
    names: Names = field(default_factory=Names, init=False, compare=False)  # of what the equations hold

    @cached_property
    def scenario(self) -> Scenario:
        """The scenario with the controller.

        Raises:
            InputError: there is no scenario, or its drive is no cascade.
        """
        scenario = self.request.scenario
        if scenario is None or cascade_of(scenario) is None:
            given = "" if scenario is None else f"{scenario.name!r}: "
            raise InputError(f"{arg('scenario')}: {given}part 'cascade' needs one with drive.kind = 'cascade'")
        return scenario

    @cached_property
    def settings(self) -> CascadeSettings:
        """What the controller is made of."""
        found = cascade_of(self.scenario)
        assert found is not None
        return found

    @cached_property
    def system(self) -> MachineSystem:
        """The equations, with the controller's constants as parameters whether the scenario is sampled or not."""
        system = self.scenario.system
        return replace(system, drives=(replace(system.drive, drive=self.controller),))

    @cached_property
    def controller(self) -> PressureCascade:
        """The controller's equations."""
        drive = self.settings.drive(self.scenario.drive, self.scenario.drive_values)
        assert isinstance(drive, PressureCascade)
        return replace(drive, sampled=None)

    @property
    def name(self) -> str:
        """The prefix of all names in C."""
        return f"cascade_{self.request.name}" if self.controller.observer else "cascade"

    @property
    def states(self) -> list[tuple[Column, float]]:
        """What is kept from sample to sample, and where it begins."""
        return [(column, START[column.name]) for column in self.controller.remembered]

    @cached_property
    def expressions(self) -> dict[str, Expr]:
        """The controller, the slopes of its states' rates, and the path (``path.y``, ...)."""
        y, v, a, jerk = (symbol(f"path.{column.name}") for column in PATH)
        found = self.controller.measured((y, v, a, jerk), self.names)
        for column in self.controller.remembered:
            found[f"slope.{column.name}"] = derivative(found[f"rate.{column.name}"], symbol(column.name))
        t = symbol("t")
        path = course(wrap(self.system.drive.signal.reference(t).value), t)
        return found | {f"path.{c.name}": wrap(x) for c, x in zip(PATH, path, strict=True)}

    @property
    def computed(self) -> list[tuple[str, str]]:
        """(target in C, expression) of a sample."""
        found = [(f"o->{column.name}", column.name) for column in OUTPUTS]
        found += [(f"rate[{i}]", f"rate.{column.name}") for i, (column, _) in enumerate(self.states)]
        return found + [(f"slope[{i}]", f"slope.{column.name}") for i, (column, _) in enumerate(self.states)]

    @cached_property
    def constants(self) -> dict[str, dict[str, tuple[Constant, float]]]:
        """Declaration and value of each constant that the controller uses, by group and name."""
        values, groups = self.scenario.values(), {path: own for path, (own, _) in self.system.tables.items()}
        used = symbols(self.expressions.values())
        signal = groups.get("signal", {})
        groups["signal"] = {n: replace(c, unit=c.unit.replace("signal", "m")) for n, c in signal.items()}
        if self.pieces:
            groups["signal"] = {}
        found = {
            group: {n: (c, values[group, n]) for n, c in groups.get(group, {}).items() if f"{group}.{n}" in used}
            for group in _ABOUT
        }
        return {group: constants for group, constants in found.items() if constants}

    @property
    def pieces(self) -> list[dict[str, float]]:
        """The constants of the path's pieces, in order of time; none where it is one equation of tunable constants."""
        pieces = self.scenario.signal.pieces
        return [values for _, values in pieces] if len(pieces) > 1 else []

    @property
    def relations(self) -> list[tuple[str, str, str]]:
        """(the constant to blame, what is allowed, the condition in C) between constants of the friction law."""
        law, has = self.settings.observer, self.constants.get("observer", {})
        found = dict.fromkeys((*(law.relations if law else ()), *STATIC_ABOVE_COULOMB))
        return [
            (f"observer_{r.key}", r.allowed, c_condition(r.holds, law, "p->observer."))
            for r in found
            if law is not None and all(need in has for need in r.needs)
        ]

    def uses(self, operation: str) -> bool:
        """True where any expression needs this operation."""
        return any(node.op == operation for node in ordered(self.expressions.values()))

    def lines(self, part: str) -> str:
        """Statements in C: of a ``sample``, or of the ``path``."""
        inputs = {f"{g}.{n}": f"p->{g}.{n}" for g, constants in self.constants.items() for n in constants}
        if part == "path":
            inputs |= {f"segment.{n}": f"pieces[i].{n}" for n in (self.pieces or [{}])[0]} | {"t": "t"}
            wanted = [(f"d->{c.name}", f"path.{c.name}") for c in PATH]
        else:
            inputs |= {f"path.{c.name}": f"d->{c.name}" for c in PATH} | {n: f"m->{n}" for n in MEASURED}
            inputs |= {c.name: f"x->{c.name}" for c, _ in self.states}
            wanted = self.computed
        return statements([(target, self.expressions[name]) for target, name in wanted], inputs, self.names)

    def about(self) -> list[str]:
        """Lines for the header."""
        scenario, c = self.scenario, self.controller
        observer = f"friction observer {c.observer.name}" if c.observer else "no friction compensation"
        adaptive = ", adaptive" if c.adaptive else ""
        lines = [f"{self.name}: cascade controller of a pneumatic servo, {observer}{adaptive}.", ""]
        lines += [f"  {text}" for text in _EQUATIONS[: 4 if c.observer else 3]]
        if c.observer:
            lines += ["", *(f"  {each.text}" for each in equations(c.observer, c.observer_form))]
        lines += ["", "Source: Sobczyk, Perondi, Cunha, section 5, its printing errors put right (docs/servo.md)."]
        lines.append(
            f"Parameters: {self.request.origin or 'scenario ' + scenario.name}; desired path: {scenario.signal.kind}."
        )
        for group, constants in self.constants.items():
            lines += [valued(f"{group}.{n}", x, c) for n, (c, x) in constants.items()]
        return [ascii_only(line) for line in (*lines, made_by())]

    def context(self) -> dict[str, object]:
        """What the templates need."""
        name = self.name
        bad = [n for constants in self.constants.values() for n in constants if n in WORDS or not n.isascii()]
        if bad:
            raise InputError([f"{n}: a constant of this name cannot be exported to C: rename it" for n in bad])
        return {
            "P": name, "cascade": self, "about": self.about(), "groups": _ABOUT, "path": PATH, "inputs": INPUTS,
            "outputs": OUTPUTS, "kept": self.states, "unused": Z_HAT, "period": self.period,
        }  # fmt: skip

    @property
    def period(self) -> float | None:
        """The sample time of the scenario, s."""
        return self.settings.sampling["period"] if self.settings.sampling is not None else None


def files(request: Request) -> dict[str, str | bytes]:
    """``NAME.h`` and ``NAME.c``, and ``NAME_test.c`` where it is wanted."""
    cascade = ControllerCode(request)
    values = cascade.context()
    name = cascade.name
    content: dict[str, str | bytes] = {**pair(name, "cascade", values)}
    if request.self_test:
        from stribeck.export.c.selftest import samples

        content[f"{name}_test.c"] = render("cascade_test.c", **values, rows=samples(cascade))
    return content


def notes(request: Request) -> list[str]:
    """What differs from the scenario at the time step that was given."""
    cascade = ControllerCode(request)
    found, step, sampling = [], request.step, cascade.settings.sampling
    if cascade.period is None:
        found.append(
            "the scenario's controller is continuous, and its proof covers no sampling: "
            "sample_time simulates what is exported"
        )
    elif step is not None and step != cascade.period:
        found.append(f"{arg('step')}: {step:g} s: the scenario simulates drive.sample_time = {cascade.period:g} s")
    if sampling is not None and sampling["bandwidth"]:
        found.append("the filter of drive.bandwidth is not part of the controller: it takes velocity and acceleration")
    return found
