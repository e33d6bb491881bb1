"""`python -m sim_proc.export`: the program behind `legpush export`."""

import sys

from legpush.entry.program import run_module

if __name__ == "__main__":
    sys.exit(run_module("sim_proc.export.program"))
