"""`python -m sim_proc.export`: the program behind `legpush export`."""

import sys

from legpush.entry import run_main

if __name__ == "__main__":
    sys.exit(run_main("sim_proc.export.program"))
