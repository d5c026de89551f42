"""``python -m stribeck_verify FILE``: check the certificates in a file, without the prover.

The equations are taken from the file; it prints them before the certificates
that are about them, so that a reader can compare them with the law's. Of a
number that no short decimal gives it prints "about" and a decimal.
"""

from __future__ import annotations

import json
import os
import re
import sys
from pathlib import Path

from stribeck_verify import fields, intervals, verify
from stribeck_verify.expressions import Json, Refused, rational

_GROUP = ("format", "law", "certificates")


def main(arguments: list[str]) -> int:
    """Check a file; 0 where every certificate in it is confirmed, 1 where one is refused, 2 where it cannot be read."""
    if arguments in (["-h"], ["--help"]):
        print(__doc__)
        return 0
    if len(arguments) != 1:
        print(__doc__, file=sys.stderr)
        return 2
    try:
        text = Path(arguments[0]).read_text(encoding="utf-8")
        groups = _read(json.loads(text, parse_constant=_no_number, object_pairs_hook=_each_once))
    except (OSError, ValueError, RecursionError, Refused) as error:
        words = fields.escaped(f"{arguments[0]}: holds no certificates: {type(error).__name__}: {error}")
        print(words, file=sys.stderr)
        return 2
    refused = [_checked(where, law, certificates) for where, law, certificates in groups]
    return 1 if any(refused) or not any(certificates for *_, certificates in groups) else 0


def _each_once(pairs: list[tuple[str, Json]]) -> Json:
    """A table; of a name that is given twice, readers of JSON take one or the other."""
    table: dict[str, Json] = {}
    for name, value in pairs:
        if name in table:
            raise Refused(f"{name!r} is given twice")
        table[name] = value
    return table


def _no_number(word: str) -> Json:
    raise Refused(f"{word} is no number of JSON")


def _read(data: Json) -> list[tuple[str, str, dict[str, Json]]]:
    """The certificates in a file: of one law, or of each contact of a machine (its name, the law, the certificates)."""
    if not isinstance(data, dict):
        raise Refused("a file of certificates must be a table")
    _known(data, ("contacts",) if "contacts" in data else _GROUP)
    if "contacts" not in data:
        return [("", *_group(data))]
    contacts = fields.table(data, "contacts")
    return [(f"{name}: ", *_group(fields.table(contacts, name))) for name in contacts]


def _known(data: dict[str, Json], keys: tuple[str, ...]) -> None:
    if unknown := [key for key in data if key not in keys]:
        raise Refused(f"no file of certificates has {unknown[0]!r} here")


def _group(data: dict[str, Json]) -> tuple[str, dict[str, Json]]:
    _known(data, _GROUP)
    fields.whole(data, "format", 1, 1)
    if "certificates" not in data:
        raise Refused("certificates: missing")
    return fields.text(data, "law"), fields.table(data, "certificates")


def _checked(where: str, law: str, certificates: dict[str, Json]) -> bool:
    """Print what is found of a law's certificates; whether one is refused."""
    print(fields.escaped(f"{where}law {law}"))
    refused, shown = False, [""]
    for name, certificate in certificates.items():
        equations = _equations(certificate)
        if equations != shown:
            print(*equations, sep="\n")
            shown = equations
        problems = verify(certificate)
        for what, stated in (("property", name), ("law", law)):
            if not problems and certificate[what] != stated:
                problems = [f"it is about {certificate[what]!r}"]
        refused = refused or bool(problems)
        limit = None if problems else fields.limit(certificate, "v_max")
        words = "confirmed" if limit is None else f"confirmed for speeds up to {intervals.decimal(limit)} m/s"
        print(fields.escaped(f"{where}{name}: {'; '.join(problems) if problems else words}"))
    return refused


def _equations(certificate: Json) -> list[str]:
    """What a certificate says the law is; each certificate of a file has equations of its own."""
    given = certificate if isinstance(certificate, dict) else {}
    return [f"  {what}: {_expression(given.get(what))}" for what in ("definitions", "dz_dt", "force", "Z")]


def _expression(data: Json) -> str:
    """As JSON, which is ASCII and one line, with decimals for fractions."""
    try:
        return re.sub(r'"(-?[0-9]+/[0-9]+)"', _decimal, json.dumps(data))
    except RecursionError:
        return "nested too deeply"


def _decimal(fraction: re.Match[str]) -> str:
    try:
        return json.dumps(intervals.decimal(rational(fraction[1])))
    except Refused:  # a divisor of 0, which the check reports
        return fraction[0]


if __name__ == "__main__":
    try:
        status = main(sys.argv[1:])
        sys.stdout.flush()
    except BrokenPipeError:
        status = 2
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    sys.exit(status)
