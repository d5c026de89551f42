"""Renew the kept outputs: ``python -m tests.kept [WORD...]``, of cases whose names hold one of the words.

``--whole`` prints the outputs instead, with the code of which digests are kept: compare what two checkouts print. ``--noise``
keeps them, and marks the numbers that are others here: what processors, or C and WebAssembly, round to different ends. With
``OPENBLAS_CORETYPE=Prescott``, ``Nehalem``, ``Haswell`` or ``SkylakeX`` this processor rounds as others do.
"""

import os
import sys
import tempfile
from pathlib import Path

from tests.kept import shown
from tests.kept.cases import CASES
from tests.kept.runner import COARSE, OUTPUTS, marked

words = [word for word in sys.argv[1:] if not word.startswith("-")]
os.environ["STRIBECK_CACHE"] = tempfile.mkdtemp(prefix="stribeck-kept-")
for case in CASES:
    if words and not any(word in case.name for word in words):
        continue
    if "--whole" in sys.argv:
        shown.WHOLE = True
        with tempfile.TemporaryDirectory() as folder:
            print(f"==== {case.name}", *case.lines(Path(folder).resolve()), sep="\n")
        continue
    start = sum(os.times()[:4])
    with tempfile.TemporaryDirectory() as folder:
        lines, changed = case.differences(Path(folder).resolve())
    if changed and "--noise" in sys.argv:
        kept = case.path.read_text(encoding="utf-8").splitlines()
        lines = marked(kept, lines, case.tolerance) if len(lines) == len(kept) else lines
    elif changed and case.tolerance >= COARSE:
        with tempfile.TemporaryDirectory() as folder:
            os.environ["STRIBECK_BACKEND"] = "wasm"
            others = case.lines(Path(folder).resolve())
            del os.environ["STRIBECK_BACKEND"]
        lines = marked(lines, others, case.tolerance) if len(lines) == len(others) else lines
    if "--times" in sys.argv:
        print(f"{sum(os.times()[:4]) - start:6.2f} s {len(lines):5} lines {case.name}", flush=True)
    if changed:
        print(f"{case.name}: {len(changed)} lines of difference", *changed[:40], sep="\n")
        case.path.parent.mkdir(parents=True, exist_ok=True)
        case.path.write_text("\n".join(lines) + "\n", encoding="utf-8")
for path in () if sys.argv[1:] else OUTPUTS.rglob("*.txt"):
    if path not in {case.path for case in CASES}:
        print(f"{path.relative_to(OUTPUTS)}: no case any more")
        path.unlink()
