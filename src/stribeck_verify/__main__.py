"""``python -m stribeck_verify FILE``: check the certificates in a file, without the prover.

The equations are taken from the file; it prints them, so that a reader can compare them with the law's.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

from stribeck_verify import verify
from stribeck_verify.expressions import Json


def main(arguments: list[str]) -> int:
    """Check a file; 0 where every certificate in it is confirmed, 1 where one is refused, 2 where it cannot be read."""
    if len(arguments) != 1:
        print(__doc__, file=sys.stderr)
        return 2
    try:
        data = json.loads(Path(arguments[0]).read_text())
        certificates: dict[str, Json] = data["certificates"]
        items = list(certificates.items())
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        print(f"{arguments[0]}: holds no certificates: {type(error).__name__}: {error}", file=sys.stderr)
        return 2
    print(f"law {data.get('law')}")
    refused = 0
    for i, (name, certificate) in enumerate(items):
        if i == 0 and isinstance(certificate, dict):
            for what in ("definitions", "dz_dt", "force", "Z"):
                print(f"  {what}: {json.dumps(certificate.get(what))}")
        problems = verify(certificate)
        if not problems and certificate["property"] != name:
            problems = [f"it is about {certificate['property']!r}"]
        refused += bool(problems)
        limit = certificate.get("v_max", "inf") if isinstance(certificate, dict) else "inf"
        words = "confirmed" if limit == "inf" else f"confirmed for speeds up to {limit} m/s"
        print(f"{name}: {'; '.join(problems) if problems else words}")
    return 1 if refused or not items else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
