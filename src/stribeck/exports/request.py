"""The request of an export, and the header of every export."""

from __future__ import annotations

import hashlib
import keyword
import re
import textwrap
import unicodedata
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from stribeck.constants import Constant, rotary_unit, rotary_words
from stribeck.errors import InputError, arg
from stribeck.expressions.emit import C_FUNCTIONS, C_WORDS
from stribeck.expressions.ops import Value
from stribeck.laws.base import PARAMETERS, Law
from stribeck.laws.render import equations
from stribeck.parameter_sets import parameters
from stribeck.scenario import Scenario
from stribeck.version import __version__

Content = Mapping[str, str | bytes]  # of files, by their names
_WIDTH = 116  # letters of a header's line: 120 with the mark of a comment before it, the width of the code here


@dataclass(frozen=True)
class Part:
    """One part of a target: what writes it.

    Attributes:
        files: the content of a :class:`Request`, of a controller's block or of a machine's model.
        notes: what is lost there.
    """

    files: Callable[[Value], Content]
    notes: Callable[[Value], list[str]] = lambda _: []


@dataclass(frozen=True)
class Target:
    """A tool to write for.

    Attributes:
        parts: each part that the tool can have.
        folder: False where the target is one file, ``out`` itself.
        self_test: whether a program that tests the result can be written beside it.
        loads: whether the tool can be given, at each step, what the level of a contact follows.
        started: whether a law or body has the state of the scenario's start there, or no state at all.
    """

    name: str
    meaning: str
    parts: Mapping[str, Part]
    folder: bool = True
    self_test: bool = False
    loads: bool = False
    started: bool = True


@dataclass(frozen=True)
class Options:
    """Options that only some targets have.

    Attributes:
        self_test: also write a program that tests the result.
        fmi: version of FMI.
    """

    self_test: bool = False
    fmi: int = 3


PLAIN = Options()


@dataclass(frozen=True)
class Request:
    """One export: the law with its constants, the part wanted, the scenario and the time step where they are given.

    Attributes:
        z: deflection at t = 0, m (rad).
        module: the name by which Python imports the written file, if it is a single one.
    """

    law: Law
    part: str = "law"
    scenario: Scenario | None = None
    step: float | None = None
    origin: str = ""
    options: Options = PLAIN
    z: float = 0.0
    module: str = ""

    @property
    def name(self) -> str:
        """The law's name as an identifier of most languages."""
        return identifier(self.law.name, "law")

    @property
    def moved_mass(self) -> float | None:
        """The mass that the scenario's drive moves, kg (kg m^2); None if there is no scenario, or none in it."""
        return None if self.scenario is None else self.scenario.elements.mass

    @property
    def mass(self) -> float:
        """The body's mass in kg (kg m^2): the scenario's.

        Raises:
            InputError: there is no scenario, or it has no mass.
        """
        if self.moved_mass is None:
            raise InputError(f"{arg('scenario')}: part '{self.part}' needs one with a mass (plant.mass)")
        return float(self.moved_mass)

    @property
    def start(self) -> dict[str, float]:
        """Position, velocity and deflection of a body at t = 0."""
        initial = {} if self.scenario is None else self.scenario.initial
        return {"y": initial.get("y", 0.0), "v": initial.get("v", 0.0), "z": self.z}

    @property
    def constants(self) -> dict[str, float]:
        """The constants that the equations use, by name; optional ones that are off are left out."""
        return self.law.p.numbers

    @property
    def rotary(self) -> bool:
        """Whether the machine turns: rad and N m in every unit then."""
        return self.law.rotary or (self.scenario is not None and self.scenario.rotary)

    @property
    def declared(self) -> dict[str, Constant]:
        """The declarations of the law's constants, with the units of the machine's motion."""
        return {name: constant.of_motion(self.rotary) for name, constant in self.law.constants().items()}

    def unit(self, linear: str) -> str:
        """A unit as the machine's motion has it."""
        return rotary_unit(linear) if self.rotary else linear

    def words(self, linear: str) -> str:
        """Words as the machine's motion has them."""
        return rotary_words(linear) if self.rotary else linear

    def about(self) -> list[str]:
        """Lines for the header: law, equations, source, parameters with units, what it guarantees, version."""
        law = self.law
        kept = [name.replace("_", "-") for name, holds in law.guarantees().items() if holds]
        lost = [name.replace("_", "-") for name, holds in law.guarantees().items() if holds is False]
        lines = [f"{law.name}: {' '.join((law.__doc__ or '').split())}", ""]
        lines += [f"  {each.text}" for each in equations(type(law), law.form)]
        lines += ["", f"Source: {law.source}", f"Parameters: {self.origin or _origin(law)}"]
        declared = self.declared
        lines += [valued(n, x, declared[n]) for n, x in self.constants.items()]
        rotary, linear = "rotary motion: N m and rad", "linear motion; a rotary machine has N m for N and rad for m"
        lines.append(f"  ({rotary if self.rotary else linear})")
        if kept or lost:
            guarantees = [
                *([_listed(kept)] if kept else []),
                *([_listed([f"not {name}" for name in lost])] if lost else []),
            ]
            lines.append(f"The law is {'; it is '.join(guarantees)}.")
        lines.append(made_by())
        return [ascii_only(line) for line in lines]

    def in_docstring(self) -> str:
        """The header, fit for a docstring of Python."""
        return "\n".join(wrapped(self.about())).replace("\\", "\\\\").replace('"""', "'''")


def _listed(words: list[str]) -> str:
    return " and ".join(part for part in (", ".join(words[:-1]), words[-1]) if part)


_LONGEST = 48  # letters: C99 compilers keep 63 of a name apart, and our own words follow after it


def identifier(name: str, kind: str = "machine") -> str:
    """A valid prefix of names in every language.

    It is ASCII, of bounded length, and different for different names. It is no word of C, C++, Python or the templates, and
    no beginning of such a word up to a "_". It is no name of another exported file. Libraries may rename their functions and
    types, so no exported C uses this name alone.
    """
    text = re.sub(r"\W", "_", name, flags=re.ASCII)
    if len(text) > _LONGEST:
        text = f"{text[: _LONGEST - 9]}_{hashlib.sha256(name.encode()).hexdigest()[:8]}"
    if not text[:1].isalpha():
        text = f"{kind}_{text}"
    return f"{text}_{kind}" if text in _begins(kind != "law") else text


@cache
def _begins(solver: bool) -> frozenset[str]:
    """Every word of the languages and templates, and each begin of one before a "_"; ``solver``: of machines too."""
    places = [files("stribeck.exports") / "templates", *([files("stribeck.codegen.runtime")] if solver else [])]
    sources = [file for place in places for file in place.iterdir() if file.name.endswith((".c", ".h"))]
    sources = [file for file in sources if solver or not file.name.startswith("machine")]
    code = "\n".join(file.read_text(encoding="utf-8") for file in sources)
    code = re.sub(r'/\*.*?\*/|"[^"\n]*"|\{[{%].*?[%}]\}', " ", code, flags=re.DOTALL)
    words = {
        *re.findall(r"[A-Za-z_]\w*", code),
        *C_WORDS,
        *C_FUNCTIONS,
        *keyword.kwlist,
        *_CPP.split(),
        "main",
        *_BESIDE,
        *_HEADERS.split(),
    }
    return frozenset(word[:i] for word in words for i in (*(m.start() for m in re.finditer("_", word)), len(word)))


_BESIDE = ("fmu", "fmi2", "fmi3")  # files that an FMU has too

# Headers of C, POSIX and the usual libraries of C: a NAME.h of ours in an include path would be taken for them.
_HEADERS = """
    assert complex ctype errno fenv float inttypes iso646 limits locale math setjmp signal stdalign stdarg stdatomic stdbit
    stdbool stdckdint stddef stdint stdio stdlib stdnoreturn string tgmath threads time uchar wchar wctype
    aio cpio dirent dlfcn fcntl fmtmsg fnmatch ftw glob grp iconv langinfo libgen monetary mqueue ndbm netdb nl_types poll
    pthread pwd regex sched search semaphore spawn strings stropts syslog tar termios trace ulimit unistd utime utmpx wordexp
    aliases alloca ar argp argz byteswap crypt elf endian envz err error execinfo features fstab fts gconv getopt gnumake
    gshadow ieee754 ieeefp ifaddrs lastlog libintl link malloc mcheck memory mntent newlib obstack paths printf proc_service
    pty re_comp reent regexp resolv sgtty shadow stab stdio_ext syscall sysexits thread_db ttyent ucontext unwind utmp values
    varargs wait xlocale conio direct intrin io process windows winsock winsock2
"""

# Of C++ alone, which reads the headers too.
_CPP = """
    alignas alignof and asm bool catch class compl concept constexpr decltype delete explicit export false friend mutable
    namespace new noexcept not nullptr operator or private protected public requires template this throw true try typeid
    typename using virtual wchar_t xor
"""


def valued(name: str, value: float, constant: Constant) -> str:
    """A line of a header that gives a constant's value."""
    return (
        f"  {name} = {value!r}{f' {constant.unit}' if constant.unit != '1' else ''}".rstrip() + f": {constant.meaning}"
    )


def wrapped(lines: Iterable[str]) -> list[str]:
    """Lines of a header, those that are too long continued on indented lines."""
    rows = []
    for line in lines:
        indent = line[: len(line) - len(line.lstrip())]
        rows += textwrap.wrap(
            line, _WIDTH, subsequent_indent=f"{indent}    ", break_long_words=False, break_on_hyphens=False
        ) or [""]
    return rows


def made_by() -> str:
    """The last line of every header."""
    return f"Made by stribeck {__version__} (Apache-2.0)."


def ascii_only(text: str) -> str:
    """The text in ASCII, as compilers of firmware want it, on one line and with no end of a comment in it."""
    result = ""
    for c in text:
        kind, name = unicodedata.decomposition(c).partition(" ")[0], unicodedata.name(c, "")
        if c.isascii():
            result += c if c.isprintable() else " "
        elif kind in ("<super>", "<sub>"):
            result += ("^" if kind == "<super>" else "_") + unicodedata.normalize("NFKC", c)
        elif name.startswith("GREEK SMALL LETTER "):
            result += name.rsplit(" ", 1)[-1].lower()
        else:
            result += unicodedata.normalize("NFKD", c).encode("ascii", "replace").decode()
    for end in ("*/", "/*", "*)", "(*", "??"):  # the last begins a trigraph, which C reads in comments too
        result = result.replace(end, " ".join(end))
    return result


def _origin(law: Law) -> str:
    given = {name: value for name, value in law.machine.items() if name in PARAMETERS and name in law.constants()}
    for each in parameters().values():
        if given and all(each.values.get(name) == value for name, value in given.items()):
            return f"{each.name} ({each.source})"
    return "the user's own"
