"""Replaces this process by a program of the planner, the simulator or the agent."""

import os
import sys
from collections.abc import Sequence
from typing import Literal, NoReturn

from legpush.processes.environment import child_environment

Program = Literal[
    "agent_proc.programs.train",
    "agent_proc.programs.evaluate",
    "agent_proc.programs.calibrate",
    "agent_proc.programs.draw_room",
    "agent_proc.programs.show_map",
    "agent_proc.programs.study_table",
    "planner_proc.conformance",
    "sim_proc.export",
    "sim_proc.view",
]
"""A module that Python runs as a program."""


def start_program(program: Program, argv: Sequence[str]) -> NoReturn:
    """Become this program; `argv` are its options."""
    # -P: what lies in the working directory is no part of the program.
    command = [sys.executable, "-P", "-m", program, *argv]
    os.execve(command[0], command, child_environment(os.environ))  # noqa: S606 - no shell is wanted
