"""What a fit is asked for, as one thing that the library and the command hand on whole."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property

from stribeck import laws
from stribeck.constants import show
from stribeck.errors import InputError, arg, nearest
from stribeck.identify.actuator.recordings import Sought, sought_of
from stribeck.identify.data.quality import LARGEST
from stribeck.identify.models.terms import OF_MOTION, TERMS, problem

METHODS = ("static", "dynamic")
FILTERS = ("published",)
LOOSEST = 0.5  # of a number: a wider range is not narrow to anybody
OUTPUTS = ("force", "position", "velocity")  # what a simulation is to meet


@dataclass(frozen=True)
class FitOptions:
    """How to fit; the meaning of each is that of the argument of :func:`stribeck.fit` with its name.

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
        if self.method is not None and self.method not in METHODS:
            guess = nearest(self.method, METHODS)
            raise InputError(f"{arg('method')}: {self.method!r}: must be {', '.join(METHODS)}{guess}")
        if self.filter is not None and self.filter not in FILTERS:
            raise InputError(f"{arg('filter')}: {self.filter!r}: must be {', '.join(FILTERS)}")
        if self.output not in OUTPUTS:
            raise InputError(
                f"{arg('output')}: {self.output!r}: must be {', '.join(OUTPUTS)}{nearest(self.output, OUTPUTS)}"
            )
        wide = [(n, x) for n, x in self.require.items() if not 0 < x <= LOOSEST]
        if wide:
            text = f"must be a half width above 0, and at most {LOOSEST:g} of the number"
            raise InputError([f"{arg('require')}: {n}: {show(x)}: {text}" for n, x in wide])
        if wrong := [x for x in self.speeds if not 0 < x <= LARGEST]:
            raise InputError([f"{arg('speed')}: {show(x)}: must be above 0, and at most {LARGEST:g}" for x in wrong])

    @cached_property
    def sought(self) -> dict[str, Sought]:
        """What is known of numbers that are sought, by name: bounds, where to start, a prior.

        Raises:
            InputError: a line of it is wrong; a line for each.
        """
        found, problems = sought_of(self.unknown, argument=True)
        if problems:
            raise InputError(problems)
        return {x.path: x for x in found}

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
        if problems := [*self._wrong_constants(law), *self.wrong_mass(), *self._wrong_unknown(law)]:
            raise InputError(problems)
        method = self.method_for(laws.find(law))
        if method != "static" and (wrong := self._only_static()):
            raise InputError([f"{arg(name)}: belongs to {arg('method')} static, not {method}" for name in wrong])
        if method == "static" and laws.find(law).has_z:
            text = f"law '{law}' has bristles, which a static fit does not see; must be a static law, such as stribeck"
            raise InputError(f"{arg('method')}: 'static': {text}")
        if method == "static" and (moved := [n for n in (*self.terms, *self.constants) if n in OF_MOTION]):
            text = f"belongs to {arg('method')} dynamic: a static fit chooses it itself"
            raise InputError([f"{arg('terms')}: {n!r}: {text}" for n in moved])
        if method != "dynamic" and self.output != "force":
            raise InputError(f"{arg('output')}: {self.output!r}: belongs to {arg('method')} dynamic, not {method}")

    def check_without_law(self) -> None:
        """Refuse what cannot be asked where the law is looked for.

        Raises:
            InputError: options that need a law; the mass.
        """
        if self.method not in (None, "static") or self.free:
            option = "free" if self.free else "method"
            raise InputError(f"{arg(option)}: needs {arg('law')}: without one, static laws are compared")
        known = {n for kind in laws.builtin().values() for n in kind.constants()}
        unknown = [n for n in self.constants if n not in known and n not in TERMS]
        texts = [f"{arg('constants')}: {n}: no law has such a constant{nearest(n, known)}" for n in unknown]
        if wrong := [*self.wrong_mass(), *self._wrong_terms(), *texts]:
            raise InputError(wrong)

    def wrong_mass(self) -> list[str]:
        """What is wrong with the mass."""
        if self.mass is not None and "mass" in self.constants:
            return [
                f"{arg('mass')}: {show(self.mass)}: is given with {arg('constants')} as well; must be one of the two"
            ]
        if self.mass is None or 0 <= self.mass <= LARGEST:
            return []
        return [f"{arg('mass')}: {show(self.mass)}: must be a number from 0 to {LARGEST:g}"]

    def _wrong_constants(self, law: str) -> list[str]:
        found = laws.find(law).constants()
        problems = [
            f"{arg(argument)}: {name}: law '{law}' has no such constant{nearest(name, found)}"
            for argument, names in (("constants", self.constants), ("free", self.free))
            for name in names
            if name not in found and not (argument == "constants" and name in TERMS)
        ]
        problems += [
            f"{arg(f'constants.{name}')}: {show(value)}: {text}"
            for name, value in self.constants.items()
            if name in found and (text := found[name].problem(value))
        ]
        if not problems:
            broken = laws.find(law).broken({n: x for n, x in self.constants.items() if n in found})
            problems += [f"{arg(f'constants.{name}')}: {text}" for name, text in broken]
        problems += self._wrong_terms()
        problems += [
            f"{arg('free')}: {name}: is a word, not a number; must be given with {arg('constants')}"
            for name in self.free
            if name in found and found[name].choices
        ]
        problems += [
            f"{arg('free')}: {name}: is given with {arg('constants')} as well; must be one of the two"
            for name in self.free
            if name in self.constants and not (name in found and found[name].choices)
        ]
        return problems

    def _wrong_unknown(self, law: str) -> list[str]:
        known = [*laws.find(law).constants(), *TERMS]
        wrong = [n for n in self.sought if n not in known or n in self.constants]
        return [f"{arg('unknown')}: {n}: is not sought{nearest(n, known)}" for n in wrong]

    def _wrong_terms(self) -> list[str]:
        return [
            f"{arg(f'constants.{name}')}: {show(value)}: {text}"
            for name, value in self.constants.items()
            if name in TERMS and (text := problem(name, value))
        ]

    def _only_static(self) -> list[str]:
        given = {"forms": not self.forms, "filter": self.filter, "weight": not self.weight, "speed": self.speeds}
        return [name for name, value in given.items() if value]
