# make run   the low-speed experiment: archive and picture in out/
# make test  lint, types and tests
# make types types once more, as macOS and Windows have them
# make test-lowest  a short suite in a second environment, with the lowest versions that the package promises
# make test-newest  the same with the newest versions of everything and the Python that NEWEST_PYTHON names; `make run` in it, too
# make docs  the documentation: docs/_build/html/index.html
# make bench    run time against error, all scenes: the benchmark's page anew (some fifty minutes)
# make stress   2,000 random scenes: the stress page anew (some minutes)
# All need python3 (3.11 or newer) and network access to a package index, nothing else.

PYTHON ?= python3
VENV   ?= .venv
LOWEST ?= .venv-lowest
NEWEST ?= .venv-newest
NEWEST_PYTHON ?= $(PYTHON)
# On Windows: make SCRIPTS=Scripts, in a shell like Git's bash
SCRIPTS ?= bin
BIN    := $(VENV)/$(SCRIPTS)

.PHONY: run test test-by-hand test-lowest test-newest lint warm types docs bench stress clean
.DELETE_ON_ERROR:

run: $(VENV)/installed
	mkdir -p out
	$(BIN)/gearidae sweep cases/low_speed.toml --over coating.sam_fraction=1,0.8,0.6,0.5,0.47,0.45 \
	    --set run.duration=0.6 \
	    -o out/low_speed.nc --overwrite
	$(BIN)/gearidae plot out/low_speed.nc -o out/low_speed.png --overwrite

# Kept also where the environment says otherwise: tests start some hundred processes, of which each would compile the sources
# of the package, half a second each.
BYTECODE := PYTHONDONTWRITEBYTECODE=

# Two processes: each compiles the solver once, and files stay whole, whose runs are shared by their tests. In their own
# order, so that the long ones of the engine do not come last, with one process idle.
test: $(VENV)/installed-dev
	$(MAKE) --jobs 2 lint warm
	$(BYTECODE) $(BIN)/python -m pytest -q -n 2 --dist loadfile --no-loadscope-reorder

# What takes minutes and changes hardly ever: before a release, and after a change of how functions are compiled.
test-by-hand: $(VENV)/installed-dev
	$(BIN)/python -m pytest -q -m by_hand

# Compile beforehand what both processes of the tests need, while the linters run.
warm: $(VENV)/installed-dev
	$(BYTECODE) $(BIN)/gearidae compile

# The short suite: both drivers, scenes, archives, pictures and the command line.
# In one process, which compiles the solver once; two of these suites run side by side in `.ci/versions`.
SHORT := -q \
    tests/engine/test_backends.py tests/engine/test_compiled_once.py tests/engine/test_indices.py tests/scene tests/archive/test_dataset.py tests/archive/test_netcdf.py \
    tests/archive/test_lock.py tests/monitor/test_measured.py \
    tests/cli/test_values.py tests/cli/test_session.py tests/plot/test_plot.py tests/report/test_report.py

# Compiled with a check of every index, as this environment compiles the solver for nothing else. The warning is one that
# numpy itself switches off.
test-lowest: $(LOWEST)/installed
	NUMBA_BOUNDSCHECK=1 $(LOWEST)/$(SCRIPTS)/python -m pytest -p no:cacheprovider -W "ignore:numpy.ndarray size changed:RuntimeWarning" $(SHORT)

# The main job first: compiled code that it makes is taken from the cache by the tests.
test-newest: $(NEWEST)/installed-test
	$(MAKE) run VENV=$(NEWEST) PYTHON=$(NEWEST_PYTHON)
	$(NEWEST)/$(SCRIPTS)/python -m pytest -p no:cacheprovider $(SHORT)

lint: $(VENV)/installed-dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

# What the types say on the systems that the tests do not run on.
types: $(VENV)/installed-dev
	for system in darwin win32; do $(BIN)/mypy --platform $$system --cache-dir .mypy_cache/$$system || exit 1; done

docs: $(VENV)/installed-docs
	$(BIN)/python -m sphinx -W --keep-going -q -b html docs docs/_build/html

bench: $(VENV)/installed
	PYTHONPATH=benchmarks $(BIN)/python benchmarks/make_page.py

stress: $(VENV)/installed
	PYTHONPATH=tests:docs/scripts $(BIN)/python -m gearidae_pages.stress

clean:
	rm -rf $(VENV) $(LOWEST) $(NEWEST) out docs/_build docs/gallery docs/reference/generated build dist .mypy_cache .pytest_cache .ruff_cache .hypothesis

# The package is installed in editable form: only a change of its requirements asks for more.
$(VENV)/installed: pyproject.toml
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "gearidae needs Python 3.11 or newer; try make PYTHON=python3.12")'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable .
	touch $@

$(VENV)/installed-docs: $(VENV)/installed
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[docs]'
	touch $@

$(VENV)/installed-dev: $(VENV)/installed
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[dev]'
	touch $@

$(NEWEST)/installed-test: pyproject.toml
	$(MAKE) $(NEWEST)/installed VENV=$(NEWEST) PYTHON=$(NEWEST_PYTHON)
	$(NEWEST)/$(SCRIPTS)/python -m pip install --quiet --disable-pip-version-check pytest hypothesis mpmath
	touch $@

$(LOWEST)/installed: pyproject.toml tests/lowest.txt
	$(PYTHON) -m venv $(LOWEST)
	$(LOWEST)/$(SCRIPTS)/python -m pip install --quiet --disable-pip-version-check --constraint tests/lowest.txt \
	    --editable . pytest hypothesis mpmath
	touch $@
