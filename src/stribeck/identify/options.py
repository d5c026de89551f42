"""Options of a fit, as one object for the library and the command."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

from stribeck import laws
from stribeck.constants import Constant, show
from stribeck.errors import InputError, arg, nearest
from stribeck.identify.actuator.recordings import Sought, sought_of
from stribeck.identify.data.quality import LARGEST
from stribeck.identify.models.terms import TERMS, problem

METHODS = ("static", "dynamic")
FILTERS = ("published",)
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
    constants: Mapping[str, float | str] = field(default_factory=dict)
    free: tuple[str, ...] = ()
    terms: tuple[str, ...] = ()
    starts: int = 20
    seed: int = 0
    output: str = "force"
    forms: bool = True
    filter: str | None = None
    weight: bool = True
    speeds: tuple[float, ...] = ()
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
        if wrong := [x for x in self.speeds if not 0 < x <= LARGEST]:
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
    def bounds(self) -> dict[str, tuple[float, float]]:
        """The search ranges that the user gives, by name."""
        return {n: (x.low, x.high) for n, x in self.sought.items()}

    @cached_property
    def numbers(self) -> dict[str, float]:
        """The given constants and terms that are numbers, and the mass."""
        mass = {} if self.mass is None else {"mass": self.mass}
        return {n: float(x) for n, x in self.constants.items() if not isinstance(x, str)} | mass

    @property
    def published(self) -> bool:
        """Whether the published procedure is asked for."""
        return self.filter == "published"

    @property
    def alone(self) -> bool:
        """Whether a static fit has the law without forms."""
        return self.published or not self.forms

    def of_law(self, law: str, known: Collection[str]) -> FitOptions:
        """The options without the constants, of those ``known``, that only other laws have."""
        foreign = set(known) - set(laws.find(law).constants())
        constants = {n: v for n, v in self.constants.items() if n not in foreign}
        unknown = {n: x for n, x in self.unknown.items() if n not in foreign}
        return replace(self, constants=constants, free=tuple(n for n in self.free if n not in foreign), unknown=unknown)

    def method_for(self, law: type[laws.Law]) -> str:
        """The method asked for, or what suits the law."""
        return self.method or ("dynamic" if law.has_z else "static")

    def check(self, law: str) -> None:
        """Refuse what this law cannot be asked for.

        Raises:
            InputError: constants, the mass or options that the method has not; a line for each problem.
        """
        kind = laws.find(law)
        known, method = kind.constants(), self.method_for(kind)
        problems = self._wrong_given(known, f"law '{law}' has no such constant") + self._wrong_free(law)
        if not problems:
            broken = kind.broken({n: x for n, x in self.constants.items() if n in known})
            problems += [f"{arg(f'constants.{name}')}: {text}" for name, text in broken]
        sought = [n for n in self.sought if n not in (*known, *TERMS) or n in self.constants]
        problems += [f"{arg('unknown')}: {n}: is not sought{nearest(n, (*known, *TERMS))}" for n in sought]
        if problems:
            raise InputError(problems)
        only_static = {"forms": not self.forms, "filter": self.filter, "weight": not self.weight, "speed": self.speeds}
        if method != "static":
            problems = [
                f"{arg(n)}: belongs to {arg('method')} static, not {method}" for n, x in only_static.items() if x
            ]
        elif kind.has_z:
            text = (
                f"law '{law}' has bristles, which a static fit cannot estimate; must be a static law, such as stribeck"
            )
            problems = [f"{arg('method')}: 'static': {text}"]
        else:
            text = f"belongs to {arg('method')} dynamic: a static fit chooses it itself"
            problems = [f"{arg('terms')}: {n!r}: {text}" for n in (*self.terms, *self.constants) if n == "delay"]
            if self.output != "force":
                problems.append(f"{arg('output')}: {self.output!r}: belongs to {arg('method')} dynamic, not {method}")
        if problems:
            raise InputError(problems)

    def check_without_law(self) -> None:
        """Refuse what cannot be asked where the law is looked for.

        Raises:
            InputError: options that need a law; constants and the mass.
        """
        if self.method not in (None, "static") or self.free:
            option = "free" if self.free else "method"
            raise InputError(f"{arg(option)}: needs {arg('law')}: without one, static laws are compared")
        known = {n: c for kind in laws.builtin().values() for n, c in kind.constants().items()}
        if problems := self._wrong_given(known, "no law has such a constant"):
            raise InputError(problems)

    def _wrong_given(self, known: Mapping[str, Constant], unknown: str) -> list[str]:
        """Problems of given constants and terms, and of the mass."""
        problems = []
        for name, value in self.constants.items():
            if name not in known and name not in TERMS:
                problems.append(f"{arg('constants')}: {name}: {unknown}{nearest(name, known)}")
            elif text := known[name].problem(value) if name in known else problem(name, value):
                problems.append(f"{arg(f'constants.{name}')}: {show(value)}: {text}")
        if self.mass is not None and "mass" in self.constants:
            text = f"is given with {arg('constants')} as well; must be one of the two"
            problems.append(f"{arg('mass')}: {show(self.mass)}: {text}")
        elif self.mass is not None and not 0 <= self.mass <= LARGEST:
            problems.append(f"{arg('mass')}: {show(self.mass)}: must be a number from 0 to {LARGEST:g}")
        return problems

    def _wrong_free(self, law: str) -> list[str]:
        """Problems of constants that are to be fitted."""
        known, problems = laws.find(law).constants(), []
        for name in self.free:
            if name not in known:
                problems.append(f"{arg('free')}: {name}: law '{law}' has no such constant{nearest(name, known)}")
            elif known[name].choices:
                problems.append(
                    f"{arg('free')}: {name}: is a word, not a number; must be given with {arg('constants')}"
                )
            elif name in self.constants:
                problems.append(
                    f"{arg('free')}: {name}: is given with {arg('constants')} as well; must be one of the two"
                )
        return problems
