"""Documents of a scenario: its laws, and its file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from stribeck.laws import said as of_law
from stribeck.mouth.document import PAGE, Chapter

if TYPE_CHECKING:
    from stribeck.scenario import Scenario

_LONGEST, _ENDS = 24, 8  # entries of a list that are shown whole; of a longer one, at each end


def laws(scenario: Scenario) -> list[Chapter]:
    """The law, or the laws of a machine's contacts."""
    laws = scenario.elements.laws
    named = [(name, laws[contact.law_path]) for name, contact in scenario.elements.contacts.items()]
    return [
        of_law.chapter(law, f"law-{i}", f" of {name}") if name else of_law.chapter(law)
        for i, (name, law) in enumerate(named)
    ]


def file(scenario: Scenario) -> Chapter:
    """The scenario as a file that runs again; long lists are cut, which they say."""
    from tomli_w import dumps

    def cut(value: object) -> object:
        if isinstance(value, dict):
            return {key: cut(inner) for key, inner in value.items() if inner is not None}
        if isinstance(value, list) and len(value) > _LONGEST:
            return [*value[:_ENDS], f"... {len(value) - 2 * _ENDS} more ...", *value[-_ENDS:]]
        return value

    code = dumps({key: cut(value) for key, value in scenario.data.items()})
    return Chapter("scenario", "The scenario", ["As a file for 'stribeck run':"], code=code, on=PAGE)
