# Every target sets up what it needs, in .venv beside this file.
PYTHON ?= python3
WORKERS ?= 2
BIN := .venv/bin
PYTEST := $(BIN)/pytest -n $(WORKERS) --dist worksteal --durations 15 -p nbmake --nbmake $(wildcard notebooks) tests
EXTRAS := dev,docs,notebooks,vision,page,cluster,bench

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.PHONY: help browser demo test test-all lint type format docs bench results notebook constraints clean

help: ## list the targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-12s %s\n", $$1, $$2 }' Makefile

demo: .venv/.installed-core ## the main job: verify, compare, simulate; leaves pictures and a table in out/demo
	$(BIN)/python -m surveillance_domain.commands.demo --out out/demo

test: .venv/.installed-dev browser ## the fast tests, notebooks included
	$(PYTEST) -m "not slow"

test-all: .venv/.installed-dev browser ## every test, the slow ones too
	$(PYTEST)

lint: .venv/.installed-dev ## style, format, and the floors of the house
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/lint-imports --no-logo

type: .venv/.installed-dev ## static types
	$(BIN)/mypy

format: .venv/.installed-dev ## put every file into shape
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

docs: .venv/.installed-dev ## build the documentation site into out/site; a warning or a dead link is a failure
	$(BIN)/pytest -q tests/test_documentation_links.py
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet
	@echo "The site stands in out/site; open out/site/index.html"

bench: .venv/.installed-bench ## measure speed, against the rivals too
	$(BIN)/python -m benchmarks.run

results: .venv/.installed-$(if $(FULL),dev,core) ## the pages of results with a few runs a point, in out/results/quick; with FULL=1 as published, in docs (hours)
	$(BIN)/python benchmarks/results.py $(if $(FULL),--full)
	$(if $(FULL),$(BIN)/python benchmarks/results_myopia.py)
	$(if $(FULL),$(BIN)/python benchmarks/results_pictures.py)

notebook: .venv/.installed-notebooks ## open the notebooks
	$(BIN)/jupyter notebook --notebook-dir=notebooks

constraints: $(BIN)/pip ## pin the newest versions that fit together, in constraints.txt
	$(BIN)/pip install -q --dry-run --ignore-installed --report .venv/resolved.json ".[$(EXTRAS)]"
	@printf '%s\n' '# Versions that are known to work together: `pip install -c constraints.txt -e .[dev]`.' \
	    '# Written by `make constraints` for every extra, on Python 3.11; not to be edited by hand.' > .venv/constraints.txt
	@$(BIN)/python -c 'import json; \
	    found = [entry["metadata"] for entry in json.load(open(".venv/resolved.json"))["install"]]; \
	    pins = [m["name"] + "==" + m["version"] for m in found if m["name"] != "factored-pomdp"]; \
	    print(*sorted(pins, key=str.lower), sep="\n")' >> .venv/constraints.txt
	@mv .venv/constraints.txt constraints.txt

clean: ## remove the environment and everything that was made
	rm -rf .venv out build dist .pytest_cache .mypy_cache .ruff_cache .hypothesis .import_linter_cache .benchmarks *.egg-info
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

# ------------------------------------------------------------------------------------------------------ the environment
.venv/.installed-core: extras =
.venv/.installed-dev: extras = [dev,docs,vision,page,cluster]
.venv/.installed-notebooks: extras = [notebooks]
.venv/.installed-bench: extras = [dev,docs,vision,page,cluster,bench]
.venv/.installed-core .venv/.installed-dev .venv/.installed-notebooks .venv/.installed-bench: pyproject.toml constraints.txt | $(BIN)/pip
	@echo "Installing factored-pomdp$(extras) into .venv (the first time takes a minute or two) ..."
	@$(BIN)/pip install -q -c constraints.txt -e ".$(extras)"
	@touch $@

$(BIN)/pip:
	@command -v $(PYTHON) > /dev/null || { echo "No '$(PYTHON)' here. Install Python 3.11 or newer, or name one: make PYTHON=python3.12 ..." >&2; exit 2; }
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { \
	    echo "Python 3.11 or newer is needed, but $(PYTHON) is $$($(PYTHON) --version 2>&1). Name another: make PYTHON=python3.12 ..." >&2; exit 2; }
	@$(PYTHON) -c 'import ensurepip, venv' 2> /dev/null || { \
	    if [ "$$(id -u)" = 0 ] && command -v apt-get > /dev/null; then apt-get update -q && apt-get install -q -y python3-venv; \
	    else echo "$(PYTHON) cannot make virtual environments. On Debian and Ubuntu: sudo apt-get install python3-venv" >&2; exit 2; fi; }
	@$(PYTHON) -m venv .venv

browser: ## chromium for the tests of the live page, from Debian; without it they are skipped
	@command -v chromium > /dev/null && command -v chromedriver > /dev/null || { \
	    echo "The tests of the live page need chromium and chromedriver." >&2; \
	    if [ "$$(id -u)" = 0 ] && command -v apt-get > /dev/null; then \
	        apt-get update -q && apt-get install -q -y --no-install-recommends chromium chromium-driver; \
	    else false; fi; } || echo "They are skipped. On Debian: sudo apt-get install chromium chromium-driver" >&2
