"""`python -m sim_proc.view`: the program behind `legpush view`."""

import sys

from legpush.entry import run_main

if __name__ == "__main__":
    sys.exit(run_main("sim_proc.view.program"))
