"""Tables of several kinds: ``kind`` in the file picks the class, and a class registers itself by being defined."""

from __future__ import annotations

from typing import ClassVar, Self

from pydantic import GetJsonSchemaHandler

from stribeck.constants import show
from stribeck.errors import InputError, corrected, nearest
from stribeck.kinds import find_class, in_a_file, of_a_file
from stribeck.machine.table import FileTable, Held, Loc, Reading, problems_at, unknown_key


class NotExecuted(Exception):
    """A table whose class is in a file that must not be executed yet."""


class Family(FileTable):
    """The base of tables with a ``kind``: ``class Load(Element, family=True)``, then ``class Pendulum(Load)`` is a kind."""

    kind: str
    family: ClassVar[type[Family]]
    kinds: ClassVar[dict[str, type[Held]]]
    plain: ClassVar[str] = ""  # the kind that a table without ``kind`` has
    for_users: ClassVar[type[Held]]  # the class that users derive theirs from

    def __init_subclass__(cls, family: bool = False, for_users: bool = False, **more: Held) -> None:
        super().__init_subclass__(**more)

    @classmethod
    def __pydantic_init_subclass__(cls, family: bool = False, for_users: bool = False, **more: Held) -> None:
        super().__pydantic_init_subclass__(**more)
        if family:
            cls.family, cls.for_users, cls.kinds = cls, cls, {}
        if for_users:
            cls.family.for_users = cls
        kind = cls.model_fields["kind"].default
        if isinstance(kind, str) and kind and not of_a_file(cls):
            cls.kinds.setdefault(kind, cls)

    @classmethod
    def kind_for(cls, data: dict[str, Held], reading: Reading) -> type[Self]:
        """The class of the table's kind; FILE.py:NAME is a class of the user's own."""
        if cls is not cls.family:
            return cls
        if "kind" not in data and cls.plain:
            return cls.kinds[cls.plain]
        kind = data.get("kind")
        if in_a_file(kind):
            if not reading.executes:
                raise NotExecuted
            try:
                return find_class(kind, reading.folder, cls.for_users)
            except InputError as error:
                raise problems_at([(("kind",), "; ".join(error.problems))]) from None
        if isinstance(kind, str) and kind in cls.kinds:
            return cls.kinds[kind]
        every = [key for each in cls.kinds.values() for key in each.file_keys()]
        problems: list[tuple[Loc, str]] = [
            ((key,), unknown_key(key, x, [*dict.fromkeys(every)]))
            for key, x in data.items()
            if key not in (*every, "name")
        ]
        allowed = f"one of {', '.join(cls.kinds)}"
        if "kind" in data:
            guess = nearest(kind, cls.kinds) if isinstance(kind, str) else ""
            problems.append((("kind",), f"{show(kind)}: must be {allowed}{guess}"))
        elif "kind" not in corrected(data, (*every, "name")):
            problems.append((("kind",), f"missing: must be given ({allowed})"))
        raise problems_at(problems)

    def to_table(self) -> dict[str, Held]:
        """With the kind, unless that is the plain one."""
        kind = {} if self.kind == self.plain else {"kind": self.kind}
        return {**kind, **{n: x for n, x in super().to_table().items() if n != "kind"}}

    @classmethod
    def __get_pydantic_json_schema__(cls, schema: Held, handler: GetJsonSchemaHandler) -> dict[str, Held]:
        """Of a family, one of its kinds, or a table whose kind is a class in a file."""
        node = super().__get_pydantic_json_schema__(schema, handler)
        if cls is not cls.family:
            return node
        others = []
        for each in (kind for kind in cls.kinds.values() if kind is not cls):
            kind_node = handler.resolve_ref_schema(handler(each.__pydantic_core_schema__))
            hidden = {name for name, info in each.model_fields.items() if info.exclude}
            kind_node["properties"] = {n: x for n, x in kind_node["properties"].items() if n not in hidden}
            others.append({**kind_node, "required": [*dict.fromkeys(["kind", *kind_node.get("required", ())])]})
        file_node = {
            "type": "object",
            "properties": {"kind": {"type": "string", "pattern": "\\.py:."}},
            "required": ["kind"],
        }
        return {"anyOf" if cls.plain else "oneOf": [*([node] if cls.plain else []), *others, file_node]}
