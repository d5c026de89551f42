"""The page of `make demo`: what it leaves, and its numbers."""

import json
import re

import pytest


@pytest.mark.thorough
def test_the_page_stands_alone(report):
    page = (report.folder / "report.html").read_text()
    figures = sorted(path.stem for path in (report.folder / "figures").glob("*.svg"))
    assert [name[:5] for name in figures if name.startswith("fig")] == [
        f"fig{n:02}" for n in (1, 2, 3, 4, 5, 6, 7, 8, 9, 10)
    ]
    assert {"joint", "axis"} <= set(figures)
    assert figures == sorted(path.stem for path in (report.folder / "figures").glob("*.png"))
    assert page.count("<svg") == page.count("</svg>") == len(figures)
    fetched = re.findall(r'(?:src|href)="(?!#)([^"]+)"|url\((?!#)([^)]+)\)|@import', page)
    assert fetched == []
    ids = re.findall(r'\bid="([^"]+)"', page)
    assert len(ids) == len(set(ids))
    assert sorted(report.data["files"]) == sorted(str(p) for p in report.folder.rglob("*") if p.is_file())
    assert json.loads((report.folder / "summary.json").read_text()) == report.data


@pytest.mark.thorough
def test_numbers(report):
    """Known numbers, by two solvers of others on independently written equations."""
    chapters = report.data["chapters"]
    y = chapters["presliding"]["y"]
    one, two, three = list(y)[1:]
    assert y["lugre"] == pytest.approx([44.86e-6, 45.31e-6, -9.564e-6, -10.02e-6], rel=1e-3)
    assert y[one] == pytest.approx([69.27e-6, 133.0e-6, 45.19e-6, -18.55e-6], rel=1e-3)
    assert y[two] == pytest.approx([47.47e-6, 54.25e-6, -4.292e-6, -11.07e-6], rel=1e-3)
    assert y[three] == pytest.approx([45.12e-6, 46.21e-6, -9.040e-6, -10.13e-6], rel=1e-3)
    assert list(chapters["presliding"]["deviation_of_peak"].values()) == pytest.approx([1.94, 0.197, 0.0198], rel=5e-3)
    assert list(chapters["stick_slip"]["y_end"].values()) == pytest.approx(
        [3.306801, 3.373043, 3.313143, 3.307430], abs=1e-6
    )
    cycle = chapters["limit_cycle"]
    assert [cycle["amplitude"][k] for k in ("lugre", one)] == pytest.approx([0.063902, 0.063093], abs=1e-6)
    assert [cycle["period"][k] for k in ("lugre", one)] == pytest.approx([24.44, 24.64], abs=5e-3)
    assert list(cycle["overshoot"].values()) == pytest.approx([1.50047] * 4, abs=1e-5)
    away = chapters["break_away"]
    known = {1.0: 1.43242, 5.0: 1.31321, 10.0: 1.21995, 20.0: 1.09861, 30.0: 1.02449, 40.0: 1.00425, 50.0: 1.00747}
    result = dict(zip(away["rates"], away["forces"]["lugre"], strict=True))
    assert {rate: result[rate] for rate in known} == pytest.approx(known, abs=1.1e-5)
    assert 0 < away["largest_shortfall"][two] < 5e-4
    assert 0 < away["largest_shortfall"][one] < 4.1e-3
    sine, sawtooth = chapters["evidence"]["drift"].values()
    assert sine["lugre"] == pytest.approx(0.24e-3, rel=0.01)
    assert sawtooth["elastoplastic_sobczyk"] / 16 == pytest.approx(1.1e-6, rel=0.05)
    for law in ("elastoplastic", "elastoplastic_majorant"):
        assert abs(sine[law]) < 1e-15
        assert abs(sawtooth[law]) < 1e-15
    verdicts = list(chapters["statements"].values())
    assert verdicts.count("not confirmed") == 2
    assert verdicts.count("confirmed with a remark") == 2
    assert len(verdicts) == 8
