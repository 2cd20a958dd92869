# The verbs of the house. PYTHON=python3.13 selects the interpreter; everything lives in .venv.
PYTHON ?= python3
VENV   ?= .venv
BIN    := $(VENV)/bin
READY  := $(VENV)/.ready-$(notdir $(PYTHON))

.PHONY: run test quick check types page bench clean

run: $(READY)            ## start the service on a simulated ceiling camera
	$(BIN)/pslv serve

# ARGS may select tests of one kind only: 5 is pytest's exit status where it selects none.
test: $(READY)           ## all tests: side by side, then one after the other those that run a whole service or a browser
	$(BIN)/python web/build.py || echo "the page cannot be built here: its tests are skipped"
	PSLV_DATA_DIR=$(CURDIR)/.pslv $(BIN)/pslv compile
	$(BIN)/python -m pytest -m "not service" -n auto --maxprocesses 4 --dist loadfile $(ARGS) || [ $$? = 5 ]
	$(BIN)/python -m pytest -m service $(ARGS) || [ $$? = 5 ]

quick: $(READY)          ## the tests that take under a minute together
	$(BIN)/python -m pytest -m "not slow and not browser" $(ARGS)

check: $(READY)          ## style, types, import rules, spelling
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports --no-cache
	$(BIN)/python web/build.py check
	$(BIN)/codespell README.md CHANGELOG.md CONTRIBUTING.md docs vision_core app web config tests bench examples

types: $(READY)          ## the front end's types, from the API
	$(BIN)/python -m app.commands.openapi > web/openapi.json
	$(BIN)/python web/build.py types

page: $(READY)           ## build the page, check its types, run its tests
	$(BIN)/python web/build.py check

bench: $(READY)          ## every published figure, measured
	$(BIN)/python -m bench

clean:
	rm -rf .venv .pslv .mypy_cache .ruff_cache .pytest_cache .hypothesis

$(READY): pyproject.toml
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "PSLV needs Python 3.11 or newer; PYTHON=... selects one")'
	rm -rf $(VENV)
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e '.[dev]'
	touch $@
