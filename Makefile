# `make run` and `make test` are each enough on a fresh machine with Python 3.11+, make and a network.

PYTHON ?= python3
BIN := .venv/bin
# Node comes from PyPI into the virtual environment, so that Python is all a fresh machine needs.
export PATH := $(CURDIR)/$(BIN):$(PATH)
export PIP_DISABLE_PIP_VERSION_CHECK := 1
# Where nothing compiled is kept, each of the many processes that tests start would compile every module anew.
unexport PYTHONDONTWRITEBYTECODE

# What does not wait for each other runs side by side: numba compiles on one processor, and on another one the screen
# is built and both halves are checked, which calls nothing that is compiled.
MAKEFLAGS += --jobs=2

.PHONY: setup screen browser run test check check-python check-screen test-screen format types lock bench clean

setup: .venv/.compiled screen

.venv/.installed: requirements-dev.txt pyproject.toml
	test -x $(BIN)/python || $(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --require-hashes -r requirements-dev.txt
	$(BIN)/python -m pip install --quiet --no-deps --no-build-isolation --editable .
	touch $@

.venv/.compiled: .venv/.installed
	$(BIN)/python -m estimator.warm
	touch $@

frontend/node_modules/.installed: .venv/.installed frontend/package.json frontend/package-lock.json
	cd frontend && npm ci --no-audit --no-fund --loglevel=error
	touch $@

screen: backend/screen/index.html

backend/screen/index.html: frontend/node_modules/.installed frontend/index.html frontend/vite.config.ts $(shell find frontend/src frontend/public -type f 2>/dev/null)
	cd frontend && npm run build --silent
	touch $@

# The end-to-end tests drive a browser: Debian's, where we may install it; elsewhere the tests say what to install.
browser:
	@command -v chromium >/dev/null || { test "$$(id -u)" = 0 && test -e /etc/debian_version \
		&& apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq chromium >/dev/null; } || true

run: setup
	$(BIN)/firethread serve --data .data --open --demo

# A worker for each core and one that waits (tests/conftest.py); worksteal keeps most modules on one of them.
test: setup browser check test-screen
	$(BIN)/pytest --numprocesses=auto --dist=worksteal

check: check-python check-screen

check-python: .venv/.installed
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/firethread openapi | cmp - frontend/openapi.json || { echo "the API has changed: run 'make types'"; exit 1; }

check-screen: frontend/node_modules/.installed
	cd frontend && npm run check --silent

test-screen: frontend/node_modules/.installed
	cd frontend && npm test --silent

format: setup
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .
	cd frontend && npm run format --silent

types: setup
	$(BIN)/firethread openapi > frontend/openapi.json.new
	mv frontend/openapi.json.new frontend/openapi.json
	cd frontend && npm run types --silent

bench: setup
	$(BIN)/firethread bench all

lock:
	$(BIN)/uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --no-emit-index-url \
		--no-annotate --no-header pyproject.toml -o requirements.txt
	$(BIN)/uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --no-emit-index-url \
		--no-annotate --no-header --group dev -c requirements.txt pyproject.toml -o requirements-dev.txt
	cd frontend && npm install --package-lock-only --no-audit --no-fund

clean:
	rm -rf .venv .data backend/screen frontend/node_modules frontend/dist
