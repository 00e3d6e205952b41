# make report   set up what is missing, run the shipped corpus through every renderer, print the report's path
# make test     set up what is missing, run the whole test suite
# make tradeoff  what accuracy costs, renderer by renderer; rewrites docs/tradeoff.md and the presets; minutes, on an idle machine
# make bench    how fast everything is, beside what bounds it; writes build/bench.json
# make mutation renderers with known faults: are they found, and named? Rewrites docs/mutation.md
.PHONY: setup report test mutation tradeoff lint bench lock clean

PYTHON := .venv/bin/python

setup:
	@.ci/setup

report: setup
	@.venv/bin/equilux run --out build/report

test:
	@.ci/setup --browser
	@$(PYTHON) -m ruff check .
	@$(PYTHON) -m mypy
	@$(PYTHON) -m pytest -q -n 2 --dist loadfile --no-loadscope-reorder

# About half an hour on two cores; exits 1 where a demand is not met.
mutation: setup
	@mkdir -p build
	@PYTHONPATH=tests $(PYTHON) -m mutation.suite --out docs/mutation.md --json build/mutation.json

tradeoff: setup
	@.venv/bin/equilux tradeoff --repeats 3 --clock cpu --out build/tradeoff --presets harness/equilux/tradeoff/presets.json --page docs/tradeoff.md

lint: setup
	$(PYTHON) -m ruff check .
	$(PYTHON) -m mypy

bench: setup
	@$(PYTHON) -m bench

# Rewrites the locks: every version pinned by hash, no address of any registry.
lock: setup
	build/uv/bin/uv pip compile -q --universal --all-extras --generate-hashes --no-annotate --no-header --python-version 3.11 pyproject.toml -o requirements.lock
	echo "uv" | build/uv/bin/uv pip compile -q --universal --generate-hashes --no-annotate --no-header --python-version 3.11 - -o .ci/uv.txt

clean:
	rm -rf build .venv equilux-out
