# Everything a fresh machine needs is installed from here: python3.11, gcc, node and make are enough.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.setup-stamp
WEB := web_assets
VENDOR_STAMP := $(WEB)/vendor/icons/LICENSE
NODE_STAMP := $(WEB)/node_modules/.check-stamp
NPM_CI := npm --prefix $(WEB) ci --ignore-scripts --no-audit --no-fund --loglevel=error
BROWSER_STAMP := $(VENV)/.browser-stamp
export OMP_NUM_THREADS ?= 1

.PHONY: setup run test test-long test-quick tables check docs format schema vendor bench pictures browser clean

setup: $(STAMP) vendor

# torch first and pinned: a range would fetch gigabytes of CUDA libraries.
$(STAMP): pyproject.toml constraints.txt
	test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check torch==2.13.0
	$(BIN)/pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[dev]'
	$(BIN)/python -m studio.robot.meshes
	touch $@

# Pictures and libraries of the page come from npm: what is served of them is copied out.
vendor: $(VENDOR_STAMP)
$(VENDOR_STAMP): $(WEB)/package.json $(WEB)/package-lock.json $(wildcard $(WEB)/*.js)
	$(NPM_CI) --omit=dev
	npm --prefix $(WEB) run -s vendor
	touch $@

# What checks the page's code; nothing of it is served.
$(NODE_STAMP): $(VENDOR_STAMP)
	$(NPM_CI)
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
test: setup browser $(NODE_STAMP)
	$(BIN)/pytest -n 2 --dist worksteal -m "not browser and not long"
	$(BIN)/pytest -m "browser and not long"

# What takes half a minute and more, a test.
test-long: setup browser $(NODE_STAMP)
	$(BIN)/pytest -m long

test-quick: setup
	$(BIN)/pytest -n 2 --dist worksteal -m "not slow and not browser"

# The API's schema, from which the page's types are made.
schema: setup
	$(BIN)/a1-studio openapi --json build/openapi.json

# The pages of the tables of safety and modes.
tables: setup
	$(BIN)/python -m studio.live.safety_table > docs/safety.md
	$(BIN)/python -m studio.live.mode_table > docs/modes.md

# The guide, as pages in build/docs.
docs: setup
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet --strict --config-file docs/mkdocs.yml

check: setup schema docs $(NODE_STAMP)
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/lint-imports
	$(BIN)/pyright
	npm --prefix $(WEB) run -s check

format: setup schema $(NODE_STAMP)
	$(BIN)/ruff format .
	$(BIN)/ruff check --fix .
	npm --prefix $(WEB) run -s format

bench: setup
	$(BIN)/a1-studio bench

# The README's pictures of the page, as it is now: minutes.
pictures: setup browser
	$(BIN)/python tests/web/pictures.py
	$(BIN)/python tests/web/scene_pictures.py

clean:
	rm -rf $(VENV) $(WEB)/cache $(WEB)/vendor $(WEB)/node_modules build dist *.egg-info
