"""How much memory there is, to refuse an output that cannot fit."""

from __future__ import annotations

import contextlib
import math
import os
from pathlib import Path

ROWS_LARGEST = 10**15  # more than any machine holds, and still exact in a float


def rows(t_end: float, step: float) -> int:
    """How many rows an output has: i * step for i = 0 ... floor(t_end/step + 1e-9)."""
    ratio = t_end / step + 1e-9
    return math.floor(ratio) + 1 if ratio < ROWS_LARGEST else ROWS_LARGEST


def available() -> float:
    """Bytes of memory that a process may still use; infinite where the system does not say."""
    limits = []
    with contextlib.suppress(OSError):
        lines = Path("/proc/meminfo").read_text(encoding="ascii").splitlines()
        limits += [float(line.split()[1]) * 1024 for line in lines if line.startswith("MemAvailable:")]
    with contextlib.suppress(OSError, ValueError):
        limits.append(float(Path("/sys/fs/cgroup/memory.max").read_text(encoding="ascii")))
    if not limits and hasattr(os, "sysconf") and "SC_PHYS_PAGES" in os.sysconf_names:
        limits.append(float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")))
    return min(limits, default=float("inf"))


def size(count: float) -> str:
    """A number of bytes for people: '3.2 GB'."""
    for unit in ("bytes", "kB", "MB", "GB", "TB", "PB"):
        if count < 1000:
            return f"{count:.3g} {unit}"
        count /= 1000
    return f"{count:.3g} EB"
