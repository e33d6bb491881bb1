"""Checks what a mission needs, as a program with the flags of the agent; `legpush run` starts it.

It makes policy, push map and branch as the agent does, and ends. Exit codes: 0 the mission can begin, 2 it cannot.
"""

from agent_proc.mission.process import AgentConfig, read_inputs
from legpush.service import parse, run_program


def main() -> int:
    """Parse the command line of an agent and make its inputs; returns the exit code."""
    return run_program("check", lambda: run(parse("agent", AgentConfig)))


def run(config: AgentConfig) -> int:
    """Make the inputs of the mission; returns 0.

    Raises:
        LegpushError: One of them cannot be used.
    """
    read_inputs(config)
    return 0
