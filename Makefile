# Every target sets itself up in $(VENV) from requirements.lock; nothing else is needed but Python 3.11+, pip and make.
PYTHON ?= python3
VENV ?= .venv
# With LOWEST=1 an environment gets the lowest versions that pyproject.toml allows.
LOWEST ?=
BIN := $(VENV)/bin
READY := $(VENV)/.ready
# The tests start hundreds of processes: compiled modules are kept, whatever the caller's environment says.
unexport PYTHONDONTWRITEBYTECODE
SPECS := $(basename $(notdir $(wildcard specs/*.yaml)))

.PHONY: demo test slow fast sample coverage lint hostile fuzz bench house pairs engine mutate deletions beliefs damages examples example-diff docs site pictures editor vsix lock clean

demo: $(READY)
	$(BIN)/plcgen demo .demo

test: $(READY)
	$(BIN)/python -m pytest -n auto --dist worksteal -q

slow: $(READY)
	$(BIN)/python -m pytest -n auto --dist worksteal -q -m slow

fast: $(READY)
	$(BIN)/python -m pytest -n auto --dist worksteal -q -m "not slow"

# The fast tests of what depends on libraries, and of what is different on every machine.
SAMPLE := base build cli ds47/live project s7/xml workbench test_cases.py test_schemas.py
sample: $(READY)
	$(BIN)/python -m pytest -n auto --dist worksteal -q -m "not slow" $(SAMPLE:%=tests/%)

coverage: $(READY)
	$(BIN)/python -m pytest -n auto --dist worksteal -q -m "not slow" --cov --cov-report=term:skip-covered

lint: $(READY)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/zizmor --offline --no-progress --quiet --persona=auditor .github action.yml

# Every character that is none of a text, at every place of every file in which a text may stand.
hostile: $(READY)
	PLCGEN_HOSTILE=1 $(BIN)/python -m pytest -q -n auto --dist worksteal tests/test_every_text.py tests/test_wrong_shapes.py tests/test_injections.py

# Damaged packets for both ends of PROFINET's records.
fuzz: $(READY)
	PLCGEN_FUZZ=100000 $(BIN)/python -m pytest -q tests/ds47/live/test_pn_fuzz.py

bench: $(READY)
	$(BIN)/python -m tests.bench $(if $(SHORT),--short)

# How large the package is: lines, small files, functions that are used once, circles.
house: $(READY)
	$(BIN)/python -m tests.bench.house

# Specs in which every possible pair of values of every two keys occurs: each works, or is refused for the reason that is known.
pairs: $(READY)
	$(BIN)/python -m tests.pairs --effort $(or $(EFFORT),none)

# Proves every engine there is, for every target in every size, and records it: after a change of its templates.
engine: $(READY)
	@rm -rf .engine && mkdir .engine
	$(BIN)/python -m tests.engine.folders .engine > .engine/list
	$(BIN)/python -m tests.engine $(EFFORT) `grep S$$ .engine/list` `grep -v S$$ .engine/list`

mutate: $(READY)
	$(BIN)/python -m tests.mutation

deletions: $(READY)
	$(BIN)/python -m tests.mutation --deletions

# Facts of the source, broken one at a time.
beliefs: $(READY)
	$(BIN)/python -m tests.mutation.beliefs

# Every damage to what people read: titles, comments, guides, tables, manifest.
damages: $(READY)
	PLCGEN_DAMAGES=1 $(BIN)/python -m pytest -n auto -q tests/proof/test_damages.py

# Complete where the folder expected/ exists, else only the manifest with its hashes.
examples: $(READY)
	@rm -rf .examples
	@for name in $(SPECS); do \
	  out=examples/$$name/expected; test -d $$out || out=.examples/$$name; \
	  $(BIN)/plcgen generate specs/$$name.yaml --out $$out --force --quiet || exit 1; \
	  test $$out = examples/$$name/expected || cp $$out/manifest.json examples/$$name/ || exit 1; \
	done
	@$(BIN)/python -m tests.build.versions

# Every line of every example that differs from what the commit BASE generates.
BASE ?= HEAD
example-diff: $(READY)
	@rm -rf .examples && mkdir -p .examples/base .examples/before
	@git archive $(BASE) plcgen templates specs | tar -x -C .examples/base
	@for name in $(SPECS); do \
	  test ! -f .examples/base/specs/$$name.yaml || \
	    (cd .examples/base && $(CURDIR)/$(BIN)/python -m plcgen generate specs/$$name.yaml --out ../before/$$name --quiet) || exit 1; \
	  $(BIN)/python -m plcgen generate specs/$$name.yaml --out .examples/after/$$name --quiet || exit 1; \
	done
	@git --no-pager diff --no-index .examples/before .examples/after || true

docs: $(READY)
	$(BIN)/python -m plcgen.base.diagnostics.pages docs/codes

# The documentation as a site, in the folder site; MkDocs has an environment of its own.
SITE := .venv-site/bin
# Packages of a dependency group: the pip of Python 3.11 has no --group.
GROUP := $(PYTHON) -c 'import sys, tomllib; print(*tomllib.load(open("pyproject.toml", "rb"))["dependency-groups"][sys.argv[1]], sep="\n")'
site:
	@test -x $(SITE)/mkdocs || { $(PYTHON) -m venv .venv-site && $(GROUP) site > .venv-site/site.in && \
	  $(SITE)/pip install --quiet --disable-pip-version-check -r .venv-site/site.in .; }
	NO_MKDOCS_2_WARNING=1 $(SITE)/mkdocs build --strict --config-file .github/mkdocs.yml

# The extension for VS Code, dist/plcgen.vsix; needs npm. What it runs with is locked, vsce only packs it.
vsix:
	@rm -rf .vsix && cp -r docs/editors/vscode .vsix && cp LICENSE .vsix && mkdir -p dist
	cd .vsix && npm ci --silent --no-audit --no-fund --ignore-scripts && \
	  npx --yes @vscode/vsce@3.6.2 package --no-git-tag-version --allow-missing-repository --out ../dist/plcgen.vsix >.log 2>&1 || \
	  { cat .log; exit 1; }

# Screenshots of review pages for the documentation; needs Chromium.
pictures: $(READY)
	$(BIN)/python -m tests.docs.make_pictures

# CodeMirror for the page of plcgen serve, from the packages of its lock file; lies in the wheel, not in the repository.
EDITOR := plcgen/workbench/serve
editor:
	@mkdir -p .venv-editor && cp $(EDITOR)/editor/* .venv-editor
	cd .venv-editor && npm ci --silent --no-audit --no-fund --ignore-scripts && node bundle.js ../$(EDITOR)/page

# Everything for development; what plcgen needs, what builds it, what lists its parts: all by hash.
FLOORS = jinja2==3.1.5 lxml==5.4.0 click==8.2.1 pydantic==2.12.0 PyYAML==6.0.2 starlette==0.46.0 uvicorn==0.34.0
COMPILE = $(BIN)/pip-compile --quiet --generate-hashes --allow-unsafe --strip-extras --no-header --no-annotate \
  --no-emit-index-url --no-emit-trusted-host --no-emit-find-links
lock:
	$(BIN)/pip install --quiet pip-tools
	$(GROUP) dev > $(VENV)/dev.in
	$(COMPILE) -o requirements.lock pyproject.toml $(VENV)/dev.in
	@for name in runtime build sbom; do cp requirements.lock .ci/$$name.lock; done # the versions to begin with
	$(COMPILE) -o .ci/runtime.lock pyproject.toml
	printf 'build\nhatchling\n' | $(COMPILE) -o .ci/build.lock -
	printf 'cyclonedx-bom\n' | $(COMPILE) -o .ci/sbom.lock -
	printf '%s\n' $(FLOORS) pydantic-core==2.41.1 | $(COMPILE) -o .ci/lowest.lock -

$(READY): requirements.lock pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "plcgen needs Python 3.11 or newer; try make PYTHON=python3.12")'
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV) || { echo "python3 has no venv: install python3-venv"; exit 1; }
	@$(BIN)/python -m pip install -qq --disable-pip-version-check --require-hashes --no-deps -r requirements.lock
	@$(BIN)/python -m pip install -qq --disable-pip-version-check --no-deps --no-build-isolation -e .
	@test -z "$(LOWEST)" || $(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes --no-deps -r .ci/lowest.lock
	@touch $@

clean:
	rm -rf .venv .venv-* .vsix site .coverage .demo .examples build dist .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache
