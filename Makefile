# Everyday commands; `make` alone lists them.
SHELL := /bin/bash
.DEFAULT_GOAL := help
.DELETE_ON_ERROR:

# Runs the set-up only; the stack runs on the Python 3.11 that the set-up finds or brings.
SYSTEM_PYTHON ?= python3
# Checked with mypy --strict: everything but nodes and tests, which speak to the untyped rclpy.
TYPED = $(patsubst %/py.typed,%,$(wildcard ros2_ws/src/*/*/py.typed)) tools/setup
EMPTY :=
MYPYPATH = $(subst $(EMPTY) $(EMPTY),:,$(wildcard ros2_ws/src/*))

.PHONY: help setup demo test quick claims gallery figures-5 recordings check docs format lock test-robot clean tune figure-5-13 table-5-1 bench

help: ## list the commands
	@grep -hE '^[a-z0-9-]+:.*## ' $(MAKEFILE_LIST) | awk -F ':.*## ' '{ printf "  make %-12s %s\n", $$1, $$2 }'

setup: ## install everything (first time: network, up to 5 minutes)
	@$(SYSTEM_PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 9))' 2> /dev/null || { \
	  echo 'set-up: $(SYSTEM_PYTHON) is missing or older than 3.9: install one with `sudo apt-get install python3' \
	    'python3-venv python3-dev` or name another as in `make setup SYSTEM_PYTHON=python3.11`.' >&2; exit 1; }
	@$(SYSTEM_PYTHON) -B -m tools.setup

demo: setup ## drive over the step with one and with two layers, and report
	@./run bringup compare

test: setup ## every test
	@tools/run_tests

quick: setup ## one PASS or FAIL line per claim that needs no DDS, in 15 s
	@./run claims --quick

claims: setup ## measure every figure that the README quotes
	@./run claims

gallery: setup ## figures of chapters 2 and 3 made anew, on one page
	@./run python benchmarks/gallery.py

figures-5: setup ## figures 5.10 and 5.17 to 5.24 made anew from runs of the simulator, on one page
	@./run python benchmarks/figures_5.py

recordings: setup ## slip law and odometry filter on recordings of real vehicles
	@./run python benchmarks/recordings.py

table-5-1: setup ## table 5.1 over latency, disturbance and localisation (5040 runs, goes on where it stopped)
	@./run tracked_lab campaign run table_5_1
	@./run tracked_lab campaign run table_5_1_belts

bench: setup ## what a user would pick instead, on the same plant and seeds
	@./run python benchmarks/peers.py

tune: setup ## search the weights of every way to drive of table 5.1 (20 minutes)
	@./run python benchmarks/tune.py

figure-5-13: setup ## one lifted layer against two, by five solvers
	@./run python benchmarks/figure_5_13.py

check: setup ## lint, format and types
	@.venv/bin/ruff check .
	@.venv/bin/ruff format --check .
	@MYPYPATH=$(MYPYPATH) .venv/bin/mypy --exclude '/(nodes|test)/' $(TYPED)

docs: setup ## write docs/nodes.md from the nodes
	@./run python -m tools.node_pages

format: setup ## let ruff lay out the code
	@.venv/bin/ruff check --fix .
	@.venv/bin/ruff format .

lock: setup ## resolve requirements/*.in again
	@tools/lock

test-robot: setup ## tests of the ROS-free packages on Python 3.12 with a robot's packages
	@tools/test_robot

clean: ## remove all that set-up and runs have made
	rm -rf .venv .cache out ros2_ws/build ros2_ws/install ros2_ws/log
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
