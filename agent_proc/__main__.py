"""The agent as a process of its own: `python -m agent_proc`."""

import sys

from legpush.entry import run_main

if __name__ == "__main__":
    sys.exit(run_main("agent_proc.mission.process", profile=True))
