# Needs Python 3.11 or newer and make; uses uv where it is installed, else pip. Everything lands in .venv.
PYTHON ?= python3
VENV   := .venv
BIN    := $(VENV)/bin
READY  := $(VENV)/.ready
BROWSER := $(VENV)/.ready-browser
TOOLS  := $(VENV)/.ready-tools
DOCS   := $(VENV)/.ready-docs

# A test that does not end is ended with its traceback after four minutes, and the others go on (pytest 9; before, the traceback alone).
FINITE := -o faulthandler_timeout=240 -o faulthandler_exit_on_timeout=true

# Those with a mark of pytest, `quick`, so that no module without one is imported.
WORKERS := -n auto
QUICK  := -m pytest -q $(WORKERS) $(FINITE) -m "quick and not slow" $(shell grep -l 'mark\.quick' tests/test_*.py)
UV     := $(or $(shell command -v uv),$(BIN)/uv)

# Where bytecode is not kept, each worker and each command compiles all modules anew.
unexport PYTHONDONTWRITEBYTECODE

# One BLAS thread for each test worker: two workers with two threads each slow each other down several times.
ONE_THREAD := OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1 MKL_NUM_THREADS=1

# $(call install,EXTRA): the package with an extra at the versions of requirements.lock, bytecode compiled.
define install
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' \
		|| { echo "stribeck needs Python 3.11 or newer; say which with make PYTHON=/path/to/python3"; exit 1; }
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	@if command -v uv >/dev/null; then \
		uv pip install --quiet --compile-bytecode --python $(BIN)/python -c requirements.lock --editable '.[$(1)]'; else \
		$(BIN)/python -m pip install --quiet --disable-pip-version-check -c requirements.lock --editable '.[$(1)]'; fi
	@touch $@
endef

.PHONY: help demo test slow browser screenshots lint format types benchmark validity tables atlas atlas-point certificate docs site notebooks
.PHONY: clean quick quick-kernels quick-lowest quick-newest

help:
	@echo "make demo       the Stribeck curve of a PDMS cylinder: curve.png, curve.nc"
	@echo "make quick      the core claims, in a minute      make test   all tests      make slow   those that take minutes"
	@echo "make quick-kernels, quick-lowest, quick-newest   the core claims under two other BLAS kernels than that of this"
	@echo "                machine, with the lowest versions that pyproject.toml allows, and with the newest there are"
	@echo "make browser    the tests of the explorer, and the live curve, in Chromium and Firefox      make screenshots  docs/images/explorer*.png"
	@echo "make lint       style          make format apply it"
	@echo "make types      static types   make benchmark  the tables of the documentation"
	@echo "make docs       the site, build/docs/index.html, and the code of its pages      make site  the site alone"
	@echo "make notebooks  the notebooks with results, build/notebooks"
	@echo "make validity   docs/validity.md: the maps of the errors of all formulas"
	@echo "make tables     docs/numerics_tables.md, hours; make tables WORDS=curve_speed: the tables of a benchmark of that name"
	@echo "make atlas      the table of solved states, 6 minutes on two cores      make certificate  its errors"
	@echo "make atlas-point  those of balls, 70 minutes of one core               make certificate TABLE=ball-exponential"
	@echo "make clean      remove what make made"

$(READY): pyproject.toml requirements.lock
	$(call install,test)

$(BROWSER): pyproject.toml requirements.lock | $(READY)
	$(call install,browser)

$(TOOLS): pyproject.toml requirements.lock | $(READY)
	$(call install,dev)

$(DOCS): pyproject.toml requirements.lock | $(READY)
	$(call install,docs)

demo: $(READY)
	$(BIN)/stribeck curve examples/pdms_cylinder.toml -o curve.nc --plot curve.png --force

quick: $(READY)
	$(ONE_THREAD) $(BIN)/python $(QUICK)

# Rounding differs between kernels, and no claim may hang on it.
quick-kernels: $(READY)
	@for kernel in $$($(BIN)/python .ci/kernels.py); do \
		echo "# OPENBLAS_CORETYPE=$$kernel"; \
		OPENBLAS_CORETYPE=$$kernel $(ONE_THREAD) $(BIN)/python $(QUICK) || exit 1; done

# Old versions warn of each other, which is not ours to mend.
quick-lowest: $(VENV)-lowest/.ready
	$(BIN)/python .ci/bounds.py $(UV)
	$(ONE_THREAD) $(VENV)-lowest/bin/python $(QUICK) -W default

quick-newest: $(VENV)-newest/.ready
	$(ONE_THREAD) $(VENV)-newest/bin/python $(QUICK)

# What is newest changes, what is lowest does not.
.PHONY: $(VENV)-newest/.ready
$(VENV)-newest/.ready: RESOLUTION := highest
$(VENV)-lowest/.ready: RESOLUTION := lowest-direct
$(VENV)-newest/.ready $(VENV)-lowest/.ready: pyproject.toml | $(READY) $(UV)
	@rm -rf $(@D)
	$(UV) venv --quiet --python $(BIN)/python $(@D)
	$(UV) pip install --quiet --python $(@D)/bin/python --resolution $(RESOLUTION) --editable '.[quick]'
	@touch $@

$(BIN)/uv: | $(READY)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check uv

test: $(READY)
	$(ONE_THREAD) $(BIN)/python -m pytest -n auto $(FINITE)

slow: $(READY)
	$(ONE_THREAD) $(BIN)/python -m pytest -n auto -m slow
	$(ONE_THREAD) $(BIN)/python -m pytest -q -n auto --hypothesis-profile=search $(shell grep -l '^from hypothesis' tests/test_*.py)

# Debian's chromium, or CHROMIUM=/path/to/it.
browser: $(BROWSER)
	$(ONE_THREAD) $(BIN)/python -m pytest $(FINITE) -m browser $(BROWSER_TESTS) tests/test_browser.py tests/test_live_curve.py

screenshots: $(BROWSER)
	$(ONE_THREAD) $(BIN)/python docs/explorer.py

lint: $(TOOLS)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

format: $(TOOLS)
	$(BIN)/ruff check --fix .
	$(BIN)/ruff format .

types: $(TOOLS)
	$(BIN)/mypy

benchmark: $(READY)
	@for script in benchmarks/*.py; do echo "# $$script"; $(ONE_THREAD) $(BIN)/python "$$script" || exit 1; done

# The blocks of code of all pages; what else the site shows runs while it is built. Warnings are errors.
docs: $(DOCS)
	$(ONE_THREAD) $(BIN)/python -m pytest -q -n auto -m "slow or not slow" tests/test_docs.py
	@$(MAKE) --no-print-directory site

site: $(DOCS)
	$(ONE_THREAD) $(BIN)/python -m sphinx -b html --fail-on-warning --keep-going --quiet docs build/docs
	@echo "open build/docs/index.html"

notebooks: $(DOCS)
	mkdir -p build/notebooks
	for script in docs/notebooks/*.py; do \
		$(BIN)/jupytext --quiet --to ipynb --output "build/notebooks/$$(basename "$$script" .py).ipynb" "$$script" || exit 1; done
	$(ONE_THREAD) $(BIN)/jupyter-execute --inplace build/notebooks/*.ipynb

validity: $(READY)
	$(ONE_THREAD) $(BIN)/python docs/validity.py

tables: $(READY)
	$(ONE_THREAD) $(BIN)/python docs/numerics_tables.py $(WORDS)

# The lines that are finished are kept in build/atlas, so that an interrupted build goes on. TABLE=line-persson makes another.
TABLE = line-exponential
atlas: $(READY)
	$(ONE_THREAD) $(BIN)/python -m evidence.atlas_build $(TABLE)

atlas-point: $(READY)
	$(ONE_THREAD) $(BIN)/python -m evidence.atlas_build ball-exponential ball-persson ball-exit

certificate: $(READY)
	$(ONE_THREAD) $(BIN)/python -m evidence.atlas_certificate $(TABLE)

clean:
	rm -rf $(VENV) $(VENV)-lowest $(VENV)-newest build dist curve.nc curve.png curve.csv .pytest_cache .mypy_cache .ruff_cache .hypothesis
	rm -rf docs/gallery docs/generated
	find src tests benchmarks examples docs -name __pycache__ -prune -exec rm -rf {} + 2>/dev/null || true

# The newest versions that go together, for requirements.lock; needs uv.
.PHONY: lock
lock:
	uv pip compile --universal --quiet --extra all --extra dev --extra browser --extra docs --no-header --no-annotate pyproject.toml -o requirements.lock
