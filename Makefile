# Everything a fresh machine needs is installed from here: python3.11, gcc, node and make are enough.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.setup-stamp
BROWSER_STAMP := $(VENV)/.browser-stamp
export OMP_NUM_THREADS ?= 1

.PHONY: setup run test test-quick check format bench browser clean

setup: $(STAMP)

# torch first and pinned: a range would fetch gigabytes of CUDA libraries.
$(STAMP): pyproject.toml constraints.txt
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check torch==2.13.0
	$(BIN)/pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[dev]'
	$(BIN)/python -m studio.sim.visual
	touch $@

run: setup
	$(BIN)/a1-studio serve

# A browser for the page tests: Debian's package where we may install it, else Playwright's own.
browser: $(BROWSER_STAMP)
$(BROWSER_STAMP): $(STAMP)
	@if command -v chromium >/dev/null || command -v google-chrome >/dev/null; then echo "browser: found"; \
	elif command -v apt-get >/dev/null && [ "$$(id -u)" = 0 ]; then apt-get update -qq && apt-get install -y -qq chromium; \
	else $(BIN)/playwright install chromium; fi
	touch $@

# Two workers for two cores; a browser with software graphics wants both to itself.
test: setup browser
	$(BIN)/pytest -n 2 --dist worksteal -m "not browser"
	$(BIN)/pytest -m browser

test-quick: setup
	$(BIN)/pytest -n 2 --dist worksteal -m "not slow and not browser"

check: setup
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/lint-imports
	$(BIN)/pyright

format: setup
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .

bench: setup
	$(BIN)/a1-studio bench

clean:
	rm -rf $(VENV) web_assets/cache build dist *.egg-info
