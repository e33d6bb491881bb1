"""The planner as a process of its own: `python -m planner_proc`."""

import sys

from legpush.entry.program import run_module

if __name__ == "__main__":
    sys.exit(run_module("planner_proc.process", profile=True))
