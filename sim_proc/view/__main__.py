"""`python -m sim_proc.view`: the program behind `legpush view`."""

import sys

from legpush.entry.program import run_module

if __name__ == "__main__":
    sys.exit(run_module("sim_proc.view.program"))
