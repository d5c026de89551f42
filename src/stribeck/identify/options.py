"""Options of a fit, as one object for the library and the command."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

from stribeck import laws
from stribeck.constants import show
from stribeck.errors import InputError, arg, nearest
from stribeck.identify.actuator.recordings import Sought, sought_of
from stribeck.identify.data.quality import LARGEST
from stribeck.identify.models.curves import LAWS
from stribeck.identify.models.terms import TERMS, problem

METHODS = ("static", "dynamic")
FILTERS = ("published",)
LEVELS = {"F_c", "F_s"}  # of a law: where one is given, the law is fitted by simulation
LOOSEST = 0.5  # of a number: a wider range is not narrow to anybody
OUTPUTS = ("force", "position", "velocity")  # what a simulation is to meet


@dataclass(frozen=True)
class FitOptions:
    """Options of a fit; each has the meaning of the argument of :func:`stribeck.fit` with its name.

    Raises:
        InputError: there is no such method.
    """

    mass: float | None = None
    method: str | None = None
    set: Mapping[str, float | str] = field(default_factory=dict)
    free: tuple[str, ...] = ()
    term: tuple[str, ...] = ()
    starts: int = 20
    seed: int = 0
    output: str = "force"
    forms: bool = True
    filter: str | None = None
    speed: tuple[float, ...] = ()
    unknown: Mapping[str, object] = field(default_factory=dict)
    require: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name, value, known in (
            ("method", self.method, METHODS), ("filter", self.filter, FILTERS), ("output", self.output, OUTPUTS)
        ):  # fmt: skip
            if value is not None and value not in known:
                raise InputError(f"{arg(name)}: {value!r}: must be {', '.join(known)}{nearest(value, known)}")
        wide = [(n, x) for n, x in self.require.items() if not 0 < x <= LOOSEST]
        if wide:
            text = f"must be a half width above 0, and at most {LOOSEST:g} of the number"
            raise InputError([f"{arg('require')}: {n}: {show(x)}: {text}" for n, x in wide])
        if wrong := [x for x in self.speed if not 0 < x <= LARGEST]:
            raise InputError([f"{arg('speed')}: {show(x)}: must be above 0, and at most {LARGEST:g}" for x in wrong])

    @cached_property
    def sought(self) -> dict[str, Sought]:
        """Prior knowledge of unknown parameters, by name: bounds, initial value, prior.

        Raises:
            InputError: a line of it is wrong; a line for each.
        """
        entries, problems = sought_of(self.unknown, argument=True)
        if problems:
            raise InputError(problems)
        return {x.path: x for x in entries}

    @cached_property
    def numbers(self) -> dict[str, float]:
        """The given constants and terms that are numbers, and the mass."""
        mass = {} if self.mass is None else {"mass": self.mass}
        return {n: float(x) for n, x in self.set.items() if not isinstance(x, str)} | mass

    @property
    def published(self) -> bool:
        """Whether the published procedure is asked for."""
        return self.filter == "published"

    @property
    def alone(self) -> bool:
        """Whether a static fit has the law without forms."""
        return self.published or not self.forms

    def of_law(self, law: str) -> FitOptions:
        """The options without constants that this law does not have."""
        own = {*laws.find(law).constants(), *TERMS}
        constants = {n: x for n, x in self.set.items() if n in own}
        unknown = {n: x for n, x in self.unknown.items() if n in own}
        return replace(self, set=constants, free=tuple(n for n in self.free if n in own), unknown=unknown)

    def method_for(self, law: type[laws.Law]) -> str:
        """The method asked for, or what suits the law and the given constants."""
        return self.method or ("static" if law.name in LAWS and not LEVELS & self.set.keys() else "dynamic")

    def check(self, names: Sequence[str]) -> None:
        """Refuse what these laws, or one of them, cannot be asked for.

        Raises:
            InputError: constants, the mass or options that a law or its method does not have; a line for each problem.
        """
        known = {n: c for name in names for n, c in laws.find(name).constants().items()}
        given = {"set": self.set, "free": self.free, "unknown": self.sought}
        none = f"law '{names[0]}' has no such constant" if len(names) == 1 else "none of these laws has such a constant"
        problems = [
            f"{arg(what)}: {n}: {none}{nearest(n, (*known, *TERMS))}"
            for what, some in given.items() for n in some if n not in known and (what == "free" or n not in TERMS)
        ]  # fmt: skip
        other = f"is given with {arg('set')} as well; must be one of the two"
        twice = {what: [n for n in some if n in self.set] for what, some in given.items() if what != "set"}
        problems += [f"{arg(what)}: {n}: {other}" for what, some in twice.items() for n in some]
        if self.mass is not None and "mass" in self.set:
            problems.append(f"{arg('mass')}: {show(self.mass)}: {other}")
        words = [n for n in self.free if n in known and known[n].choices]
        problems += [f"{arg('free')}: {n}: is a word, not a number; must be given with {arg('set')}" for n in words]
        for n, x in (self.set if self.mass is None else {**self.set, "mass": self.mass}).items():
            if text := problem(n, x) if n in TERMS else known[n].problem(x) if n in known else "":
                place = "mass" if n == "mass" and self.mass is not None else f"set.{n}"
                problems.append(f"{arg(place)}: {show(x)}: {text}")
        if problems:
            raise InputError(problems)
        for name in names:
            self._check_method(name)

    def _check_method(self, law: str) -> None:
        """Refuse what the law's method has not, and constants that contradict each other."""
        kind = laws.find(law)
        method, given = self.method_for(kind), {n: x for n, x in self.set.items() if n in kind.constants()}
        problems = [f"{arg(f'set.{name}')}: {text}" for name, text in kind.broken(given)]
        only_static = {"forms": not self.forms, "filter": self.filter, "speed": self.speed}
        if method != "static":
            problems += [
                f"{arg(n)}: belongs to {arg('method')} static, not {method}" for n, x in only_static.items() if x
            ]
        elif kind.name not in LAWS:
            problems.append(f"{arg('method')}: 'static': has {', '.join(LAWS)}; law '{law}' is fitted by simulation")
        elif held := sorted(LEVELS & self.set.keys()):
            text = f"a static fit estimates it; must be fitted, or {arg('method')} be dynamic"
            problems += [f"{arg(f'set.{n}')}: {text}" for n in held]
        else:
            text = f"belongs to {arg('method')} dynamic: a static fit chooses it itself"
            problems += [f"{arg('term')}: {n!r}: {text}" for n in (*self.term, *self.set) if n == "delay"]
            only_dynamic = {"output": self.output != "force", "unknown": self.unknown}
            problems += [
                f"{arg(n)}: belongs to {arg('method')} dynamic, not {method}" for n, x in only_dynamic.items() if x
            ]
        if problems:
            raise InputError(problems)
