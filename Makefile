.DEFAULT_GOAL := help
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
# Write .pyc files even if the environment forbids it: otherwise each program that tests start compiles all modules again.
TESTED := PYTHONDONTWRITEBYTECODE= $(BIN)/python -m pytest -n auto --dist worksteal

# Sources of the native code: it is built again when one of them changes.
CORE := $(wildcard src/rvmon/core/native/*.[ch] src/rvmon/core/native/*/*.[ch] src/rvmon/models/native/*.[ch] src/rvmon/recordings/native/*.[ch]) src/rvmon/native/sources.py hatch_build.py
WARNINGS := -Wall -Wextra -Wconversion -Wshadow -pedantic -Werror

.PHONY: help demo core test quick check sanitize docs format bench claims fuzz extension release clean

help:  ## show this list
	@awk -F':.*## ' '/^[a-z]+:.*## / {printf "  make %-8s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

demo: $(VENV)/.demo  ## Table 1: hundreds of simulated handovers, judged; results in out/demo
	@$(BIN)/handover demo --out out/demo

core: | $(BIN)/python  ## compile the native code in place, 6 seconds; warnings are errors
	@CFLAGS="$(WARNINGS) $$CFLAGS" $(BIN)/python hatch_build.py

test: $(VENV)/.dev  ## run all tests, 5 minutes on 2 cores; ends with the seconds of each folder
	@$(TESTED)

quick: $(VENV)/.dev  ## run the tests that need no compiler, browser or robot and are fast, 25 seconds on 2 cores
	@$(TESTED) -m "not (browser or campaign or compiler or law or process or slow)" tests

check: $(VENV)/.dev $(VENV)/.docs  ## lint, types, layers, C by gcc and clang, the documentation without warnings
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .
	@$(BIN)/rvmon format --check $$(find specs examples -name '*.rv')
	@$(BIN)/mypy
	@$(BIN)/lint-imports
	@$(BIN)/python .ci/lint_c.py $(WARNINGS)
	@$(BIN)/python -m sphinx -W --keep-going -q docs out/docs

sanitize: $(VENV)/.dev  ## run the tests of the native code under AddressSanitizer and UBSan
	@$(BIN)/python -m fuzz.sanitize

docs: $(VENV)/.docs  ## make the documentation site, without warnings: out/docs/index.html
	@$(BIN)/python -m sphinx -W --keep-going -q docs out/docs
	@$(BIN)/python -m tests.docs.pages
	@echo "out/docs/index.html"

format: $(VENV)/.dev  ## format the code and sort imports
	@$(BIN)/ruff check --fix .
	@$(BIN)/ruff format .

bench: $(VENV)/.dev  ## time monitors against peers, 17 minutes; writes benchmarks/RESULTS.md; R2U2=FOLDER: a clone
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check -e '.[dev,arrow]' \
	  || echo "rvmon: pyarrow does not install here: Parquet is not measured"
	@$(BIN)/python -m benchmarks.results --out benchmarks/RESULTS.md $(if $(R2U2),--r2u2 $(R2U2))

claims: $(VENV)/.dev  ## check the claims of docs/claims.md, 3 minutes; LONG=1: all of them
	@$(BIN)/python -m benchmarks.claims $(if $(LONG),--long)

extension:  ## package the extension of VS Code, from locked dependencies: dist/rvmon.vsix
	@mkdir -p dist
	@cd editors/vscode && npm ci --silent --no-audit --no-fund && npm run --silent package -- -o ../../dist/rvmon.vsix

release: $(VENV)/.dev  ## build wheel and sdist into dist, check them, install each extra alone; uploads nothing
	@$(BIN)/python .ci/release.py

fuzz: $(VENV)/.dev  ## feed damaged input to all readers, and to the native core, for SECONDS=600
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check 'atheris>=3,<4' \
	  || echo "rvmon: atheris does not install here"
	@$(BIN)/python -m fuzz --seconds $(or $(SECONDS),600)

clean:  ## remove the environment and all output
	rm -rf $(VENV) out dist .mypy_cache .pytest_cache .ruff_cache .hypothesis src/rvmon/native/_core.*so

$(BIN)/python:
	@$(PYTHON) -m venv $(VENV) || { rm -rf $(VENV); \
	  echo "rvmon: '$(PYTHON) -m venv' does not work here. Mend: sudo apt-get install python3-venv"; exit 1; }

$(VENV)/.demo: pyproject.toml $(CORE) | $(BIN)/python
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check -e '.[handover]'
	@touch $@

$(VENV)/.dev: pyproject.toml $(CORE) | $(BIN)/python
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check -e '.[dev]'
	@touch $@ $(VENV)/.demo

$(VENV)/.docs: pyproject.toml | $(BIN)/python
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check -e '.[docs]'
	@touch $@
