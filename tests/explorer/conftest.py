"""One page for all tests: stick-slip with three laws."""

import json
import re

import pytest

from stribeck import examples
from stribeck.explorer import explore
from stribeck.scenario import Scenario

LAWS = ("lugre", "elastoplastic")


@pytest.fixture(scope="session")
def scenario():
    return Scenario.load(examples.path("stick_slip"), {"solve.rtol": 1e-10, "law.name": "lugre_majorant"})


@pytest.fixture(scope="session")
def built(scenario, tmp_path_factory):
    pytest.importorskip("bokeh")
    # two runs of one tolerance agree as far as that goes: at the usual 1e-8 F to some 4e-9 of its peak
    return explore(scenario, tmp_path_factory.mktemp("page") / "page.html", LAWS, command="stribeck explore stick_slip")


@pytest.fixture(scope="session")
def data(built):
    text = re.search(r'<script type="application/json" id="data">(.*?)</script>', built.read_text(), re.S)[1]
    return json.loads(text)
