"""Replaces this process by a program of legpush, or by Python under the numerics profile."""

import os
import sys
from collections.abc import Sequence
from typing import Literal, NoReturn

from legpush.entry.interrupts import hold
from legpush.numerics.profile import why_not_here, with_profile
from legpush.processes.environment import child_environment

Program = Literal[
    "agent_proc.programs.train",
    "agent_proc.programs.evaluate",
    "agent_proc.programs.compare",
    "agent_proc.programs.curves",
    "agent_proc.programs.tune",
    "agent_proc.programs.calibrate",
    "agent_proc.programs.check_mission",
    "agent_proc.programs.draw_mission",
    "agent_proc.programs.draw_room",
    "agent_proc.programs.policy",
    "agent_proc.programs.show_map",
    "agent_proc.programs.study_table",
    "planner_proc.conformance.program",
    "sim_proc.export.program",
    "sim_proc.render.probe",
    "sim_proc.render.stills",
    "sim_proc.view.program",
    "legpush.canary",
    "legpush.recording.play",
]
"""A module whose `main` runs as a program."""


def start_program(program: Program, argv: Sequence[str]) -> NoReturn:
    """Become this program; `argv` are its options."""
    command = program_command(program, argv)
    hold()
    os.execve(command[0], command, child_environment(os.environ))  # noqa: S606 - no shell is wanted


def program_command(program: Program, argv: Sequence[str]) -> list[str]:
    """Return the command line of a program with these options."""
    # -P: what lies in the working directory is no part of the program.
    return [sys.executable, "-P", "-m", "legpush.entry", program, *argv]


def start_python(arguments: Sequence[str]) -> NoReturn:
    """Become Python with these arguments; a machine that cannot keep the profile is told, and goes on without it."""
    if why := why_not_here():
        sys.stderr.write(f"numerics profile native: {why}\n")
        sys.stderr.flush()
    os.execve(sys.executable, [sys.executable, *arguments], with_profile(os.environ))  # noqa: S606 - no shell is wanted
