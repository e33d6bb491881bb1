"""The planner as a process of its own: `python -m planner_proc`."""

import sys

from legpush.entry import run_main

if __name__ == "__main__":
    sys.exit(run_main("planner_proc.process", profile=True))
