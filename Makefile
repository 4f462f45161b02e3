# The demonstration and the checks, on a machine with Python 3.11 or newer, git and make.
#
#   make demo    install, then write the report of the published results to reproduction/
#   make test    install with the development tools, then every check and the tests
#   make lint    the checks without the tests
#   make bundle  the programs of a study's pages, from their sources in frontend/
#
# PYTHON=/path/to/python chooses the interpreter. Everything is installed in .venv, which belongs
# to this file: an unfinished one is removed and made again.

VENV := .venv
BIN := $(VENV)/bin
REQUIREMENTS := pyproject.toml constraints.txt
INSTALL := $(BIN)/python -m pip --disable-pip-version-check install --constraint constraints.txt

.PHONY: help demo test lint bundle
.NOTPARALLEL:
.DEFAULT_GOAL := help

help:
	@sed -n 's/^#   //p' Makefile

demo: $(VENV)/.installed
	$(BIN)/coadapt reproduce --out reproduction

test: lint bundle
	$(BIN)/python -m pytest -n auto --maxprocesses 4 --dist loadfile

bundle: $(VENV)/.installed-dev
	$(BIN)/python frontend/bundle.py

lint: $(VENV)/.installed-dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/basedpyright --pythonpath $(BIN)/python
	$(BIN)/lint-imports --no-logo
	$(BIN)/python frontend/bundle.py --check

# The stamps live inside the environment, so they go when it goes. `.created` is absent while pip
# runs: an installation that was cut short starts again from an empty environment.
$(VENV)/.installed: $(REQUIREMENTS) | $(VENV)/.created
	@rm -f $(VENV)/.created
	$(INSTALL) --editable .
	@touch $(VENV)/.created $@

$(VENV)/.installed-dev: $(REQUIREMENTS) | $(VENV)/.created
	@rm -f $(VENV)/.created
	$(INSTALL) --editable ".[dev]"
	@touch $(VENV)/.created $(VENV)/.installed $@

$(VENV)/.created:
	@usable() { "$$1" -c 'import sys, ensurepip, venv; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; }; \
	chosen='$(PYTHON)'; \
	if [ -z "$$chosen" ]; then \
		for candidate in python3.14 python3.13 python3.12 python3.11 python3; do \
			if usable "$$candidate"; then chosen="$$candidate"; break; fi; \
		done; \
	fi; \
	if [ -z "$$chosen" ]; then \
		echo "coadapt needs Python 3.11 or newer with its venv module, and found none." >&2; \
		echo "Install one (on Debian and Ubuntu also python3-venv), or name it: make $(firstword $(MAKECMDGOALS)) PYTHON=/path/to/python" >&2; \
		exit 1; \
	fi; \
	if ! usable "$$chosen"; then \
		echo "PYTHON=$$chosen is not a Python 3.11 or newer with its venv module." >&2; \
		exit 1; \
	fi; \
	echo "Making $(VENV) with $$("$$chosen" --version)"; \
	rm -rf $(VENV); \
	"$$chosen" -m venv $(VENV)
	@touch $@
