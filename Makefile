# make setup | demo | docs | test | thorough | learning | bench | fuzz | proofs | windows | floors | dist   (Python 3.11 or newer; a C compiler makes it fast)
PYTHON ?= $(firstword $(foreach p,python3.13 python3.12 python3.11 python3,$(if $(shell $(p) -c 'import sys; print(sys.version_info >= (3, 11) or "")' 2>/dev/null),$(p))))
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready

# bytecode is kept: each command of the tests would compile its libraries anew
unexport PYTHONDONTWRITEBYTECODE

.PHONY: setup demo docs test thorough learning bench fuzz proofs windows floors dist clean

# install EXTRA: the package with an extra, by uv where there is one
define install
	@if command -v uv >/dev/null 2>&1; then \
	    uv venv --quiet --allow-existing $(VENV) && uv pip install --quiet --python $(BIN)/python -e '.[$(1)]'; \
	else \
	    $(PYTHON) -m venv $(VENV) && $(BIN)/python -m pip install --quiet --disable-pip-version-check -e '.[$(1)]'; \
	fi
	@touch $@
endef

setup: $(READY)

$(READY): pyproject.toml
	$(call install,dev)

# what the pages of the report use; a developer's .venv has it too
$(VENV)/.demo: pyproject.toml
	$(call install,demo)

demo: $(if $(wildcard $(READY)),$(READY),$(VENV)/.demo)
	$(BIN)/python -m examples.paper --out stribeck-report

# the site: every page, the gallery's scripts run, live explorers, the references of Python and of the commands
docs: setup
	$(BIN)/python -m sphinx -W --keep-going -q -b html docs build/site
	@echo "open build/site/index.html"

test: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	MYPY_NUM_WORKERS=2 $(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/python -m pytest -n auto --dist worksteal -m "not thorough"

# the rest of the tests: whole families of cases of which 'make test' runs some
thorough: setup
	$(BIN)/python -m pytest -n auto --dist worksteal -m thorough

# the exports to PyTorch, JAX, MuJoCo Warp and Newton, run by these (some GB in a place of their own)
learning:
	$(PYTHON) -m venv build/learning
	build/learning/bin/python -m pip install --quiet --disable-pip-version-check -e '.[all]' pytest pytest-xdist hypothesis ruff \
	    fmpy torch jax mujoco-warp newton
	build/learning/bin/python -m pytest -n auto -m "" tests/exports/test_learning.py tests/exports/test_jax.py \
	    tests/exports/test_loads.py tests/exports/test_tools_document.py

bench: setup
	-xargs -n1 $(BIN)/python -m pip install --quiet --disable-pip-version-check < benchmarks/requirements.txt
	$(BIN)/python benchmarks/run.py

# installs nothing; without coqc it says so, in a line, and checks nothing
proofs:
	@if [ -x $(BIN)/python ]; then p=$(BIN)/python; else p='$(PYTHON)'; fi; $$p proofs/check.py || [ $$? -eq 3 ]

# SEED=7 for another attack, ONLY=kills for one part (parameters, machines, mutations); Ctrl-C tells how far it came
fuzz: setup
	$(BIN)/python tools/fuzz/run.py --seed $(or $(SEED),1) $(addprefix --only ,$(ONLY))

# Windows' Python under wine and the suite there (tools/windows/README.md); TESTS=tests/cli for some of it
windows:
	bash tools/windows/run.sh build/windows . $(TESTS)

# the tests with the oldest releases that pyproject.toml allows, which Python 3.11 can install
floors:
	python3.11 -m venv build/floors
	build/floors/bin/python -m pip install --quiet --disable-pip-version-check -e '.[all]' pytest pytest-xdist hypothesis jsonschema ruff -c tools/floors.txt
	build/floors/bin/python -m pytest -n auto --dist worksteal -m "not thorough" -o filterwarnings=default

# the sdist and the wheel, checked as a package index would
dist: setup
	rm -rf dist
	$(BIN)/python -m pip install --quiet --disable-pip-version-check build twine check-wheel-contents
	$(BIN)/python -m build --outdir dist .
	$(BIN)/python -m twine check --strict dist/*
	$(BIN)/check-wheel-contents dist/*.whl

clean:
	rm -rf $(VENV) build docs/made dist src/*.egg-info stribeck-report
