"""The agent as a process of its own: `python -m agent_proc`."""

import sys

from agent_proc.mission.process import AgentConfig, work
from legpush.numerics.entry import enter_profile
from legpush.service import run_process

if __name__ == "__main__":
    enter_profile()
    sys.exit(run_process("agent", AgentConfig, work))
