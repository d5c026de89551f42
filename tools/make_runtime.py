"""Builds the solver for WebAssembly, the same for every system: src/stribeck/codegen/runtime/runtime.wasm.

python tools/make_runtime.py        # after a change in runtime/; needs ziglang
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

from stribeck.codegen.source import PORTABLE, STRICT, runtime_text

TARGET = Path(__file__).parent.parent / "src" / "stribeck" / "codegen" / "runtime" / "runtime.wasm"
# -O2: runs take some 4 % less time than with -Os. The stack would be 16 MB in each instance.
FLAGS = (
    "-target", "wasm32-wasi", "-O2", "-fno-math-errno", "-mexec-model=reactor", "-Wl,--no-entry", "-Wl,--export-dynamic",
    "-Wl,--export=__heap_base", "-Wl,--export=shape", "-Wl,-z,stack-size=262144", "-Wl,--strip-all",
    "-Wno-gnu-folding-constant",
)  # fmt: skip


def text() -> str:
    """The C of the whole solver."""
    head = f"{PORTABLE}\n#include <math.h>\n#include <stddef.h>\n#include <stdint.h>\n"
    files = ("any.c", "method.c", "events.c", "run.c")
    parts = [head, runtime_text("scalar.c"), STRICT + runtime_text("portable.c"), *map(runtime_text, files)]
    return "\n\n".join(parts)


def build(target: Path) -> None:
    """Compile it to ``target``."""
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "runtime.c"
        source.write_text(text(), encoding="utf-8")
        subprocess.run([sys.executable, "-m", "ziglang", "cc", *FLAGS, "-o", str(target), str(source)], check=True)


if __name__ == "__main__":
    build(TARGET)
    print(TARGET.stat().st_size, "bytes")
