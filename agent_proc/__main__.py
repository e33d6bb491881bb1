"""The agent as a process of its own: `python -m agent_proc`."""

import sys

from legpush.entry.program import run_module

if __name__ == "__main__":
    sys.exit(run_module("agent_proc.mission.process", profile=True))
