# Every target sets itself up in .venv from requirements.lock; nothing else is needed but Python 3.11+, pip and make.
PYTHON ?= python3
BIN := .venv/bin
READY := .venv/.ready
SPECS := $(basename $(notdir $(wildcard specs/*.yaml)))

.PHONY: demo test lint bench mutate deletions examples docs lock clean

demo: $(READY)
	$(BIN)/plcgen demo .demo

test: $(READY)
	$(BIN)/python -m pytest -n auto -q

lint: $(READY)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

bench: $(READY)
	$(BIN)/python -m bench

mutate: $(READY)
	$(BIN)/python -m mutation

deletions: $(READY)
	$(BIN)/python -m mutation --deletions

examples: $(READY)
	@for name in $(SPECS); do $(BIN)/plcgen generate specs/$$name.yaml --out examples/$$name/expected --force --quiet || exit 1; done

docs: $(READY)
	$(BIN)/python -m plcgen.diagnostics.pages docs/codes

lock:
	$(BIN)/pip install --quiet pip-tools
	$(BIN)/pip-compile --quiet --extra dev --generate-hashes --allow-unsafe --strip-extras --no-header --no-annotate \
	  --no-emit-index-url --no-emit-trusted-host -o requirements.lock pyproject.toml

$(READY): requirements.lock pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "plcgen needs Python 3.11 or newer; try make PYTHON=python3.12")'
	@test -x $(BIN)/python || $(PYTHON) -m venv .venv || { echo "python3 has no venv: install python3-venv"; exit 1; }
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements.lock
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation -e .
	@touch $@

clean:
	rm -rf .venv .demo build dist .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache
