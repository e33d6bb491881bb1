"""The simulator as a process of its own: `python -m sim_proc`."""

import sys

from legpush.entry import run_main

if __name__ == "__main__":
    sys.exit(run_main("sim_proc.process", profile=True))
