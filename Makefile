# Two commands: `make run` and `make test`. Both set up everything they need in .venv, once.

PYTHON ?= python3
VENV ?= .venv
ARGS ?=

# Tests run in a few processes, each file in one of them, in the order of tests/conftest.py. ARGS come later and win:
# -n0 runs them one after the other.
PYTEST := -m pytest -q -n auto --dist loadfile --no-loadscope-reorder

BIN := $(VENV)/bin
TORCH := $(shell sed -n 's/^torch==//p' constraints.txt)
INSTALL := $(BIN)/python -m pip install -qq --disable-pip-version-check -c constraints.txt

# The pins hold for what builds the package, too: older pips read the first variable there, newer ones the second.
export PIP_CONSTRAINT := constraints.txt
export PIP_BUILD_CONSTRAINT := constraints.txt

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.PHONY: help run test lint docs clean

help: ## Show this list
	@awk -F ':.*## ' '/^[a-z]+:.*## / { printf "make %-6s %s\n", $$1, $$2 }' $(firstword $(MAKEFILE_LIST))
	@echo 'Variables: ARGS goes to the command ("make run ARGS=--help"), PYTHON names the interpreter (3.11 or newer).'

run: $(VENV)/.run ## Run the default mission: report, picture and video in runs/
	@$(BIN)/legpush run $(ARGS)

test: lint ## Check style, types and import contracts, then run all tests
	@echo '==> tests'
	@$(BIN)/python $(PYTEST) $(ARGS)

lint: $(VENV)/.test ## Check style, types and import contracts
	@echo '==> style'
	@$(BIN)/ruff check
	@$(BIN)/ruff format --check
	@echo '==> types'
	@$(BIN)/mypy --num-workers 2
	@echo '==> import contracts'
	@$(BIN)/lint-imports

docs: $(VENV)/.test ## Build the documentation site in runs/site
	@$(BIN)/python -m sphinx -q -W --keep-going -b html -d runs/site-trees docs runs/site
	@echo 'runs/site/index.html'

clean: ## Remove the virtual environment, caches and builds; runs/ stays
	rm -rf $(VENV) dist .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

# What is installed is remembered by stamp files, which a changed declaration or pin makes stale.

$(BIN)/python:
	@echo '==> virtual environment in $(VENV)'
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { \
	  echo 'Expected Python 3.11 or newer, got '"$$($(PYTHON) --version 2>&1)"'; name another: make PYTHON=python3.12 ...' >&2; \
	  exit 1; }
	@$(PYTHON) -m venv $(VENV) || { \
	  rm -rf $(VENV); \
	  echo 'Python cannot make virtual environments here; on Debian and Ubuntu: apt install python3-venv' >&2; \
	  exit 1; }

# The CPU build of PyTorch saves gigabytes. It is taken from where pip is set up to look, else from PyTorch's own
# index, which uv knows by name.
$(VENV)/.torch: constraints.txt | $(BIN)/python
	@echo '==> PyTorch $(TORCH), CPU build (about 200 MB)'
	@$(INSTALL) 'torch==$(TORCH)+cpu' >$(VENV)/torch.log 2>&1 \
	|| { $(INSTALL) uv && $(BIN)/uv pip install --quiet --python $(BIN)/python --torch-backend cpu \
	     -c constraints.txt torch; } >>$(VENV)/torch.log 2>&1 \
	|| { echo '    not within reach (see $(VENV)/torch.log): taking the default build, several GB'; $(INSTALL) torch; }
	@touch $@

$(VENV)/.run: pyproject.toml constraints.txt $(VENV)/.torch
	@echo '==> legpush and what it runs with'
	@$(INSTALL) -e '.[all]'
	@touch $@

$(VENV)/.test: pyproject.toml constraints.txt $(VENV)/.torch
	@echo '==> legpush, what it runs with and the tools that check it'
	@$(INSTALL) -e '.[all,dev]'
	@touch $(VENV)/.run $@
