# `make help` lists the targets. PYTHON is the interpreter of the environment in use.
PYTHON ?= .venv/bin/python

# The kernels' own tests, less those of many samples or calls, which take plain Python minutes.
KERNEL_TESTS := $(patsubst %,tests/models/march/test_%.py,recorded equations steps polynomial slots hard_cases \
	hard_crossings) tests/models/impulses
LONG_IN_PYTHON := test_quarter_period or more_half_cycles_than or slow_hops

.PHONY: help install run test test-slow test-sweeps test-pages test-kernels paper accuracy rule site check-histories experiments reference selftest-cases samples schema mutate mutants fuzz lint types doctest wheel versions docs docs-test docs-pictures clean

help:  ## list the targets
	@grep -hE '^[a-z-]+: .*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):[^#]*## (.*)/  \1\t\2/' | expand -t 16

.venv/bin/python:
	python3 -m venv .venv

install: .venv/bin/python  ## make .venv and install the package with everything needed to work on it
	.venv/bin/python -m pip install -q -e '.[test,dev]'

run:  ## the main job on the shipped samples
	$(PYTHON) -m rockpulse assess data/samples/records --config data/samples/site.toml -o results.h5 --overwrite

test:  ## the default tests (a minute and a half on two cores)
	$(PYTHON) -m pytest -n 2 --dist worksteal

test-slow:  ## the long sweeps
	$(PYTHON) -m pytest -m slow

# Trees of git that have passed are written to .ci, so that .ci/run need not test them again: $(call trees,FOLDERS).
trees = git rev-parse $(addprefix HEAD:,$(1)) | xargs
passed = if git diff --quiet HEAD -- $(2); then $(call trees,$(2)) > .ci/$(1); fi

test-sweeps:  ## what takes seconds a test (and test-pages); .ci/run leaves it out for sources that have passed
	$(PYTHON) -m pytest -q -n 2 --dist worksteal -m "sweep and not slow" --ignore tests/models
	@$(call passed,sweeps,pipeline models tests data)

test-pages:  ## pages of the manual (extra docs), the page of `rockpulse app` (extra browser), schema, layout, subjects
	$(PYTHON) -m pytest -q -n 2 --dist worksteal -m "sweep and not slow" tests/docs tests/test_*.py \
		tests/pipeline/app tests/pipeline/views/report/test_browser_axe.py

test-kernels:  ## the sweeps of the kernels, and their tests with the kernels as plain Python; left out likewise
	$(PYTHON) -m pytest -q -n 2 --dist worksteal -m "sweep and not slow" tests/models
	@# Plain Python warns of the arithmetic of empty slots, which nobody reads.
	NUMBA_DISABLE_JIT=1 $(PYTHON) -m pytest -q -n 2 --dist worksteal -W ignore::RuntimeWarning $(KERNEL_TESTS) -k "not ($(LONG_IN_PYTHON))"
	@$(call passed,kernels,models/rocking tests/models)

# Studies of our own questions (benchmarks/laboratory): tables and pictures go to build/. Files for which RECORDS stands
# may need OPTIONS="--units g --events TABLE".
LABORATORY := PYTHONPATH=benchmarks:$$PYTHONPATH $(PYTHON) -m laboratory
RECORDS ?= data/samples/records
OPTIONS ?=

paper:  ## Figures 4 and 5 of the paper and the verdict on each of its statements (15 s)
	$(LABORATORY).paper build/paper

accuracy:  ## speed and error of solvers and models, on the samples or RECORDS (minutes; OPTIONS=--quick: one)
	$(LABORATORY).accuracy $(RECORDS) -o build/accuracy $(OPTIONS)

rule:  ## the rule and other measures on RECORDS of four earthquakes or more (OPTIONS=--fit: fits it anew)
	$(LABORATORY).rule $(RECORDS) -o build/rule $(OPTIONS)

site:  ## the design of rockpulse calibrate on earthquakes left out, on RECORDS of ten or more (2 s a record)
	$(LABORATORY).site $(RECORDS) -o build/site $(OPTIONS)

check-histories:  ## the checks of codes against time histories of RECORDS
	$(LABORATORY).histories $(RECORDS) -o build/check-histories $(OPTIONS)

experiments:  ## overturning tests on a shake table (TESTS=FOLDER with the runs of Chen et al. 2022) against the response
	$(LABORATORY).experiments $(TESTS)

reference:  ## the stored reference of make accuracy, in 140-bit numbers (hours; goes on where it stopped)
	$(PYTHON) benchmarks/make_reference.py

selftest-cases:  ## the stored cases of rockpulse selftest, in 140-bit numbers (minutes)
	$(PYTHON) benchmarks/selftest_cases.py

samples:  ## write data/samples/formats: a small file of every format that is read
	$(PYTHON) tests/make_format_samples.py

schema:  ## write the tables of docs/schema.md from the declarations of the variables
	$(PYTHON) tests/make_schema.py

mutate:  ## change what headers state twice: a table of who tells, and an error if nobody does
	$(PYTHON) tests/header_facts.py

MINUTES ?= 60
FIRST ?= 100000
fuzz:  ## damage to every sample on every reader, MINUTES=60 long, from the seed FIRST=100000 on; with atheris guided too
	@if $(PYTHON) -c "import atheris" 2>/dev/null; then $(PYTHON) tests/fuzz_coverage.py --minutes $(MINUTES); else \
		echo "without atheris (pip install -e '.[fuzz]', Linux) there is no coverage-guided run"; fi
	$(PYTHON) tests/fuzz.py --minutes $(MINUTES) --first $(FIRST)

COUNT ?= 400
SEED ?= 1
LEAST ?= 0.90
mutants:  ## COUNT=400 changes of operators and constants, drawn by SEED=1: the tests notice LEAST=0.90 of them (an hour)
	$(PYTHON) tests/mutants/sample.py --count $(COUNT) --seed $(SEED) --least $(LEAST)

lint:  ## ruff: format and rules; subjects of the branch's commits
	$(PYTHON) -m ruff format --check .
	$(PYTHON) -m ruff check .
	$(PYTHON) tests/commit_subjects.py

types:  ## mypy on both packages
	$(PYTHON) -m mypy

doctest:  ## the examples in the docstrings
	$(PYTHON) -m pytest -q -n 2 --doctest-modules pipeline models

wheel:  ## the wheel alone with the lowest versions, away from this folder: obspy.read on every sample, four verbs
	.ci/versions lowest short

versions:  ## the default tests with the lowest and the newest versions of the dependencies (LOWEST_PYTHON, NEWEST_PYTHON)
	.ci/versions lowest
	.ci/versions newest

docs:  ## the manual as HTML in build/docs (the extra "docs"; no network)
	$(PYTHON) -m sphinx -q -a -E -W --keep-going -b html docs build/docs

docs-test: docs  ## build the manual without a warning, and run every command and example on it
	$(PYTHON) -m pytest -q -n 2 -m "sweep or not sweep" tests/docs

docs-pictures:  ## draw the pictures of the manual again, by the commands on its pages
	$(PYTHON) tests/docs_page.py
	$(PYTHON) tests/app_pictures.py

clean:  ## remove what builds and tests leave behind
	rm -rf build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find . -name __pycache__ -not -path './.venv/*' -type d -prune -exec rm -rf {} +
