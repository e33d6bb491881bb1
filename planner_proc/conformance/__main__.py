"""The checks as a program: `python -m planner_proc.conformance -- COMMAND`, or `legpush plan-check -- COMMAND`."""

import sys

from legpush.entry import run_main

if __name__ == "__main__":
    sys.exit(run_main("planner_proc.conformance.program"))
