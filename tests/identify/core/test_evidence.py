"""docs/evidence/static-fits.md is what its benchmark makes of its counts."""

import importlib.util
import json
import sys
from pathlib import Path

ROOT = Path(__file__).parents[3]


def test_the_page_is_made_by_the_benchmark(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    spec = importlib.util.spec_from_file_location("estimates", ROOT / "benchmarks" / "estimates.py")
    module = importlib.util.module_from_spec(spec)
    monkeypatch.setitem(sys.modules, "estimates", module)
    spec.loader.exec_module(module)
    kept = json.loads((ROOT / "benchmarks" / "results" / "estimates.json").read_text(encoding="utf-8"))
    assert (ROOT / "docs" / "evidence" / "static-fits.md").read_text(encoding="utf-8") == module.page(kept)
