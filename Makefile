# `make report` and `make test` each work as the first command on a fresh machine with python3 >= 3.11, venv and make.
PYTHON ?= python3
LEVEL ?= quick
OUT ?= reports/latest
BIN := .venv/bin
PEERS := .venv-peers
PEERS_OUT ?= reports/latest-peers
INSTALLED := .venv/.installed
DOCS_INSTALLED := .venv/.installed-docs
PARALLEL := -n auto --dist loadfile --no-loadscope-reorder

# Python keeps what it compiles, also where the environment says otherwise: the tests start hundreds of processes, and each
# would compile all libraries anew, which takes longer than most of what they do.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: report test docs environments lint wheel publish readme peers lock clean

# CASES="hertz-sphere hertz-ellipse": these alone.
report: $(INSTALLED)
	$(BIN)/samfem verify $(CASES) --level $(LEVEL) --out $(OUT)

# A process for each core, each with one thread; the tests of a file share what they have solved. The files in their order:
# by the number of their tests, as by default, the slowest would come last, on one core.
test: $(INSTALLED)
	$(BIN)/python -m pytest $(PARALLEL)

# Formatter, linter, spelling, who imports whom, types, dead code; pyproject.toml has the settings of each. About half a minute, with caches less.
lint: $(INSTALLED)
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/codespell
	$(BIN)/lint-imports --no-logo
	$(BIN)/mypy
	$(BIN)/vulture

# The wheel, in an environment of its own: without extras it solves, with `report` it runs these cases; CASES=quick: all of the
# quick level.
wheel: CASES ?= hertz-sphere mutation
wheel: $(INSTALLED)
	PYTHON=$(PYTHON) .ci/wheel $(CASES)

# The site in docs/_build/html: without a warning of Sphinx, without a broken link; the gallery runs, of its notebooks one.
docs: $(DOCS_INSTALLED)
	$(BIN)/python -m sphinx --quiet --fail-on-warning --keep-going docs docs/_build/html
	$(BIN)/python docs/tools/check_links.py docs/_build/html
	$(BIN)/python docs/tools/run_notebooks.py

# The tests again for each of the processors, languages, users, ... of other machines: ENVIRONMENTS="no-home ascii" for some,
# TESTS=tests/sam/test_wear.py for some of the tests.
environments: $(INSTALLED)
	$(BIN)/python tests/run_environments.py $(ENVIRONMENTS) --out reports/latest-environments.md -- $(PARALLEL) $(TESTS)

# Every case at the full level, on two processes, and the pages of them in $(PAGES). Each case is kept in $(KEPT) as it
# ends: stopped or killed, the same command goes on. Some cases: PUBLISH="pavement hertz-sphere" PAGES=/tmp/pages. The programs of `peers`
# are installed for all cases; where that fails, its page says that it did not run.
PAGES ?= reports
KEPT ?= reports/latest-publish
publish: $(INSTALLED)
	$(if $(PUBLISH),,-$(MAKE) $(PEERS)/.installed)
	SAMFEM_PEERS=$${SAMFEM_PEERS:-$$(ls $(PEERS)/bin/python 2>/dev/null)} $(BIN)/samfem publish $(PUBLISH) --level $(LEVEL) --out $(PAGES) --store $(KEPT)
publish: LEVEL = full

# The numbers of README.md, with its failed gates, and of the guide, from the published pages.
readme: $(INSTALLED)
	$(BIN)/python -m verification.suite.readme $(PAGES) README.md docs/guide/which-model.md

# Python compiles a module when it is first used: to compile all of them here would take another half a minute.
$(INSTALLED): requirements.lock pyproject.toml
	$(PYTHON) -c 'import sys; sys.exit(0 if sys.version_info >= (3, 11) else "python 3.11 or newer is needed")'
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile --require-hashes -r requirements.lock
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation -e .
	touch $@

$(DOCS_INSTALLED): $(INSTALLED) requirements-docs.lock
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile --require-hashes -r requirements-docs.lock
	touch $@

# SAM beside Tamaas, ContactMechanics and aspher, which have an environment of their own and are no dependency. aspher is
# compiled (a C++17 compiler; Eigen's headers: apt-get install libeigen3-dev); where that fails the page says so.
peers: $(INSTALLED) $(PEERS)/.installed
	SAMFEM_PEERS=$(PEERS)/bin/python $(BIN)/samfem verify peers periodic-peers --level full --out $(PEERS_OUT)

$(PEERS)/.installed: requirements-peers.lock requirements-aspher.lock
	$(PYTHON) -m venv $(PEERS)
	$(PEERS)/bin/python -m pip install --quiet --disable-pip-version-check --require-hashes --only-binary :all: \
		-r requirements-peers.lock
	$(PEERS)/bin/python -m pip install --quiet --disable-pip-version-check --require-hashes --no-build-isolation \
		-r requirements-aspher.lock || echo "aspher: not built"
	touch $@

# Rewrite the pins after a change of the dependencies (needs uv).
lock:
	uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --no-annotate --no-emit-index-url \
		--extra report --group dev pyproject.toml -o requirements.lock
	uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --no-annotate --no-emit-index-url \
		-c requirements.lock requirements-docs.in -o requirements-docs.lock
	uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --no-annotate --no-emit-index-url \
		requirements-peers.in -o requirements-peers.lock
	uv pip compile --quiet --universal --python-version 3.11 --generate-hashes --no-annotate --no-emit-index-url \
		-c requirements-peers.lock requirements-aspher.in -o requirements-aspher.lock

clean:
	rm -rf .venv $(PEERS) reports/latest $(PEERS_OUT) docs/_build docs/auto_gallery
