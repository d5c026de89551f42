"""The command itself, and the options that several of its commands have."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import MISSING, dataclass, fields, is_dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeVar, get_type_hints

import typer
from typer.core import TyperCommand
from typer.models import OptionInfo

import stribeck
from stribeck.errors import check_all

if TYPE_CHECKING:
    from stribeck.scenario import Scenario

ADVANCED = "Advanced"  # the section of --help for options that few need
F = TypeVar("F", bound=Callable[..., int])

app = typer.Typer(
    help="Friction models that you can simulate, prove, fit and ship.",
    epilog="Example: stribeck new my_rig; stribeck run my_rig.toml --out first",
    rich_markup_mode=None,  # plain help: nothing folds within a word
    context_settings={"help_option_names": ["-h", "--help"]},
)


class PlainCommand(TyperCommand):
    """A command whose plain --help shows the options that most need first, then each other section."""

    def format_options(self, ctx: Any, formatter: Any) -> None:
        """Write arguments and options, a section for each panel."""
        sections: dict[str, list[tuple[str, str]]] = {"Arguments": [], "Options": []}
        for parameter in self.get_params(ctx):
            if (record := parameter.get_help_record(ctx)) is None:
                continue
            if parameter.param_type_name == "argument":
                sections["Arguments"].append((str(parameter.metavar), record[1]))  # without its type in Python
            else:
                panel = getattr(parameter, "rich_help_panel", None) or "Options"
                sections.setdefault(panel, []).append(record)
        for title, records in sections.items():
            if records:
                with formatter.section(title):
                    formatter.write_dl(records)


def command(name: str, example: str) -> Callable[[F], F]:
    """Make a function a command; a dataclass among its parameters stands for an option each of its fields."""

    def register(function: F) -> F:
        app.command(name, epilog=f"Example: {example}", cls=PlainCommand)(_spread(function))
        return function

    return register


def _spread(function: Callable[..., int]) -> Callable[..., int]:
    """The function with the fields of its dataclasses as parameters."""
    kinds = get_type_hints(function, include_extras=True)
    groups: dict[str, Any] = {n: kind for n, kind in kinds.items() if is_dataclass(kind)}

    def called(**given: Any) -> int:
        filled = {n: kind(**{f.name: given.pop(f.name) for f in fields(kind)}) for n, kind in groups.items()}
        return function(**filled, **given)

    parameters = []
    for name, parameter in inspect.signature(function).parameters.items():
        replacing = [parameter.replace(annotation=kinds[name], kind=parameter.KEYWORD_ONLY)]
        if (kind := groups.get(name)) is not None:
            hints = get_type_hints(kind, include_extras=True)
            replacing = [
                inspect.Parameter(
                    f.name, parameter.KEYWORD_ONLY, annotation=hints[f.name],
                    default=parameter.empty if f.default is MISSING else f.default,
                )
                for f in fields(kind)
            ]  # fmt: skip
        parameters += replacing
    called.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    called.__annotations__ = {p.name: p.annotation for p in parameters}
    called.__name__, called.__doc__ = function.__name__, function.__doc__
    return called


def setting(
    name: str, metavar: str, text: str, panel: str | None = None, *, min: int | None = None,
    parser: Callable[[str], object] | None = None,
) -> OptionInfo:  # fmt: skip
    """An option with a value: what stands for it, its help, and the section of --help."""
    option: OptionInfo = typer.Option(name, metavar=metavar, help=text, rich_help_panel=panel, min=min, parser=parser)
    return option


def flag(name: str, text: str, panel: str | None = None) -> OptionInfo:
    """An option without a value."""
    option: OptionInfo = typer.Option(name, help=text, rich_help_panel=panel)
    return option


def output_path(text: str) -> Path:
    """Where a command writes: an empty path would be the current folder."""
    if not str(text):
        raise typer.BadParameter("'': must be a path")
    return Path(text)


Out = Annotated[Path | None, setting("--out", "DIR", "Folder for the results; created if missing.", parser=output_path)]
Json = Annotated[bool, flag("--json", "Print the result as one JSON object.")]
ControllerName = Annotated[
    str | None, setting("--controller", "NAME", "Name of the controller; needed if the machine has several.")
]
Trust = Annotated[
    bool, flag("--trust", "Allow the scenario to run laws (FILE.py:NAME) from outside its folder.", ADVANCED)
]


def _allow(allowed: bool) -> None:
    from stribeck.parameter_sets import allow_undetermined

    allow_undetermined(allowed)


Undetermined = Annotated[
    bool,
    typer.Option(
        "--allow-undetermined", callback=_allow, rich_help_panel=ADVANCED,
        help="Accept fitted values that are not identifiable.",
    ),
]  # fmt: skip


Set = Annotated[
    list[str] | None, setting("--set", "PATH=VALUE", "Replace a value, such as law.k_v=1e6; may be repeated.")
]


@dataclass(frozen=True)
class ScenarioOptions:
    """A scenario file, and what is changed in it."""

    scenario: Annotated[
        Path, typer.Argument(metavar="SCENARIO.toml", help="Scenario or machine file; 'stribeck new' writes one.")
    ]
    set_: Set = None
    trust: Trust = False
    _undetermined: Undetermined = False

    def load(self, *also: Callable[[], object]) -> Scenario:
        """The scenario with every --set applied, after ``also`` has read the texts of other options."""
        from stribeck.scenario import parse_assignments

        check_all(lambda: parse_assignments(self.set_ or []), *also)
        return load_scenario(self.scenario, self.set_ or [], trust=self.trust)


def load_scenario(path: Path, assignments: list[str], *, trust: bool) -> Scenario:
    """A scenario file with assignments applied."""
    from stribeck.scenario import Scenario, parse_assignments

    return Scenario.load(path, parse_assignments(assignments), trust=trust)


def given_options(context: typer.Context) -> dict[str, str]:
    """The options on the command line: each parameter's name and how the option is written."""
    options = {p.name: p.opts[0] for p in context.command.params if p.param_type_name == "option" and p.name}
    sources = {name: context.get_parameter_source(name) for name in options}
    return {name: options[name] for name, source in sources.items() if source and source.name == "COMMANDLINE"}


def _version(wanted: bool) -> None:
    if wanted:
        print(f"stribeck {stribeck.__version__}")
        raise typer.Exit


@app.callback()
def _common(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version.")
    ] = False,
) -> None:
    pass
