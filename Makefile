# Entry points. `make help` lists them; each sets up what is missing and then goes straight to its job.

.DEFAULT_GOAL := help
SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
PY := .venv/bin/python
# debian-12, debian-13 or wheel; PYTHON=... names the interpreter of the wheel's .venv
STACK := $(or $(STACK),$(shell packages/stack.sh))
MPIRUN ?= $(if $(filter wheel,$(STACK)),$(CURDIR)/.venv/bin/mpirun,/usr/bin/mpirun)
export MPIRUN
SCENES ?= $(wildcard scenes/*.toml)
SWEEP ?= sweeps/heung-map.toml
EXAMPLES ?= paper outline sweep dimensions closed-form exact verification modes branches imperfection contact vacuum \
    fuzz stability dual error-model peers cost large stacks

# --- ranks and threads ----------------------------------------------------------------------
# One rank: BLAS may use all cores. Several ranks: one thread each, or they fight for the cores. Two ranks
# are 1.4 to 1.7 times as fast on two cores (make benchmark-solver NP=1 and NP=2).
NP ?= $(shell [ $$(nproc) -ge 2 ] && echo 2 || echo 1)
ifeq ($(NP),1)
LAUNCH := $(PY)
OPENBLAS_NUM_THREADS ?= $(shell nproc)
else
LAUNCH := $(MPIRUN) -n $(NP) $(PY)
OPENBLAS_NUM_THREADS ?= 1
endif
export OPENBLAS_NUM_THREADS

# Open MPI 4 and 5 take their options from the environment: may run as root (CI), more ranks than cores is no error, and
# ranks are not tied to a core (two runs side by side would both be tied to core 0). For children: studies/mpi_children.py.
ifeq ($(shell id -u),0)
export OMPI_ALLOW_RUN_AS_ROOT := 1
export OMPI_ALLOW_RUN_AS_ROOT_CONFIRM := 1
endif
export OMPI_MCA_rmaps_base_oversubscribe ?= 1
export OMPI_MCA_hwloc_base_binding_policy ?= none
export PRTE_MCA_rmaps_default_mapping_policy ?= :oversubscribe
export PRTE_MCA_hwloc_default_binding_policy ?= none
# On one machine ranks talk through memory; Open MPI 5 complains of networks it cannot use. Not within a batch system.
ifeq ($(SLURM_JOB_ID)$(PBS_JOBID)$(LSB_JOBID),)
export OMPI_MCA_btl_tcp_if_include ?= lo
endif

# Pictures are drawn off-screen, also when DISPLAY is set to something that does not answer.
export PYVISTA_OFF_SCREEN ?= true
export VTK_DEFAULT_OPENGL_WINDOW ?= vtkEGLRenderWindow

# Nothing of the user's own may come before the stack's dolfinx and numpy.
export PYTHONNOUSERSITE := 1
unexport PYTHONPATH PYTHONHOME PETSC_DIR PETSC_ARCH SLEPC_DIR

# --- set-up ---------------------------------------------------------------------------------
# The stamp's name is a hash of what decides the set-up, and of where it is: git changes file
# times at every checkout, contents only when they change.
LISTS := packages/debian.txt packages/stacks/$(STACK).txt packages/setup.sh pyproject.toml
STAMP := .venv/setup-$(shell { pwd; cat $(LISTS) 2> /dev/null; } | sha256sum | cut -c1-16)

.PHONY: help
help: ## list the targets
	@echo "make TARGET [NP=1: MPI ranks, default 2 where there are two cores] [SCENES=\"a.toml b.toml\"]"
	@sed -nE 's/^([a-z-]+):[^#]*## (.*)/  \1\t\2/p' $(MAKEFILE_LIST) | expand -t 26

.PHONY: setup
setup: ## install what is missing: Debian packages (as root), .venv; STACK=wheel: all from PyPI, no root
	@packages/setup.sh $(STACK) $(STAMP)

$(STAMP):
	@packages/setup.sh $(STACK) $@

.PHONY: check
check: $(STAMP) ## versions, BLAS, cores and memory of this machine; what is missing
	@$(PY) packages/check.py

.PHONY: lock
lock: $(STAMP) ## pin packages/requirements.in anew (after editing it)
	@packages/lock.sh

# Whole files go to a worker, so that what a file's tests share is made once. Compiled forms are shared by all: who comes
# second to a form waits for the first (ffcx locks it). Eight workers at most: each takes up to 1 GB.
OVER_CORES := -n $(shell n=$$(nproc); echo $$((n < 8 ? n : 8))) --dist loadfile

# --- tests ----------------------------------------------------------------------------------
.venv/types/numpy: packages/types.txt | $(STAMP)
	@$(PY) -m pip --disable-pip-version-check install --quiet --no-deps --only-binary=:all: --upgrade \
		--python-version 3.11 --implementation cp --abi cp311 --platform manylinux_2_17_x86_64 \
		--target .venv/types --requirement $<
	@touch $@

.PHONY: lint
lint: $(STAMP) .venv/types/numpy ## ruff, mypy, hadolint
	$(PY) -m ruff check .
	$(PY) -m ruff format --check .
	MYPYPATH=.venv/types $(PY) -m mypy analytical bellowsx meshes solvers studies tests packages/check.py
	.venv/bin/hadolint Containerfile

.PHONY: format
format: $(STAMP) ## let ruff fix and format what it can
	$(PY) -m ruff check --fix .
	$(PY) -m ruff format .

.PHONY: test
test: check ## the quick tests, over the cores; lists the slowest twenty
	$(PY) -m pytest -q -m "not slow" $(OVER_CORES) --durations=20

# The stacks that this machine's is not, each in a root folder of its own (packages/in_root.sh).
STACKS := debian-12 debian-13 wheel
OTHERS ?= $(filter-out $(STACK),$(STACKS))
ROOTS ?= /var/tmp/bellowsx-roots

.PHONY: test-stacks
test-stacks: ## as root: set-up, the study in miniature and the quick tests on the other stacks
	for stack in $(OTHERS); do packages/in_root.sh $$stack $(ROOTS) make study-smoke test; done

.PHONY: test-slow
test-slow: check ## the slow tests
	$(PY) -m pytest -q -m slow

# --- studies --------------------------------------------------------------------------------
.PHONY: study
study: study-paper ## the main study, which is that of the paper

.PHONY: study-paper
study-paper: check ## the paper's four actuators by every model, and variants -> results/paper
	$(LAUNCH) -m studies study paper --out results/paper

.PHONY: study-core
study-core: check ## the four actuators without the variants -> results/paper
	$(LAUNCH) -m studies study paper --part core --out results/paper

.PHONY: study-paper-audit
study-paper-audit: check ## the same, and finer meshes that must lie within its uncertainties -> results/paper
	$(LAUNCH) -m studies study paper --part core --part variants --part sets --part audit --out results/paper

.PHONY: study-outline
study-outline: check ## the gap between closed form and finite elements, split: outline and model apart -> results/outline
	$(LAUNCH) -m studies study outline --out results/outline

.PHONY: study-sweep
study-sweep: check ## elongation over R_i, t and n; where the closed form misleads a designer -> results/sweep
	$(LAUNCH) -m studies study sweep --out results/sweep

.PHONY: sweep
sweep: check ## run all scenes of SWEEP, a sweep file -> results/sweeps/NAME
	$(LAUNCH) -m studies sweep $(SWEEP) --out results/sweeps/$(basename $(notdir $(SWEEP)))

.PHONY: study-stability
study-stability: check ## stress test: hundreds of cells, none may be a wrong answer -> results/stability
	$(LAUNCH) -m studies study stability --out results/stability

.PHONY: fuzz
SEED ?= 1
DRAWS ?= 1000
fuzz: check ## DRAWS inputs drawn from SEED, none may be wrong, crash or hang -> results/fuzz
	$(LAUNCH) -m studies study fuzz --seed $(SEED) --draws $(DRAWS) --out results/fuzz

.PHONY: study-fuzz
study-fuzz: fuzz

.PHONY: study-modes
study-modes: check ## modes that break the symmetry: from which pressure on, in which shape -> results/modes
	$(LAUNCH) -m studies study modes --out results/modes

.PHONY: study-peers
study-peers: check ## the same bellows in CalculiX, NGSolve, FElupe and the tutorial way; hours -> results/peers
	$(PY) -m studies.peers.environment
	$(PY) -m studies study peers --out results/peers

.PHONY: study-cost
study-cost: check ## run time against error of every model, mesh and way of stepping -> results/cost
	$(PY) -m studies study cost --out results/cost

.PHONY: study-error-model
study-error-model: check ## fit what meshes leave of error and take of time; ten scenes to check it -> results/error-model
	$(LAUNCH) -m studies study error-model --out results/error-model

.PHONY: study-dual
study-dual: check ## errors that one mesh tells of itself beside true ones, twenty scenes -> results/dual
	$(LAUNCH) -m studies study dual --out results/dual

.PHONY: study-branches
study-branches: check ## paths whose volume turns back, branches beyond buckling, squirm of a blocked bellows -> results/branches
	$(LAUNCH) -m studies study branches --out results/branches

.PHONY: study-imperfection
study-imperfection: check ## actuators whose moulding core sat off the axis: bend, elongation; full 3D -> results/imperfection
	$(LAUNCH) -m studies study imperfection --out results/imperfection

.PHONY: study-contact
study-contact: check ## contact: exact problems, folds that touch, 1 mm actuators to 80 kPa -> results/contact
	$(PY) -m studies study contact --out results/contact

.PHONY: study-vacuum
study-vacuum: check ## scenes/vacuum: what bellows contract to, with contact of their folds -> results/vacuum
	$(PY) -m studies study vacuum --out results/vacuum

.PHONY: study-smoke
study-smoke: check ## two convolutions by every model, in a minute -> results/study-smoke
	$(LAUNCH) -m studies study smoke --out results/study-smoke

.PHONY: batch
batch: check ## run SCENES (default scenes/*.toml) -> results/batch
	$(LAUNCH) -m studies batch $(SCENES) --out results/batch

.PHONY: report
report: check ## render the report of results/paper again from its runs
	$(PY) -m studies report results/paper

.PHONY: study-exact
study-exact: check ## bodies with exact answers, every model of each -> results/exact
	$(LAUNCH) -m studies study exact --out results/exact

.PHONY: study-verification
study-verification: check ## table of every exact and published problem -> results/verification
	$(LAUNCH) -m studies study verification --out results/verification --reuse results/exact

.PHONY: study-large
study-large: check ## direct and iterative linear algebra over size, 25 minutes at most -> results/large
	$(PY) -m studies study large --out results/large --ranks $(NP)

.PHONY: study-stacks
study-stacks: check ## as root: the same rows on three stacks, and what each costs; an hour -> results/stacks
	$(PY) -m studies.stacks.figures --out results/stacks/$(STACK)
	for stack in $(OTHERS); do \
		out=results/stacks/$$stack; \
		packages/in_root.sh $$stack $(ROOTS) bash -c "make check && .venv/bin/python -m studies.stacks.figures --out $$out"; \
		mkdir -p $$out; cp $(ROOTS)/$$stack/opt/bellowsx/$$out/{rows.csv,figures.json} $$out/; \
	done
	$(PY) -m studies study stacks $(STACKS:%=results/stacks/%) --out results/stacks

.PHONY: study-closed-form
study-closed-form: check ## chains, corrections, validity, laws and exact solutions -> results/closed-form
	$(PY) -m studies study closed-form --out results/closed-form

.PHONY: benchmark-closed-form
benchmark-closed-form: check ## evaluations of the closed form per second, one core -> results/benchmark-closed-form
	OPENBLAS_NUM_THREADS=1 $(PY) -m studies study benchmark-closed-form --out results/benchmark-closed-form

.PHONY: benchmark-start
benchmark-start: check ## CPU seconds until a plan is printed and until a solve begins -> results/benchmark-start
	$(PY) -m studies study benchmark-start --out results/benchmark-start

.PHONY: benchmark-solver
benchmark-solver: check ## cost of tangent, factor, iteration, warm and cold start; NP ranks -> results/benchmark-solver
	$(LAUNCH) -m studies study benchmark-solver --out results/benchmark-solver

.PHONY: study-dimensions
study-dimensions: check ## what fits the unprinted dimensions, which three sets are used -> results/dimensions
	$(PY) -m studies study dimensions --out results/dimensions

.PHONY: examples
examples: check ## all reports of docs anew from one commit: hours on an idle machine, and goes on where it was stopped
	@[ -z "$$(git status --porcelain --untracked-files=no)" ] || \
		{ echo "make examples: the tree differs from its commit: commit or undo the changes first" >&2; exit 2; }
	for study in $(EXAMPLES); do $(MAKE) study-$$study || echo "make examples: study-$$study: exit code $$?" >&2; done
	$(MAKE) keep-examples

.PHONY: keep-examples
keep-examples: ## copy the reports of EXAMPLES from results to docs; field files stay out of git
	for study in $(EXAMPLES); do \
		[ -e results/$$study/report.md ] || continue; \
		rm -rf docs/$$study; mkdir -p docs/$$study; \
		for part in report.md pictures paths; do \
			[ ! -e results/$$study/$$part ] || cp -r results/$$study/$$part docs/$$study/; \
		done; \
		(cd results/$$study && cp --parents *.csv $$(ls */sweep.csv 2> /dev/null) ../../docs/$$study/); \
		sed -i '/\.vtu)$$/d' docs/$$study/report.md; \
	done

# --- documentation --------------------------------------------------------------------------
.PHONY: docs
docs: $(STAMP) ## the documentation as a site, links checked, no network -> build/site/index.html
	NO_MKDOCS_2_WARNING=1 .venv/bin/mkdocs build --quiet --strict
	@echo "documentation: build/site/index.html"

# --- tidying --------------------------------------------------------------------------------
.PHONY: clean
clean: ## remove results and caches, keep .venv
	rm -rf results build *.egg-info .pytest_cache .mypy_cache .ruff_cache
	find . -name .venv -prune -o -name __pycache__ -type d -exec rm -rf {} +

.PHONY: distclean
distclean: clean ## also remove .venv
	rm -rf .venv
